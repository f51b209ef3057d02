#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "BemRun.h"
#include "Common/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/Pipeline/Checks.h"

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

/// Checks every promise about the surfaces (LPS mm), by adaptiso-check's own code; what is not kept
/// becomes a finding of the run. Fills what the report says of the surfaces and gaps.
void checkModel(const std::vector<TriangleMesh>& surfaces, BemRun& run, ProgressLine& progress);

/// Asks what is usual of head models (judgePlausibility); nothing fails by it. Fills the run's
/// plausibility, with places told in scanner RAS.
void askWhatIsUsual(const std::vector<TriangleMesh>& surfaces, BemRun& run, ProgressLine& progress);

/// Reads the model's files back from `folder` and asks them the same once more: rounding to what a
/// format can hold must not break a promise, and every file must lead back to the surfaces.
/// What is not kept becomes a finding of the run.
/// \param surfaces  that were written, LPS mm
/// \throws FileError  a file can't be read back
void checkFiles(const std::filesystem::path& folder, const std::vector<TriangleMesh>& surfaces,
                BemRun& run);

}  // namespace adaptiso
