#include "adaptiso/MeshQuality/Size.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "ExactTriangle.h"
#include "RequireIndices.h"

namespace adaptiso {
namespace {

SizeVerdict judge(const Vec3& extent, const SizeLimits& limits) {
    const auto [smallest, largest] = std::minmax({extent.x, extent.y, extent.z});
    if (largest > limits.maxLargestExtentMm) return SizeVerdict::TooLarge;
    const bool isLargeEnough =
        smallest >= limits.minExtentMm && largest >= limits.minLargestExtentMm;
    return isLargeEnough ? SizeVerdict::Plausible : SizeVerdict::TooSmall;
}

}  // namespace

std::string_view toString(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::Metres:
            return "metres";
        case LengthUnit::Centimetres:
            return "centimetres";
        case LengthUnit::Micrometres:
            return "micrometres";
    }
    return "unknown";
}

SizeReport judgeSize(const TriangleMesh& mesh, const SizeLimits& limits) {
    requireIndices(mesh, "judgeSize");
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        const Corners corners = cornersOf(mesh, n);
        if (!areFinite(corners)) continue;
        for (const Vec3& p : corners) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], p[axis]);
                high[axis] = std::max(high[axis], p[axis]);
            }
        }
    }
    SizeReport report;
    if (!(low.x <= high.x)) return report;
    report.extentMm = high - low;
    report.verdict = judge(report.extentMm, limits);
    if (report.verdict == SizeVerdict::Plausible) return report;
    for (const auto& [unit, mm] : {std::pair{LengthUnit::Metres, 1000.0},
                                   {LengthUnit::Centimetres, 10.0},
                                   {LengthUnit::Micrometres, 0.001}}) {
        if (judge(mm * report.extentMm, limits) != SizeVerdict::Plausible) continue;
        report.guess = unit;
        break;
    }
    return report;
}

}  // namespace adaptiso
