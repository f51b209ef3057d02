#include "adaptiso/ImageIO/SampleStatistics.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>

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

}  // namespace adaptiso
