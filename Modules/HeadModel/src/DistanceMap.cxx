// Exact Euclidean distances, one axis after the other [Saito1994]: along x by counting, along y and
// z as the least of (rows' distance)^2 + what the row holds. Squared distances between voxels are
// whole numbers, so 16 bits hold them as far as a head model asks (127 voxels), whole rows are
// compared at once, and what no caller asks for is not computed. Lower envelopes of parabolas
// [Felzenszwalb2012] cost the same for any distance, more than the 10 voxels here that are usual.
// ITK's Maurer filter measures from the last voxels inside only.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "ImageSteps.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {
namespace {

/// Squared voxels. What is farther is farther than any distance that is asked for: 23,170 voxels.
constexpr std::int64_t kMostSquared = std::int64_t{1} << 29;

/// Longest distance along one axis that counts.
std::int64_t reachOf(std::int64_t limit) {
    auto reach = static_cast<std::int64_t>(std::sqrt(static_cast<double>(limit)));
    while (reach * reach > limit) --reach;
    while ((reach + 1) * (reach + 1) <= limit) ++reach;
    return reach;
}

/// Rows of squared distances, and which of them hold nothing but limit + 1.
template <class Whole>
struct Rows {
    Rows(std::int64_t count, std::int64_t length)
        : squares(static_cast<std::size_t>(count * length)), isFar(count), width(length) {}
    Whole* row(std::int64_t n) { return squares.data() + n * width; }
    std::vector<Whole> squares;
    Mask isFar;
    std::int64_t width;
};

/// Squared distances along a row to its voxels equal to `value`. \return there are some
template <class Whole>
bool alongRow(const std::uint8_t* mask, std::uint8_t value, std::int64_t width, Whole limit,
              Whole reach, Whole* squares) {
    const auto find = [&](std::int64_t from, std::uint8_t what) {
        const void* const at = std::memchr(mask + from, what, width - from);
        return at == nullptr ? width : static_cast<const std::uint8_t*>(at) - mask;
    };
    std::fill_n(squares, width, static_cast<Whole>(limit + 1));
    std::int64_t begin = find(0, value);
    if (begin == width) return false;
    // on both sides of every run; the nearer one stays
    const auto lower = [&](std::int64_t i, std::int64_t distance) {
        const auto squared = static_cast<Whole>(distance * distance);
        squares[i] = std::min(squares[i], squared);
    };
    while (begin < width) {
        const std::int64_t end = find(begin, value ^ 1);
        std::fill(squares + begin, squares + end, Whole{0});
        for (std::int64_t d = 1; d <= reach && d <= begin && squares[begin - d] != 0; ++d) {
            lower(begin - d, d);
        }
        const std::int64_t next = end < width ? find(end, value) : width;
        for (std::int64_t i = end; i < next && i - end < reach; ++i) lower(i, i - end + 1);
        begin = next;
    }
    return true;
}

/// least[i] = min(least[i], squares[i] + step)
template <class Whole>
void takeLeast(const Whole* __restrict squares, Whole step, std::int64_t width,
               Whole* __restrict least) {
    for (std::int64_t i = 0; i < width; ++i) {
        const auto other = static_cast<Whole>(squares[i] + step);
        least[i] = other < least[i] ? other : least[i];
    }
}

template <class Whole>
Whole greatest(const Whole* values, std::int64_t width) {
    Whole most = 0;
    for (std::int64_t i = 0; i < width; ++i) most = values[i] > most ? values[i] : most;
    return most;
}

/// Across rows: least = min over rows n of (n - at)^2 + row n. \return not all of it is far
template <class Whole>
bool acrossRows(Rows<Whole>& rows, std::int64_t at, Whole limit, Whole reach, Whole* least) {
    const auto count = static_cast<std::int64_t>(rows.isFar.size());
    std::copy_n(rows.row(at), rows.width, least);
    bool isNear = rows.isFar[at] == 0;
    Whole most = isNear ? greatest(least, rows.width) : static_cast<Whole>(limit + 1);
    constexpr std::int64_t kRowsPerLook = 4;  // to look for the greatest costs as much as a row
    for (std::int64_t d = 1; d <= reach && d * d < most; ++d) {
        const auto step = static_cast<Whole>(d * d);
        for (const std::int64_t n : {at - d, at + d}) {
            if (n < 0 || n >= count || rows.isFar[n] != 0) continue;
            takeLeast(rows.row(n), step, rows.width, least);
            isNear = true;
        }
        if (isNear && d % kRowsPerLook == 0) most = greatest(least, rows.width);
    }
    return isNear;
}

/// Calls take(first voxel, squares of a row along x) for all rows: squared distances in voxels to
/// the nearest voxel of `mask` equal to `value`; limit + 1 where that is more than `limit`.
template <class Whole, class Take>
void forRowsOfSquares(const Mask& mask, std::uint8_t value, const Index3& size, Whole limit,
                      const Take& take) {
    const auto reach = static_cast<Whole>(reachOf(limit));
    const std::int64_t width = size[0], slice = size[0] * size[1];
    Rows<Whole> rows(size[1] * size[2], width);
    parallelForPieces(size[2], 1, [&](std::int64_t k, std::int64_t) {
        Rows<Whole> plane(size[1], width);
        for (std::int64_t j = 0; j < size[1]; ++j) {
            plane.isFar[j] = alongRow(mask.data() + k * slice + j * width, value, width, limit,
                                      reach, plane.row(j))
                                 ? 0
                                 : 1;
        }
        for (std::int64_t j = 0; j < size[1]; ++j) {
            const std::int64_t n = k * size[1] + j;
            rows.isFar[n] = acrossRows(plane, j, limit, reach, rows.row(n)) ? 0 : 1;
        }
    });
    parallelForPieces(size[1], 1, [&](std::int64_t j, std::int64_t) {
        Rows<Whole> plane(size[2], width);
        for (std::int64_t k = 0; k < size[2]; ++k) {
            plane.isFar[k] = rows.isFar[k * size[1] + j];
            std::copy_n(rows.row(k * size[1] + j), width, plane.row(k));
        }
        std::vector<Whole> least(width);
        for (std::int64_t k = 0; k < size[2]; ++k) {
            acrossRows(plane, k, limit, reach, least.data());
            take(k * slice + j * width, least.data());
        }
    });
}

/// No more than a grid's diagonal.
std::int64_t limitOn(const Index3& size, double squared) {
    double diagonal = 0;
    for (const std::int64_t n : size) diagonal += static_cast<double>(n) * static_cast<double>(n);
    return static_cast<std::int64_t>(
        std::min({squared, diagonal, static_cast<double>(kMostSquared)}));
}

/// The same with numbers no wider than `limit` needs.
template <class Take>
void forSquaredDistances(const Mask& mask, std::uint8_t value, const Index3& size,
                         std::int64_t limit, const Take& take) {
    const std::int64_t reach = reachOf(limit);
    // the largest sum that is made: far, and one reach across rows
    if (limit + 1 + reach * reach <= std::numeric_limits<std::int16_t>::max()) {
        forRowsOfSquares(mask, value, size, static_cast<std::int16_t>(limit), take);
    } else {
        forRowsOfSquares(mask, value, size, static_cast<std::int32_t>(limit), take);
    }
}

/// `inside` within `limit` squared voxels of the voxels equal to `value`, elsewhere the other.
Mask within(const Mask& mask, std::uint8_t value, const Index3& size, std::int64_t limit,
            std::uint8_t inside) {
    Mask result(mask.size());
    forSquaredDistances(mask, value, size, limit,
                        [&]<class Whole>(std::int64_t first, const Whole* squares) {
                            const auto most = static_cast<Whole>(limit);
                            const auto outside = static_cast<std::uint8_t>(inside ^ 1);
                            const std::uint8_t side = inside;
                            std::uint8_t* const out = result.data() + first;
                            const std::int64_t width = size[0];
                            for (std::int64_t n = 0; n < width; ++n)
                                out[n] = squares[n] <= most ? side : outside;
                        });
    return result;
}

/// mm inside the surface of a voxel whose nearest one of the other side is so far away.
float insideMm(std::int64_t squared, float step) {
    return step * (std::sqrt(static_cast<float>(squared)) - 0.5f);
}

/// The largest squared distance of a grid for which `holds`, which then holds for no larger one.
template <class Holds>
std::int64_t largestSquared(const Index3& size, double guessVoxels, const Holds& holds) {
    const std::int64_t most = limitOn(size, std::numeric_limits<double>::infinity());
    std::int64_t squared = limitOn(size, guessVoxels * guessVoxels);
    while (squared > 0 && !holds(squared)) --squared;
    while (squared < most && holds(squared + 1)) ++squared;
    return squared;
}

}  // namespace

