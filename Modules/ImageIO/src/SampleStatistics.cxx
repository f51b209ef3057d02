#include "adaptiso/ImageIO/SampleStatistics.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"

namespace adaptiso {

namespace {

constexpr std::int64_t kPiece = std::int64_t{1} << 18;
constexpr int kDigitBits = 16;
constexpr std::uint64_t kDigits = std::uint64_t{1} << kDigitBits;

template <std::size_t kBytes>
using UnsignedOf = std::conditional_t<
    kBytes == 1, std::uint8_t,
    std::conditional_t<kBytes == 2, std::uint16_t,
                       std::conditional_t<kBytes == 4, std::uint32_t, std::uint64_t>>>;

template <class T>
bool isFinite(T value) {
    if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
    return true;
}

/// Whole numbers in the order of the samples: -0 comes before 0.
template <class T>
struct OrderedKey {
    using Key = UnsignedOf<sizeof(T)>;
    static constexpr int kBits = 8 * sizeof(T);
    static constexpr Key kSign = static_cast<Key>(Key{1} << (kBits - 1));

    static Key of(T value) {
        const auto bits = std::bit_cast<Key>(value);
        if constexpr (std::is_unsigned_v<T>) return bits;
        if constexpr (std::is_integral_v<T>) return static_cast<Key>(bits ^ kSign);
        return static_cast<Key>((bits & kSign) != 0 ? ~bits : bits | kSign);
    }
    static T valueOf(Key key) {
        Key bits = key;
        if constexpr (std::is_floating_point_v<T>) {
            bits = static_cast<Key>((key & kSign) != 0 ? key ^ kSign : ~key);
        } else if constexpr (std::is_signed_v<T>) {
            bits = static_cast<Key>(key ^ kSign);
        }
        return std::bit_cast<T>(bits);
    }
};

/// A rank among the samples whose keys begin with `prefix`; in the end the key itself.
struct Rank {
    std::uint64_t prefix = 0;
    std::int64_t left = 0;  ///< samples of that prefix that come before
};

using Counts = std::vector<std::int64_t>;  // by digit

/// Counts the digit at `shift` of the keys that begin with one of `prefixes` (above shift + 16).
template <class T>
std::vector<Counts> countDigits(const TypedVolumeView<T>& view,
                                const std::vector<std::uint64_t>& prefixes, int shift) {
    PerThread<std::vector<Counts>> perThread(
        [&] { return std::vector<Counts>(prefixes.size(), Counts(kDigits, 0)); });
    parallelForPieces(
        view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
            std::vector<Counts>& counts = perThread.local();
            for (std::int64_t n = begin; n < end; ++n) {
                if (!isFinite(view.samples[n])) continue;
                const auto key = static_cast<std::uint64_t>(OrderedKey<T>::of(view.samples[n]));
                const std::uint64_t rest = key >> shift;
                const auto place =
                    std::lower_bound(prefixes.begin(), prefixes.end(), rest >> kDigitBits);
                if (place == prefixes.end() || *place != rest >> kDigitBits) continue;
                ++counts[static_cast<std::size_t>(place - prefixes.begin())][rest % kDigits];
            }
        });
    std::vector<Counts> total(prefixes.size(), Counts(kDigits, 0));
    for (const std::vector<Counts>& counts : perThread) {
        for (std::size_t p = 0; p < counts.size(); ++p) {
            std::transform(counts[p].begin(), counts[p].end(), total[p].begin(), total[p].begin(),
                           std::plus<>());
        }
    }
    return total;
}

/// Extends every rank's prefix by one digit.
template <class T>
void refine(const TypedVolumeView<T>& view, std::vector<Rank>& ranks, int shift) {
    std::vector<std::uint64_t> prefixes;
    for (const Rank& rank : ranks) prefixes.push_back(rank.prefix);
    std::sort(prefixes.begin(), prefixes.end());
    prefixes.erase(std::unique(prefixes.begin(), prefixes.end()), prefixes.end());
    const std::vector<Counts> counts = countDigits(view, prefixes, shift);
    for (Rank& rank : ranks) {
        const auto place = std::lower_bound(prefixes.begin(), prefixes.end(), rank.prefix);
        const Counts& digits = counts[static_cast<std::size_t>(place - prefixes.begin())];
        std::size_t digit = 0;
        for (; rank.left >= digits[digit]; ++digit) rank.left -= digits[digit];
        rank.prefix = rank.prefix << kDigitBits | digit;
    }
}

}  // namespace

