#include "BlockSearch.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

void sortBlocks(std::vector<std::uint32_t>& blocks, std::int64_t blockCount) {
    if (std::ssize(blocks) < blockCount / 64) {
        std::sort(blocks.begin(), blocks.end());
        return;
    }
    std::vector<std::uint64_t> words((blockCount + 63) / 64, 0);
    for (const std::uint32_t b : blocks) words[b / 64] |= std::uint64_t{1} << (b % 64);
    auto next = blocks.begin();
    for (std::size_t w = 0; w < words.size(); ++w) {
        for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
            *next++ = static_cast<std::uint32_t>(w * 64 + std::countr_zero(bits));
        }
    }
}

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

/// The ranges of the blocks of a row along i.
template <class T>
class RowRanges {
public:
    RowRanges(const TypedVolumeView<T>& volume, const BlockGrid& grid)
        : volume_(volume), grid_(grid), low_(grid.volumeSize[0]), high_(grid.volumeSize[0]) {}

    /// Calls f(block, minimum, maximum) for every block of a row: first over y and z for every x
    /// (vectorizes), then along x.
    template <class F>
    void forEachBlock(std::int64_t row, const F& f) {
        const SampleSpan y = samplesOf(grid_, 1, row % grid_.blocks[1]);
        const SampleSpan z = samplesOf(grid_, 2, row / grid_.blocks[1]);
        std::fill(low_.begin(), low_.end(), highestValue<T>());
        std::fill(high_.begin(), high_.end(), outsideValue<T>());
        for (std::int64_t k = z.begin; k < z.end; ++k) {
            for (std::int64_t j = y.begin; j < y.end; ++j) {
                accumulateRow(&volume_.at(0, j, k), grid_.volumeSize[0], low_.data(), high_.data());
            }
        }
        for (std::int64_t b = 0; b < grid_.blocks[0]; ++b) {
            const SampleSpan x = samplesOf(grid_, 0, b);
            const bool touchesOutside = x.leavesVolume || y.leavesVolume || z.leavesVolume;
            f(row * grid_.blocks[0] + b,
              touchesOutside ? outsideValue<T>()
                             : *std::min_element(&low_[x.begin], low_.data() + x.end),
              *std::max_element(&high_[x.begin], high_.data() + x.end));
        }
    }

private:
    const TypedVolumeView<T>& volume_;
    const BlockGrid& grid_;
    std::vector<T> low_, high_;  ///< of the row's samples at every i
};

constexpr std::int64_t kRows = 4;  ///< of blocks, in a piece

}  // namespace

template <class T>
BlockRanges<T> computeBlockRanges(const TypedVolumeView<T>& volume, const BlockGrid& grid) {
    BlockRanges<T> ranges;
    ranges.minimum.resize(grid.blockCount());
    ranges.maximum.resize(grid.blockCount());
    parallelForPieces(grid.blocks[1] * grid.blocks[2], kRows,
                      [&](std::int64_t begin, std::int64_t end) {
                          RowRanges<T> rows(volume, grid);
                          for (std::int64_t row = begin; row < end; ++row) {
                              rows.forEachBlock(row, [&](std::int64_t block, T minimum, T maximum) {
                                  ranges.minimum[block] = minimum;
                                  ranges.maximum[block] = maximum;
                              });
                          }
                      });
    return ranges;
}

template <class T>
std::vector<std::uint32_t> blocksAround(const TypedVolumeView<T>& volume, const BlockGrid& grid,
                                        T threshold) {
    const std::int64_t count = grid.blocks[1] * grid.blocks[2];
    std::vector<std::vector<std::uint32_t>> pieces((count + kRows - 1) / kRows);
    parallelForPieces(count, kRows, [&](std::int64_t begin, std::int64_t end) {
        RowRanges<T> rows(volume, grid);
        for (std::int64_t row = begin; row < end; ++row) {
            rows.forEachBlock(row, [&](std::int64_t block, T minimum, T maximum) {
                if (minimum < threshold && maximum >= threshold) {
                    pieces[begin / kRows].push_back(static_cast<std::uint32_t>(block));
                }
            });
        }
    });
    std::vector<std::uint32_t> blocks;
    for (const auto& piece : pieces) blocks.insert(blocks.end(), piece.begin(), piece.end());
    return blocks;
}

#define ADAPTISO_INSTANTIATE(T)                                                                   \
    template BlockRanges<T> computeBlockRanges(const TypedVolumeView<T>&, const BlockGrid&);      \
    template std::vector<std::uint32_t> blocksAround(const TypedVolumeView<T>&, const BlockGrid&, \
                                                     T);
ADAPTISO_FOR_EACH_SAMPLE_TYPE(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
