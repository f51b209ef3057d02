#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "Pipeline.h"
#include "SurfaceFacts.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {

/// "bem", "print", "view"
std::string_view toString(Profile profile);

/// What sizes are believed of a surface for this use.
SizeLimits sizeLimitsOf(Profile profile);

enum class Outcome {
    Passed,
    Failed,
    Undecided  ///< makes no sense of this surface: the genus of an open one
};

/// One question that was asked of a surface, or of two, and the answer.
struct Check {
    std::string_view key;   ///< of the report: "selfIntersections"
    std::string_view name;  ///< for people: "no self-intersection"
    bool isRequired = false;
    Outcome outcome = Outcome::Passed;
    std::string finding;  ///< what was found, and where; may be empty when passed

    bool hasFailed() const { return outcome == Outcome::Failed; }
    bool breaksProfile() const { return isRequired && hasFailed(); }
};

/// None that is required has failed.
bool allHold(const std::vector<Check>& checks);

/// The questions asked of one surface, in the order of README.md's table.
std::vector<Check> judgeSurface(const SurfaceFacts& facts, const CheckOptions& options);

/// Whether the surface lies on the isosurface.
/// \param deviation  none: it has no area to measure
Check judgeDeviation(const std::optional<DistanceStatistics>& deviation, double voxelMm,
                     const CheckOptions& options);

/// The questions asked of two surfaces of which one should lie in the other.
/// \param inner, outer  their names
/// \param toFrame       takes points of the report to the frame to tell them in
std::vector<Check> judgeNesting(const NestingReport& report, const std::string& inner,
                                const std::string& outer, const AffineTransform& toFrame,
                                const CheckOptions& options);

}  // namespace adaptiso
