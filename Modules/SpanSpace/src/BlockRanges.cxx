#include "BlockRanges.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

/// The lowest value of a sample: what virtual outside samples and NaN count as.
template <class T>
constexpr T outsideValue() {
    return std::is_floating_point_v<T> ? -std::numeric_limits<T>::infinity()
                                       : std::numeric_limits<T>::lowest();
}

template <class T>
constexpr T highestValue() {
    return std::is_floating_point_v<T> ? std::numeric_limits<T>::infinity()
                                       : std::numeric_limits<T>::max();
}

/// Samples [begin, end) of the volume that blocks at position `block` along an axis cover.
struct SampleSpan {
    std::int64_t begin, end;
    bool leavesVolume;  ///< virtual samples of a closed border lie in it
};
SampleSpan samplesOf(const BlockGrid& grid, int axis, std::int64_t block) {
    const std::int64_t first = block * grid.blockSize - grid.offset;
    const std::int64_t last = first + grid.blockSize;
    return {std::max<std::int64_t>(first, 0), std::min(last + 1, grid.volumeSize[axis]),
            grid.border == Border::Closed && (first < 0 || last >= grid.volumeSize[axis])};
}

template <class T>
void accumulateRow(const T* row, std::int64_t count, T* low, T* high) {
    for (std::int64_t i = 0; i < count; ++i) {
        T below = row[i], above = row[i];
        if constexpr (std::is_floating_point_v<T>) {
            if (row[i] != row[i]) below = above = outsideValue<T>();
        }
        low[i] = below < low[i] ? below : low[i];
        high[i] = above > high[i] ? above : high[i];
    }
}

}  // namespace

template <class T>
BlockRanges<T> computeBlockRanges(const TypedVolumeView<T>& volume, const BlockGrid& grid) {
    BlockRanges<T> ranges;
    ranges.minimum.resize(grid.blockCount());
    ranges.maximum.resize(grid.blockCount());
    const std::int64_t width = grid.volumeSize[0];

    // a row of blocks at a time: first over y and z for every x (vectorizes), then along x
    parallelForPieces(
        grid.blocks[1] * grid.blocks[2], 4, [&](std::int64_t begin, std::int64_t end) {
            std::vector<T> low(width), high(width);
            for (std::int64_t row = begin; row < end; ++row) {
                const SampleSpan y = samplesOf(grid, 1, row % grid.blocks[1]);
                const SampleSpan z = samplesOf(grid, 2, row / grid.blocks[1]);
                std::fill(low.begin(), low.end(), highestValue<T>());
                std::fill(high.begin(), high.end(), outsideValue<T>());
                for (std::int64_t k = z.begin; k < z.end; ++k) {
                    for (std::int64_t j = y.begin; j < y.end; ++j) {
                        accumulateRow(&volume.at(0, j, k), width, low.data(), high.data());
                    }
                }
                for (std::int64_t b = 0; b < grid.blocks[0]; ++b) {
                    const SampleSpan x = samplesOf(grid, 0, b);
                    const std::int64_t block = row * grid.blocks[0] + b;
                    const bool touchesOutside = x.leavesVolume || y.leavesVolume || z.leavesVolume;
                    ranges.minimum[block] =
                        touchesOutside ? outsideValue<T>()
                                       : *std::min_element(&low[x.begin], low.data() + x.end);
                    ranges.maximum[block] = *std::max_element(&high[x.begin], high.data() + x.end);
                }
            }
        });
    return ranges;
}

template BlockRanges<std::uint8_t> computeBlockRanges(const TypedVolumeView<std::uint8_t>&,
                                                      const BlockGrid&);
template BlockRanges<std::int8_t> computeBlockRanges(const TypedVolumeView<std::int8_t>&,
                                                     const BlockGrid&);
template BlockRanges<std::uint16_t> computeBlockRanges(const TypedVolumeView<std::uint16_t>&,
                                                       const BlockGrid&);
template BlockRanges<std::int16_t> computeBlockRanges(const TypedVolumeView<std::int16_t>&,
                                                      const BlockGrid&);
template BlockRanges<std::uint32_t> computeBlockRanges(const TypedVolumeView<std::uint32_t>&,
                                                       const BlockGrid&);
template BlockRanges<std::int32_t> computeBlockRanges(const TypedVolumeView<std::int32_t>&,
                                                      const BlockGrid&);
template BlockRanges<std::uint64_t> computeBlockRanges(const TypedVolumeView<std::uint64_t>&,
                                                       const BlockGrid&);
template BlockRanges<std::int64_t> computeBlockRanges(const TypedVolumeView<std::int64_t>&,
                                                      const BlockGrid&);
template BlockRanges<float> computeBlockRanges(const TypedVolumeView<float>&, const BlockGrid&);
template BlockRanges<double> computeBlockRanges(const TypedVolumeView<double>&, const BlockGrid&);

}  // namespace adaptiso::detail
