#include "adaptiso/SurfaceChecks/DistanceJson.h"

namespace adaptiso {

Json distanceJson(const DistanceStatistics& distances, const AffineTransform& toFrame) {
    return {{"samples", distances.samples},
            {"meanMm", number(distances.meanMm)},
            {"rmsMm", number(distances.rmsMm)},
            {"p95Mm", number(distances.p95Mm)},
            {"p99Mm", number(distances.p99Mm)},
            {"maxMm", number(distances.maxMm)},
            {"maxPointMm", vector(toFrame(distances.maxPointMm))},
            {"meanNormalDeviationDeg", number(distances.meanNormalDeviationDeg)},
            {"p95NormalDeviationDeg", number(distances.p95NormalDeviationDeg)}};
}

}  // namespace adaptiso
