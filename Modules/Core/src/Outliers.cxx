#include "adaptiso/Core/Outliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

std::string OutlierRule::text() const {
    return "more than " + formatNumber(limit) +
           " robust standard deviations (1.4826 times the median distance from the median) and at "
           "least " +
           formatNumber(leastPercent) + " % from the median";
}

std::string Outlier::percentText() const {
    const double size = std::abs(percent);
    return (percent > 0 ? "+" : "-") +
           (!std::isfinite(size) ? "inf"
            : size < 10          ? formatShort(std::round(size * 100) / 100)
                                 : formatFixed(size, 0)) +
           "%";
}

std::vector<Outlier> findOutliers(std::span<const std::optional<double>> values,
                                  const OutlierRule& rule) {
    constexpr double kOfNormal = 1.4826;        // MAD of a normal distribution is 1 / this
    constexpr double kOfNormalMean = 1.253314;  // its mean distance is 1 / this: sqrt(pi / 2)
    const std::vector<double> known = knownOf(values);
    if (known.size() < kFewestCompared) return {};
    const double median = medianOf(known);
    std::vector<double> distances;
    for (const double value : known) distances.push_back(std::abs(value - median));
    double scale = kOfNormal * medianOf(distances);
    if (!(scale > 0)) {
        std::sort(distances.begin(), distances.end());  // one sum, whatever the order
        scale = kOfNormalMean * std::accumulate(distances.begin(), distances.end(), 0.0) /
                static_cast<double>(distances.size());
    }
    std::vector<Outlier> outliers;
    if (!(scale > 0)) return outliers;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!values[n] || !std::isfinite(*values[n])) continue;
        const double distance = *values[n] - median;
        const Outlier found{n, distance / scale, 100 * distance / std::abs(median)};
        const bool isApart =
            std::abs(found.score) > rule.limit && !(std::abs(found.percent) < rule.leastPercent);
        if (isApart) outliers.push_back(found);
    }
    return outliers;
}

std::vector<double> knownOf(std::span<const std::optional<double>> values) {
    std::vector<double> known;
    for (const std::optional<double>& value : values) {
        if (value && std::isfinite(*value)) known.push_back(*value);
    }
    return known;
}

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace adaptiso
