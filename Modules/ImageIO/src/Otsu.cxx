#include "adaptiso/ImageIO/Otsu.h"

#include <itkHistogram.h>
#include <itkOtsuThresholdCalculator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace adaptiso {
namespace {

using Histogram = itk::Statistics::Histogram<double>;

template <class T>
bool isFinite(T value) {
    if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
    return true;
}

template <class T>
void forEachFinite(const TypedVolumeView<T>& view, auto&& body) {
    const std::int64_t count = view.geometry.voxelCount();
    for (std::int64_t i = 0; i < count; ++i) {
        if (isFinite(view.samples[i])) body(view.samples[i]);
    }
}

template <class T>
ValueRange finiteRange(const TypedVolumeView<T>& view) {
    ValueRange range{std::numeric_limits<double>::infinity(),
                     -std::numeric_limits<double>::infinity()};
    forEachFinite(view, [&](T sample) {
        range.minimum = std::min(range.minimum, static_cast<double>(sample));
        range.maximum = std::max(range.maximum, static_cast<double>(sample));
    });
    return range;
}

/// Few-valued integers get a bin each, so that no bin mixes two values.
template <class T>
Histogram::Pointer makeHistogram(const TypedVolumeView<T>& view, const ValueRange& range) {
    const double span = range.maximum - range.minimum;
    const bool binPerValue = std::is_integral_v<T> && span < 65536;
    const std::size_t bins = binPerValue ? static_cast<std::size_t>(span) + 1 : 1024;
    const double low = binPerValue ? range.minimum - 0.5 : range.minimum;
    const double high = binPerValue ? range.maximum + 0.5 : range.maximum;
    const double binsPerUnit = static_cast<double>(bins) / (high - low);

    std::vector<std::uint64_t> counts(bins, 0);
    forEachFinite(view, [&](T sample) {
        const double place = (static_cast<double>(sample) - low) * binsPerUnit;
        ++counts[std::min(static_cast<std::size_t>(place), bins - 1)];
    });

    auto histogram = Histogram::New();
    histogram->SetMeasurementVectorSize(1);
    Histogram::SizeType size(1);
    size[0] = bins;
    Histogram::MeasurementVectorType lower(1), upper(1);
    lower[0] = low;
    upper[0] = high;
    histogram->Initialize(size, lower, upper);
    for (std::size_t bin = 0; bin < bins; ++bin) histogram->SetFrequency(bin, counts[bin]);
    return histogram;
}

double itkOtsu(const Histogram& histogram) {
    auto calculator = itk::OtsuThresholdCalculator<Histogram, double>::New();
    calculator->SetInput(&histogram);
    calculator->Update();
    return calculator->GetThreshold();
}

/// From ITK's bin edge to the middle of the gap between the samples on its two sides.
template <class T>
double middleOfGap(const TypedVolumeView<T>& view, const ValueRange& range, double edge) {
    double below = range.minimum, above = range.maximum;
    forEachFinite(view, [&](T sample) {
        const auto value = static_cast<double>(sample);
        if (value <= edge) {
            below = std::max(below, value);
        } else {
            above = std::min(above, value);
        }
    });
    return below + (above - below) / 2;
}

}  // namespace

double otsuThreshold(const VolumeView& volume) {
    return dispatchPixelType(volume, [](const auto& view) {
        const ValueRange range = finiteRange(view);
        if (!(range.minimum < range.maximum)) {
            throw InvalidInput(
                "otsuThreshold: all finite samples are equal, or none is finite: "
                "there is nothing to separate; give an isovalue");
        }
        if (!std::isfinite(range.maximum - range.minimum)) {
            throw InvalidInput(
                "otsuThreshold: the samples span more than a double can hold; give "
                "an isovalue");
        }
        return middleOfGap(view, range, itkOtsu(*makeHistogram(view, range)));
    });
}

}  // namespace adaptiso