std::int64_t countFinite(const VolumeView& volume) {
    return dispatchPixelType(volume, []<class T>(const TypedVolumeView<T>& view) {
        if constexpr (std::is_integral_v<T>) return view.geometry.voxelCount();
        std::atomic<std::int64_t> count{0};
        parallelForPieces(
            view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
                count += std::count_if(view.samples + begin, view.samples + end, isFinite<T>);
            });
        return count.load();
    });
}

std::vector<double> percentiles(const VolumeView& volume, std::span<const double> percents) {
    const std::int64_t count = countFinite(volume);
    std::vector<Rank> ranks;
    for (const double percent : percents) {
        if (!(percent >= 0 && percent <= 100)) {
            throw InvalidInput("percentiles: " + std::to_string(percent) + " must be 0 to 100");
        }
        // a hair less: 0.1 percent of 1000 samples is the first, however 0.001 rounds
        const double rank = std::ceil(percent / 100 * static_cast<double>(count) - 1e-9);
        const auto number = std::clamp(static_cast<std::int64_t>(rank), std::int64_t{1},
                                       std::max(count, std::int64_t{1}));
        ranks.push_back({0, number - 1});
    }
    if (count == 0 || ranks.empty()) return {};
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        for (int shift = std::max(0, OrderedKey<T>::kBits - kDigitBits); shift >= 0;
             shift -= kDigitBits) {
            refine(view, ranks, shift);
        }
        std::vector<double> values;
        for (const Rank& rank : ranks) {
            const auto key = static_cast<typename OrderedKey<T>::Key>(rank.prefix);
            values.push_back(static_cast<double>(OrderedKey<T>::valueOf(key)));
        }
        return values;
    });
}

SampleHistogram sampleHistogram(const VolumeView& volume, double lower, double upper,
                                std::size_t bins) {
    const double binsPerUnit = static_cast<double>(bins) / (upper - lower);
    if (!(lower < upper) || !std::isfinite(upper - lower) || bins < 1) {
        throw InvalidInput("sampleHistogram: needs lower < upper, both finite, and a bin");
    }
    SampleHistogram histogram{lower, upper, Counts(bins, 0), 0, 0};
    dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        // the bins, and one on either side
        PerThread<Counts> perThread([&] { return Counts(bins + 2, 0); });
        parallelForPieces(
            view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
                Counts& counts = perThread.local();
                for (std::int64_t n = begin; n < end; ++n) {
                    if (!isFinite(view.samples[n])) continue;
                    const auto value = static_cast<double>(view.samples[n]);
                    const double place = (value - lower) * binsPerUnit;
                    const std::size_t bin =
                        value < lower   ? 0
                        : value > upper ? bins + 1
                                        : std::min(static_cast<std::size_t>(place), bins - 1) + 1;
                    ++counts[bin];
                }
            });
        for (const Counts& counts : perThread) {
            for (std::size_t bin = 0; bin < bins; ++bin) histogram.counts[bin] += counts[bin + 1];
            histogram.below += counts.front();
            histogram.above += counts.back();
        }
    });
    return histogram;
}

namespace {

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

/// The bins' upper edges, rounded as itk::Statistics::Histogram rounds them (steps are floats).
std::vector<double> upperEdges(const SampleHistogram& histogram) {
    const std::size_t bins = histogram.counts.size();
    const float step = (static_cast<float>(histogram.upper) - static_cast<float>(histogram.lower)) /
                       static_cast<float>(bins);
    std::vector<double> edges(bins, histogram.upper);
    for (std::size_t bin = 0; bin + 1 < bins; ++bin) {
        edges[bin] = histogram.lower + static_cast<double>((static_cast<float>(bin) + 1) * step);
    }
    return edges;
}

/// Samples of a histogram split into classes of neighbouring bins, and the choice of the classes'
/// last bins with the largest variance between them; of equal ones (to one unit in the last place)
/// the first. In the order of itk::OtsuMultipleThresholdsCalculator, whose numbers it gives to the
/// bit.
class OtsuSearch {
public:
    OtsuSearch(const SampleHistogram& histogram, int count)
        : counts_(histogram.counts), edges_(upperEdges(histogram)), last_(count) {
        double lower = histogram.lower;
        for (std::size_t bin = 0; bin < edges_.size(); ++bin) {
            middles_.push_back((lower + edges_[bin]) / 2.0);
            lower = edges_[bin];
            total_ += counts_[bin];
            mean_ += middles_[bin] * static_cast<double>(counts_[bin]);
        }
        mean_ /= static_cast<double>(total_);
        for (std::size_t c = 0; c < last_.size(); ++c) last_[c] = c;
        counted_.resize(last_.size() + 1);
        means_.resize(counted_.size());
        for (std::size_t c = 0; c < last_.size(); ++c) startClass(c);
        finishLastClass(mean_ * static_cast<double>(total_));
    }

