#include "adaptiso/Core/MortonOrder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "adaptiso/Core/Memory.h"

namespace adaptiso::detail {

MortonCurve::MortonCurve(const BoundingBox& box) : low_(box.minimum) {
    const Vec3 extent = box.size();
    const double widest = std::max({extent.x, extent.y, extent.z});
    unit_ = widest > 0 ? kLast / widest : 0;
    for (std::size_t i = 0; i < spread_.size(); ++i) {
        for (int bit = 0; bit < kBits; ++bit) spread_[i] |= (i >> bit & 1) << (3 * bit);
    }
}

/// A radix sort, digit by digit from the lowest of the place; pieces side by side.
std::vector<std::uint32_t> sortedByKeys(std::vector<std::uint64_t> keys) {
    constexpr std::int64_t kPiece = 1 << 15;
    constexpr int kDigitBits = 10, kFirstBit = 32, kBits = 30;
    constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
    const std::int64_t count = std::ssize(keys), pieces = (count + kPiece - 1) / kPiece;
    std::vector<std::array<std::uint32_t, kDigits>> next(static_cast<std::size_t>(pieces));
    std::vector<std::uint64_t> sorted;
    assignInHugePages(sorted, keys.size());
    for (int bit = kFirstBit; bit < kFirstBit + kBits; bit += kDigitBits) {
        const auto digitOf = [&](std::uint64_t key) { return key >> bit & (kDigits - 1); };
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            auto& counts = next[begin / kPiece];
            counts.fill(0);
            for (std::int64_t i = begin; i < end; ++i) ++counts[digitOf(keys[i])];
        });
        std::uint32_t place = 0;
        for (std::size_t digit = 0; digit < kDigits; ++digit) {
            for (auto& counts : next) place += std::exchange(counts[digit], place);
        }
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            auto& places = next[begin / kPiece];
            for (std::int64_t i = begin; i < end; ++i) {
                sorted[places[digitOf(keys[i])]++] = keys[i];
            }
        });
        keys.swap(sorted);
    }
    freeMemory(sorted);
    std::vector<std::uint32_t> numbers;
    assignInHugePages(numbers, keys.size());
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) numbers[i] = static_cast<std::uint32_t>(keys[i]);
    });
    return numbers;
}

}  // namespace adaptiso::detail
