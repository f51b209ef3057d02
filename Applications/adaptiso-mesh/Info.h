#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

/// The facts of an image that --info prints; the page in the browser shows them too.
namespace adaptiso::mesher {

/// How an image's axes lie in space.
struct AxesSummary {
    std::string orientation;  ///< where i, j and k lead, nearest: "LPS", "RAS", ...
    Vec3 anglesDeg;           ///< between j and k, k and i, i and j
    double tiltDeg = 0;       ///< between k and the normal of i and j

    /// Not at right angles, by more than headers round.
    bool isSheared() const;
};
AxesSummary summarizeAxes(const ImageGeometry& geometry);

bool isInteger(PixelType type);

/// Statistics of an image's values, for --info.
struct ValueSummary {
    std::int64_t finite = 0;
    std::int64_t notFinite = 0;                ///< NaN or infinite
    std::vector<double> percentiles;           ///< of kPercents; empty when none is finite
    std::optional<SampleHistogram> histogram;  ///< none when all are equal, or none is finite
    std::vector<std::vector<double>> otsu;     ///< one, two and three thresholds, or none
};
inline constexpr double kPercents[] = {0, 0.1, 1, 5, 25, 50, 75, 95, 99, 99.9, 100};
ValueSummary summarizeValues(const VolumeView& volume);

}  // namespace adaptiso::mesher