std::vector<float> depthMm(const Mask& mask, const ImageGeometry& grid, const DepthBand& band) {
    const auto step = static_cast<float>(stepMm(grid));
    std::vector<float> depth(mask.size());
    const auto measure = [&](std::uint8_t other, double bandMm) {
        if (!(bandMm > 0)) return;
        const auto most = static_cast<float>(bandMm);
        const double voxels = bandMm / step + 1;  // a half for the surface, a half for rounding
        const std::int64_t limit = limitOn(grid.size, voxels * voxels);
        const float sign = other == 0 ? 1 : -1;
        const auto mmOf = [&](std::int64_t squared) {
            return sign * (squared > limit ? most : std::min(insideMm(squared, step), most));
        };
        // square roots of what most voxels have
        std::vector<float> table(std::min<std::int64_t>(limit, 1 << 14) + 2);
        for (std::int64_t n = 0; n < std::ssize(table); ++n) table[n] = mmOf(n);
        forSquaredDistances(
            mask, other, grid.size, limit, [&](std::int64_t first, const auto* squares) {
                for (std::int64_t n = 0; n < grid.size[0]; ++n) {
                    if (mask[first + n] == other) continue;
                    depth[first + n] =
                        squares[n] < std::ssize(table) ? table[squares[n]] : mmOf(squares[n]);
                }
            });
    };
    measure(0, band.insideMm);
    measure(1, band.outsideMm);
    return depth;
}

Mask dilated(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    if (!(radiusMm > 0)) return mask;
    const auto step = static_cast<float>(stepMm(grid));
    const std::int64_t limit =
        largestSquared(grid.size, radiusMm / step + 0.5,
                       [&](std::int64_t squared) { return -insideMm(squared, step) >= -radiusMm; });
    return within(mask, 1, grid.size, limit, 1);
}

Mask eroded(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    if (!(radiusMm > 0)) return mask;
    const auto step = static_cast<float>(stepMm(grid));
    // what a dilation of the outside leaves: a depth of the very radius goes
    const auto radius = static_cast<float>(radiusMm);
    const std::int64_t limit =
        largestSquared(grid.size, radiusMm / step + 0.5,
                       [&](std::int64_t squared) { return insideMm(squared, step) <= radius; });
    return within(mask, 0, grid.size, limit, 0);
}

}  // namespace adaptiso::headmodel
