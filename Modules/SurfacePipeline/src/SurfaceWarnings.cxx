#include "adaptiso/SurfacePipeline/SurfaceWarnings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

std::optional<Warning> labelsWarning(const std::optional<LabelValues>& labels, double isovalue,
                                     const std::string& forRegions) {
    if (!labels || isovalue < labels->first) return std::nullopt;
    return Warning{"looks-like-labels",
                   "holds " + formatCount(static_cast<std::int64_t>(labels->count)) +
                       " different whole numbers, as label maps do; the surface at " +
                       formatShort(isovalue) + " is around all of " + formatShort(isovalue) +
                       " and more together; for regions: " + forRegions};
}

std::optional<Warning> noiseWarning(const SurfaceRecord& surface, const ExtractionOptions& options,
                                    const ImageGeometry& volume, const std::string& option,
                                    const std::string& smoothing) {
    constexpr double kMuch = 0.1, kThinningVoxels = 0.5, kSmoothingVoxels = 0.7;
    const auto& work = surface.statistics.adaptiveWork;
    const AdaptiveOptions& aims = options.adaptive;
    if (!work || aims.maxErrorMm || aims.maxTriangles || aims.reduction) return std::nullopt;
    const double part = static_cast<double>(work->trianglesKept) /
                        static_cast<double>(std::max<std::int64_t>(surface.madeTriangles, 1));
    if (!(part >= kMuch)) return std::nullopt;
    const double voxelMm = leastPlaneDistanceMm(volume);
    return Warning{
        "noise-kept",
        formatShort(std::floor(100 * part)) +
            " % of the triangles are noise, which the default bound leaves at full "
            "resolution to save time; " +
            option + formatShort(kThinningVoxels * voxelMm) + ", half a voxel, thins it" +
            (smoothing.empty() ? ""
                               : "; " + smoothing + formatShort(kSmoothingVoxels * voxelMm) +
                                     " weakens it in the image")};
}

}  // namespace adaptiso
