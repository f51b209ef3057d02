#include "adaptiso/SurfacePipeline/Verification.h"

#include <algorithm>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

constexpr double kRounding = 1e-9;  // of the bound: sums of distances, coordinates in other frames
constexpr double kMeasuring = 1e-14;  // of the surface's extent: what distances are measured to

/// The largest absolute coordinate, or the box's diagonal where that is more.
double extentOf(const TriangleMesh& mesh) {
    const BoundingBox box = boundingBox(mesh);
    return std::max({norm(box.minimum), norm(box.maximum), norm(box.maximum - box.minimum)});
}

}  // namespace

bool hasSameShape(const TopologyReport& a, const TopologyReport& b) {
    return a.components.size() == b.components.size() &&
           a.eulerCharacteristic() == b.eulerCharacteristic();
}

void requireWithin(double measuredMm, double boundMm, const TriangleMesh& surface,
                   const TriangleMesh& original, const std::string& name,
                   const std::string& begin) {
    boundMm += kMeasuring * extentOf(original);
    if (measuredMm > boundMm) boundMm += measuringErrorMm(surface) + measuringErrorMm(original);
    if (measuredMm <= (1 + kRounding) * boundMm) return;
    throw InternalError(begin + "a point lies " + formatNumber(measuredMm) + " mm from " + name +
                        ", not " + formatNumber(boundMm));
}

DistanceReport sampledDistance(const TriangleMesh& surface, const TriangleMesh& original,
                               bool isSymmetric) {
    constexpr std::int64_t kEach = 4, kFewest = 2000, kMost = 200'000;
    const std::int64_t triangles =
        std::max(std::ssize(surface.triangles), std::ssize(original.triangles));
    return surfaceDistance(
        surface, original,
        {.samples = std::clamp(kEach * triangles, kFewest, kMost), .isSymmetric = isSymmetric});
}

Verification verifyDistance(const TriangleMesh& surface, const TriangleMesh& original,
                            double boundMm, const std::string& name, const std::string& begin) {
    const DistanceStatistics distance = sampledDistance(surface, original).combined;
    requireWithin(distance.maxMm, boundMm, surface, original, name, begin);
    return {distance.measured(), distance.maxMm};
}

}  // namespace adaptiso
