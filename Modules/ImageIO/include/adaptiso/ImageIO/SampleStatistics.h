#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Samples that are neither NaN nor infinite.
std::int64_t countFinite(const VolumeView& volume);

/// Percentiles of a volume's finite samples by nearest rank: for each p of `percents` the smallest
/// sample that at least p percent of the samples do not exceed; 0 gives the smallest of all.
///
/// Exact, for every pixel type: ranks are found by counting 16 bits of the samples at a time.
/// \param percents  each 0 to 100, in any order
/// \return  as many, empty when no sample is finite. 64-bit integers are rounded to double
/// \throws  InvalidInput for another percent
/// Cost: one parallel pass over 8- and 16-bit samples, two over 32-bit, four over 64-bit ones.
std::vector<double> percentiles(const VolumeView& volume, std::span<const double> percents);

/// Finite samples counted in bins of equal width, from `lower` to `upper`; each bin holds its lower
/// edge, the last one `upper` too.
struct SampleHistogram {
    double lower = 0, upper = 0;
    std::vector<std::int64_t> counts;
    std::int64_t below = 0, above = 0;  ///< samples outside

    double edge(std::size_t bin) const {
        return lower +
               (upper - lower) * static_cast<double>(bin) / static_cast<double>(counts.size());
    }
};

/// \pre lower < upper, both and their difference finite; bins >= 1 \throws InvalidInput otherwise
/// Cost: one parallel pass; the same counts whatever the thread count.
SampleHistogram sampleHistogram(const VolumeView& volume, double lower, double upper,
                                std::size_t bins);

/// The isovalue that best splits a volume's samples into two classes [Otsu1979].
///
/// Works on a histogram of the finite samples (one bin a value for integers that span at most 65536
/// values, else 1024 bins between the smallest and the largest), as
/// itk::OtsuMultipleThresholdsCalculator does. The isovalue is the middle between the largest
/// sample of the low class and the smallest of the high class, so it lies halfway across an empty
/// gap: 0 and 100 give 50, the integers 3 and 4 give 3.5.
///
/// \return  an isovalue in the samples' unit, low class < isovalue <= high class.
/// \throws  InvalidInput when all finite samples are equal, or none is finite.
/// Cost: a few parallel passes over the samples; the same answer whatever the thread count.
double otsuThreshold(const VolumeView& volume);

/// The isovalues that best split a volume's samples into two, three and so on to most + 1 classes,
/// ascending: first one isovalue, that of otsuThreshold(), then two, then three.
///
/// For several, every choice is tried among 256 bins (one a value for integers that span fewer),
/// between the percentiles 0.1 and 99.9, so that a few outliers do not make the bins coarse;
/// samples beyond count in the outermost bins.
///
/// \return  `most` lists; fewer where no more bins than that are filled
/// \throws  InvalidInput as otsuThreshold(), and unless 1 <= most <= 3 (more would take minutes)
std::vector<std::vector<double>> otsuThresholds(const VolumeView& volume, int most);

}  // namespace adaptiso
