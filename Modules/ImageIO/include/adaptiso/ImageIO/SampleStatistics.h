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

}  // namespace adaptiso