    /// The upper edges of the chosen classes' last bins.
    std::vector<double> best() {
        std::vector<std::size_t> chosen = last_;
        double most = variance();
        while (advance()) {
            const double now = variance();
            if (!(now > most) || isAlmost(most, now)) continue;
            most = now;
            chosen = last_;
        }
        std::vector<double> found;
        for (const std::size_t bin : chosen) found.push_back(edges_[bin]);
        return found;
    }

private:
    static bool isAlmost(double a, double b) {
        return std::abs(a - b) <= 0.1 * std::numeric_limits<double>::epsilon() ||
               std::abs(std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b)) <= 1;
    }

    /// A class of the one bin last_[c].
    void startClass(std::size_t c) {
        counted_[c] = counts_[last_[c]];
        means_[c] = counted_[c] > 0 ? middles_[last_[c]] : 0;
    }

    /// The last class holds what the others leave of `sum`.
    void finishLastClass(double sum) {
        counted_.back() = total_;
        for (std::size_t c = 0; c < last_.size(); ++c) {
            counted_.back() -= counted_[c];
            sum -= means_[c] * static_cast<double>(counted_[c]);
        }
        means_.back() = counted_.back() > 0 ? sum / static_cast<double>(counted_.back()) : 0;
    }

    /// The next choice. \return false after the last
    bool advance() {
        std::size_t c = last_.size();
        while (c-- > 0) {
            if (last_[c] + 2 + (last_.size() - 1 - c) < counts_.size()) break;
            if (c == 0) return false;
        }
        const std::size_t bin = ++last_[c];
        const double before = means_[c] * static_cast<double>(counted_[c]);
        counted_[c] += counts_[bin];
        means_[c] = counted_[c] > 0 ? (before + middles_[bin] * static_cast<double>(counts_[bin])) /
                                          static_cast<double>(counted_[c])
                                    : 0;
        for (std::size_t next = c + 1; next < last_.size(); ++next) {
            last_[next] = last_[next - 1] + 1;
            startClass(next);
        }
        finishLastClass(mean_ * static_cast<double>(total_));
        return true;
    }

    double variance() const {
        double sum = 0;
        for (std::size_t c = 0; c < means_.size(); ++c) {
            sum += static_cast<double>(counted_[c]) * (means_[c] * means_[c]);
        }
        return sum / static_cast<double>(total_);
    }

    const std::vector<std::int64_t>& counts_;
    std::vector<double> edges_, middles_;
    std::vector<std::size_t> last_;  ///< the last bin of every class but the last
    std::vector<std::int64_t> counted_;
    std::vector<double> means_;
    std::int64_t total_ = 0;
    double mean_ = 0;
};

/// From bin edges to the middles of the gaps between the samples on their two sides.
std::vector<double> middlesOfGaps(const VolumeView& volume, const Spread& spread,
                                  const std::vector<double>& edges) {
    std::vector<double> below(edges.size(), spread.minimum), above(edges.size(), spread.maximum);
    std::mutex mutex;
    dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
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
    const SampleHistogram fine = fineHistogram(volume, spread);
    return middlesOfGaps(volume, spread, OtsuSearch(fine, 1).best()).front();
}

std::vector<std::vector<double>> otsuThresholds(const VolumeView& volume, int most) {
    if (most < 1 || most > 3) {
        throw InvalidInput("otsuThresholds: " + std::to_string(most) + " must be 1 to 3");
    }
    const Spread spread = spreadOf(volume);
    const SampleHistogram coarse = coarseHistogram(volume, spread);
    const auto filled = std::count_if(coarse.counts.begin(), coarse.counts.end(),
                                      [](std::int64_t bin) { return bin > 0; });
    const SampleHistogram fine = fineHistogram(volume, spread);
    std::vector<double> edges = OtsuSearch(fine, 1).best();
    int reached = 1;
    for (; reached < most && reached + 1 < filled; ++reached) {
        const std::vector<double> more = OtsuSearch(coarse, reached + 1).best();
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
