#include "Outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace adaptiso {
namespace {

/// \pre values is not empty
double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::vector<double> knownOf(std::span<const std::optional<double>> values) {
    std::vector<double> known;
    for (const std::optional<double>& value : values) {
        if (value && std::isfinite(*value)) known.push_back(*value);
    }
    return known;
}

}  // namespace

double medianOf(std::span<const std::optional<double>> values) {
    std::vector<double> known = knownOf(values);
    return known.empty() ? std::nan("") : medianOf(std::move(known));
}

std::vector<std::optional<double>> robustScores(std::span<const std::optional<double>> values) {
    constexpr std::size_t kFewest = 5;          // of four, one is no exception
    constexpr double kOfNormal = 1.4826;        // MAD of a normal distribution is 1 / this
    constexpr double kOfNormalMean = 1.253314;  // its mean distance is 1 / this: sqrt(pi / 2)
    std::vector<std::optional<double>> scores(values.size());
    const std::vector<double> known = knownOf(values);
    if (known.size() < kFewest) return scores;
    const double median = medianOf(known);
    std::vector<double> distances;
    for (const double value : known) distances.push_back(std::abs(value - median));
    double scale = kOfNormal * medianOf(distances);
    if (!(scale > 0)) {
        std::sort(distances.begin(), distances.end());  // one sum, whatever the order
        scale = kOfNormalMean * std::accumulate(distances.begin(), distances.end(), 0.0) /
                static_cast<double>(distances.size());
    }
    if (!(scale > 0)) return scores;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (values[n] && std::isfinite(*values[n])) scores[n] = (*values[n] - median) / scale;
    }
    return scores;
}

}  // namespace adaptiso
