#include "adaptiso/ImageIO/Otsu.h"

#include <itkHistogram.h>
#include <itkOtsuMultipleThresholdsCalculator.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <string>
#include <type_traits>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso {
namespace {

using ItkHistogram = itk::Statistics::Histogram<double>;

/// The smallest, the largest, and what lies between but for the last thousandth on both sides.
struct Spread {
    double minimum, low, high, maximum;
};

/// \throws InvalidInput when there is nothing to separate
Spread spreadOf(const VolumeView& volume) {
    constexpr std::array<double, 4> kPercents{0, 0.1, 99.9, 100};
    const std::vector<double> values = percentiles(volume, kPercents);
    if (values.empty() || !(values[0] < values[3])) {
        throw InvalidInput(
            "all its finite values are equal, or none is finite, so there is nothing to separate; "
            "give an isovalue");
    }
    if (!std::isfinite(values[3] - values[0])) {
        throw InvalidInput(
            "its values span more than the largest number there is here, 1.8e308; give an "
            "isovalue");
    }
    return {values[0], values[1], values[2], values[3]};
}

bool isInteger(PixelType type) {
    return type != PixelType::Float32 && type != PixelType::Float64;
}

/// Few-valued integers get a bin each, so that no bin mixes two values.
bool hasBinPerValue(const VolumeView& volume, const Spread& spread, double mostValues) {
    return isInteger(volume.pixelType()) && spread.maximum - spread.minimum < mostValues;
}

SampleHistogram binPerValue(const VolumeView& volume, const Spread& spread) {
    const auto bins = static_cast<std::size_t>(spread.maximum - spread.minimum) + 1;
    return sampleHistogram(volume, spread.minimum - 0.5, spread.maximum + 0.5, bins);
}

/// What ITK finds: the upper edges of the classes' last bins.
std::vector<double> itkOtsu(const SampleHistogram& histogram, int count) {
    const auto itkHistogram = ItkHistogram::New();
    itkHistogram->SetMeasurementVectorSize(1);
    ItkHistogram::SizeType size(1);
    size[0] = histogram.counts.size();
    ItkHistogram::MeasurementVectorType lower(1), upper(1);
    lower[0] = histogram.lower;
    upper[0] = histogram.upper;
    itkHistogram->Initialize(size, lower, upper);
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
        itkHistogram->SetFrequency(
            bin, static_cast<ItkHistogram::AbsoluteFrequencyType>(histogram.counts[bin]));
    }
    const auto calculator = itk::OtsuMultipleThresholdsCalculator<ItkHistogram>::New();
    calculator->SetInputHistogram(itkHistogram);
    calculator->SetNumberOfThresholds(static_cast<itk::SizeValueType>(count));
    calculator->Compute();
    return calculator->GetOutput();
}

/// From bin edges to the middles of the gaps between the samples on their two sides.
std::vector<double> middlesOfGaps(const VolumeView& volume, const Spread& spread,
                                  const std::vector<double>& edges) {
    std::vector<double> below(edges.size(), spread.minimum), above(edges.size(), spread.maximum);
    std::mutex mutex;
    dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        constexpr std::int64_t kPiece = std::int64_t{1} << 18;
        parallelForPieces(
            view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
                for (std::size_t e = 0; e < edges.size(); ++e) {
                    double nearestBelow = spread.minimum, nearestAbove = spread.maximum;
                    for (std::int64_t n = begin; n < end; ++n) {
                        const auto value = static_cast<double>(view.samples[n]);
                        // NaN is neither, infinity no nearer than what is known
                        if (value <= edges[e]) nearestBelow = std::max(nearestBelow, value);
                        if (value > edges[e]) nearestAbove = std::min(nearestAbove, value);
                    }
                    const std::lock_guard lock(mutex);
                    below[e] = std::max(below[e], nearestBelow);
                    above[e] = std::min(above[e], nearestAbove);
                }
            });
    });
    std::vector<double> middles;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        middles.push_back(below[e] + (above[e] - below[e]) / 2);
    }
    return middles;
}

SampleHistogram fineHistogram(const VolumeView& volume, const Spread& spread) {
    if (hasBinPerValue(volume, spread, 65536)) return binPerValue(volume, spread);
    return sampleHistogram(volume, spread.minimum, spread.maximum, 1024);
}

SampleHistogram coarseHistogram(const VolumeView& volume, const Spread& spread) {
    constexpr std::size_t kBins = 256;
    if (hasBinPerValue(volume, spread, kBins)) return binPerValue(volume, spread);
    const bool hasMiddle = spread.low < spread.high;
    SampleHistogram histogram = sampleHistogram(volume, hasMiddle ? spread.low : spread.minimum,
                                                hasMiddle ? spread.high : spread.maximum, kBins);
    histogram.counts.front() += histogram.below;
    histogram.counts.back() += histogram.above;
    return histogram;
}

}  // namespace

double otsuThreshold(const VolumeView& volume) {
    const Spread spread = spreadOf(volume);
    return middlesOfGaps(volume, spread, itkOtsu(fineHistogram(volume, spread), 1)).front();
}

std::vector<std::vector<double>> otsuThresholds(const VolumeView& volume, int most) {
    if (most < 1 || most > 3) {
        throw InvalidInput("otsuThresholds: " + std::to_string(most) + " must be 1 to 3");
    }
    const Spread spread = spreadOf(volume);
    const SampleHistogram coarse = coarseHistogram(volume, spread);
    const auto filled = std::count_if(coarse.counts.begin(), coarse.counts.end(),
                                      [](std::int64_t bin) { return bin > 0; });
    std::vector<double> edges = itkOtsu(fineHistogram(volume, spread), 1);
    int reached = 1;
    for (; reached < most && reached + 1 < filled; ++reached) {
        const std::vector<double> more = itkOtsu(coarse, reached + 1);
        edges.insert(edges.end(), more.begin(), more.end());
    }
    const std::vector<double> middles = middlesOfGaps(volume, spread, edges);
    std::vector<std::vector<double>> thresholds;
    auto first = middles.begin();
    for (int count = 1; count <= reached; first += count, ++count) {
        thresholds.emplace_back(first, first + count);
    }
    return thresholds;
}

}  // namespace adaptiso
