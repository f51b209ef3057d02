#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {

/// adaptiso-check's question of one surface or pair, its answer, and where to look.
struct ModelCheck {
    std::string subject;  ///< "inner_skull", "inner_skull in outer_skull"
    Check check;
    Vec3 pointMm;  ///< in the frame of the surfaces asked; meaningful when the check failed
};

/// All that `adaptiso-check --nested --profile bem --min-gap` asks of the surfaces of a model.
struct ModelChecks {
    std::vector<SurfaceFacts> facts;     ///< one a surface
    std::vector<NestingReport> nesting;  ///< one a pair
    std::vector<ModelCheck> checks;
};

/// \param surfaces  from inside out, mm, in any frame; findings tell points in it
/// \param gapsMm    least gap of each pair
ModelChecks askOfModel(std::span<const TriangleMesh> surfaces, std::span<const double> gapsMm);

/// The same of one surface that is yet to be remeshed or nested.
std::vector<Check> askOfSurface(const TriangleMesh& surface);

/// Checks every promise about the model's meshes, by adaptiso-check's own code (stage "check");
/// what is not kept becomes a finding. Fills what the model tells of surfaces and gaps.
void checkModel(BemModel& model, const BemHooks& hooks);

/// Asks what is usual of head models (judgePlausibility; stage "check"); nothing fails by it. Fills
/// the model's plausibility, with places told in scanner RAS.
void askWhatIsUsual(BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
