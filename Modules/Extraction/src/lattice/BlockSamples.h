#pragma once

#include <array>
#include <cstdint>

#include "lattice/LatticeSampler.h"

namespace adaptiso::detail {

/// A box of a block: its low corner in cells of the block and its size, a power of two.
struct Box {
    int x, y, z, size;

    int low(int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

/// Which of a block's (N+1)^3 samples are inside.
template <int N>
class BlockSamples {
public:
    static constexpr int kSide = N + 1;

    BlockSamples(const LatticeSampler& sampler, const Index3& firstSample)
        : sampler_(sampler), first_(firstSample) {
        sampler.insideRows(firstSample, kSide, rows_.data());
    }

    std::uint32_t row(int y, int z) const { return rows_[z * kSide + y]; }
    bool inside(int x, int y, int z) const { return row(y, z) >> x & 1u; }
    bool inside(const std::array<int, 3>& p) const { return inside(p[0], p[1], p[2]); }

    /// Bit c: corner c of the box is inside.
    unsigned corners(const Box& box) const {
        const int s = box.size;
        return pair(box.x, s, box.y, box.z) | pair(box.x, s, box.y + s, box.z) << 2 |
               pair(box.x, s, box.y, box.z + s) << 4 | pair(box.x, s, box.y + s, box.z + s) << 6;
    }

    /// Position along `axis` of the finest lattice edge that the surface crosses on the stretch of
    /// `length` cells from `p`. \pre the ends differ and the stretch is simple
    int crossingOn(std::array<int, 3> p, int axis, int length) const {
        const bool start = inside(p);
        for (int step = 1; step < length; ++step) {
            ++p[axis];
            if (inside(p) != start) return p[axis] - 1;
        }
        return p[axis];
    }

    /// Does the inside join across an ambiguous rectangle at `corner`, at right angles to `normal`,
    /// of sizeU x sizeV cells along the two axes that follow? A unit square is decided by its
    /// values; a larger rectangle by following the iso-line of its own unit squares from the bottom
    /// side: both boxes at it see the same samples.
    bool insideJoins(const std::array<int, 3>& corner, int normal, int sizeU, int sizeV) const;
    bool insideJoins(const std::array<int, 3>& corner, int normal, int size) const {
        return insideJoins(corner, normal, size, size);
    }

    /// The block's first sample in the volume.
    const Index3& firstSample() const { return first_; }
    Index3 sampleAt(const std::array<int, 3>& p) const {
        return {first_[0] + p[0], first_[1] + p[1], first_[2] + p[2]};
    }

private:
    unsigned pair(int x, int s, int y, int z) const {
        const std::uint32_t r = row(y, z);
        return (r >> x & 1u) | (r >> (x + s) & 1u) << 1;
    }

    const LatticeSampler& sampler_;
    Index3 first_;
    std::array<std::uint32_t, std::size_t{kSide} * kSide> rows_;
};

}  // namespace adaptiso::detail
