#include "adaptiso/Core/MortonOrder.h"

#include <algorithm>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/ParallelSort.h"

namespace adaptiso::detail {

MortonCurve::MortonCurve(const BoundingBox& box) : low_(box.minimum) {
    const Vec3 extent = box.size();
    const double widest = std::max({extent.x, extent.y, extent.z});
    unit_ = widest > 0 ? kLast / widest : 0;
    for (std::size_t i = 0; i < spread_.size(); ++i) {
        for (int bit = 0; bit < kBits; ++bit) spread_[i] |= (i >> bit & 1) << (3 * bit);
    }
}

std::vector<std::uint32_t> sortedByKeys(std::vector<std::uint64_t> keys) {
    constexpr std::int64_t kPiece = 1 << 14;
    parallelSort(keys);
    std::vector<std::uint32_t> numbers;
    assignInHugePages(numbers, keys.size());
    parallelForPieces(std::ssize(keys), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) numbers[i] = static_cast<std::uint32_t>(keys[i]);
    });
    return numbers;
}

}  // namespace adaptiso::detail
