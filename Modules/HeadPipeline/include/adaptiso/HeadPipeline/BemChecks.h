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

/// A check of one surface or pair of a model.
struct ModelCheck {
    std::string subject;  ///< "inner_skull", "inner_skull in outer_skull"
    Check check;
    Vec3 pointMm;  ///< where to look when it failed, in the frame of the surfaces
};

/// Results of the checks of `adaptiso-check --nested --profile bem --min-gap`.
struct ModelChecks {
    std::vector<SurfaceFacts> facts;     ///< one a surface
    std::vector<NestingReport> nesting;  ///< one a pair
    std::vector<ModelCheck> checks;
};

/// Checks the surfaces of a head model.
/// \param surfaces  from inside out, mm; findings give points in their frame
/// \param gapsMm    least gap of each pair
ModelChecks checkHeadSurfaces(std::span<const TriangleMesh> surfaces,
                              std::span<const double> gapsMm);

/// Checks one surface that is yet to be remeshed or nested.
std::vector<Check> checkHeadSurface(const TriangleMesh& surface);

/// Checks the model's meshes (stage "check"): a failed check becomes a finding. Fills the model's
/// checks, gaps and the measures of its surfaces.
void checkModel(BemModel& model, const BemHooks& hooks);

/// Fills the model's plausibility by judgePlausibility() (stage "check"), places in scanner RAS.
/// Nothing fails by it.
void assessPlausibility(BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
