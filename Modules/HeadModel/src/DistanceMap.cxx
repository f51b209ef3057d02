// Exact Euclidean distances by lower envelopes of parabolas, one axis after the other
// [Felzenszwalb2012]. ITK's Maurer filter gives the same numbers in several times the time, and
// measures from the last voxels inside only.
#include <cmath>
#include <limits>

#include "ImageSteps.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// What a row needs besides the volume itself.
struct Scratch {
    explicit Scratch(std::int64_t length) : height(length), place(length), border(length + 1) {}
    std::vector<float> height;
    std::vector<std::int64_t> place;  ///< where the parabolas of the envelope stand
    std::vector<double> border;       ///< from where on each is the lowest
};

/// One row: squares[n] = min over m of (n - m)^2 + squares[m].
void lowerEnvelope(float* squares, std::int64_t length, std::int64_t stride, Scratch& scratch) {
    std::int64_t count = 0;
    for (std::int64_t n = 0; n < length; ++n) {
        const float height = squares[n * stride];
        scratch.height[n] = height;
        if (height == kFar) continue;
        double from = -std::numeric_limits<double>::infinity();
        while (count > 0) {
            const std::int64_t m = scratch.place[count - 1];
            const double rise = static_cast<double>(height) - scratch.height[m];
            from = (rise / static_cast<double>(n - m) + static_cast<double>(n + m)) / 2;
            if (from > scratch.border[count - 1]) break;
            --count;
            from = -std::numeric_limits<double>::infinity();
        }
        scratch.place[count] = n;
        scratch.border[count++] = from;
    }
    std::int64_t at = 0;
    for (std::int64_t n = 0; n < length && count > 0; ++n) {
        while (at + 1 < count && scratch.border[at + 1] < static_cast<double>(n)) ++at;
        const auto step = static_cast<float>(n - scratch.place[at]);
        squares[n * stride] = step * step + scratch.height[scratch.place[at]];
    }
}

/// Squared distance in voxels to the nearest voxel of `mask` equal to `value`.
std::vector<float> squaredDistances(const Mask& mask, std::uint8_t value, const Index3& size) {
    std::vector<float> squares(mask.size());
    for (std::size_t n = 0; n < mask.size(); ++n) squares[n] = mask[n] == value ? 0 : kFar;
    const Index3 strides{1, size[0], size[0] * size[1]};
    for (int axis = 0; axis < 3; ++axis) {
        const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        parallelForPieces(size[v], 1, [&](std::int64_t begin, std::int64_t end) {
            Scratch scratch(size[axis]);
            for (std::int64_t at = begin; at < end; ++at) {
                for (std::int64_t n = 0; n < size[u]; ++n) {
                    lowerEnvelope(squares.data() + at * strides[v] + n * strides[u], size[axis],
                                  strides[axis], scratch);
                }
            }
        });
    }
    return squares;
}

}  // namespace

std::vector<float> depthMm(const Mask& mask, const ImageGeometry& grid) {
    std::vector<float> depth = squaredDistances(mask, 0, grid.size);
    const std::vector<float> outside = squaredDistances(mask, 1, grid.size);
    const auto step = static_cast<float>(stepMm(grid));
    parallelForPieces(std::ssize(depth), 1 << 18, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            depth[n] =
                step * (mask[n] != 0 ? std::sqrt(depth[n]) - 0.5f : 0.5f - std::sqrt(outside[n]));
        }
    });
    return depth;
}

}  // namespace adaptiso::headmodel
