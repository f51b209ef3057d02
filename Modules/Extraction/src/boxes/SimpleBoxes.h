#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "lattice/Bits.h"
#include "lattice/BlockSamples.h"

namespace adaptiso::detail {

/// The dikes of all ligns of a block, as variation trees (thesis 4.2): for each axis a tree over
/// the stretches of that axis, node 1 the whole lign, children 2i and 2i+1, unit dikes from N on.
/// A node's two variation bits (an inside -> outside change, an outside -> inside change) are kept
/// for all ligns of a farm at once, one machine word for a slice: bit l of word s is lign (l, s).
/// Ligns along x are numbered (y, z), along y (x, z), along z (x, y).
template <int N>
class VariationTrees {
public:
    explicit VariationTrees(const BlockSamples<N>& samples) {
        constexpr std::uint32_t kAll = (1u << kSide) - 1;
        for (int z = 0; z < kSide; ++z) {
            for (int y = 0; y < kSide; ++y) {
                const std::uint32_t row = samples.row(y, z);
                alongX(row & ~(row >> 1), ~row & (row >> 1), y, z);
                if (y < N) change(1, y, z, row, samples.row(y + 1, z) & kAll);
                if (z < N) change(2, z, y, row, samples.row(y, z + 1) & kAll);
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (int node = N - 1; node > 0; --node) {
                for (int slice = 0; slice < kSide; ++slice) {
                    leave_[axis][node][slice] =
                        leave_[axis][2 * node][slice] | leave_[axis][2 * node + 1][slice];
                    enter_[axis][node][slice] =
                        enter_[axis][2 * node][slice] | enter_[axis][2 * node + 1][slice];
                }
            }
        }
    }

    /// No dike of the box varies more than once (bits 11), on any lign through it.
    bool isSimple(const Box& box) const {
        return simpleAlong(0, box.x, box.y, box.z, box.size) &&
               simpleAlong(1, box.y, box.x, box.z, box.size) &&
               simpleAlong(2, box.z, box.x, box.y, box.size);
    }

    /// Bit l: lign (l, slice) varies more than once on the dike `node` of `axis`.
    std::uint32_t varying(int axis, int node, int slice) const {
        return leave_[axis][node][slice] & enter_[axis][node][slice];
    }
    /// Bit l: lign (l, slice) goes out (in) somewhere on the dike.
    std::uint32_t leaving(int axis, int node, int slice) const { return leave_[axis][node][slice]; }
    std::uint32_t entering(int axis, int node, int slice) const {
        return enter_[axis][node][slice];
    }

private:
    static constexpr int kSide = N + 1;

    void alongX(std::uint32_t leaves, std::uint32_t enters, int y, int z) {
        for (int x = 0; x < N; ++x) {
            leave_[0][N + x][z] |= (leaves >> x & 1u) << y;
            enter_[0][N + x][z] |= (enters >> x & 1u) << y;
        }
    }
    void change(int axis, int position, int slice, std::uint32_t here, std::uint32_t next) {
        leave_[axis][N + position][slice] = here & ~next;
        enter_[axis][N + position][slice] = ~here & next;
    }
    bool simpleAlong(int axis, int start, int firstLign, int firstSlice, int size) const {
        const int node = (N + start) / size;  // level log2(N / size), position start / size
        const std::uint32_t ligns = ((2u << size) - 1) << firstLign;
        std::uint32_t twice = 0;
        for (int slice = firstSlice; slice <= firstSlice + size; ++slice) {
            twice |= varying(axis, node, slice);
        }
        return (twice & ligns) == 0;
    }

    std::array<std::array<std::array<std::uint32_t, kSide>, std::size_t{2} * N>, 3> leave_{},
        enter_{};
};

/// The simple cubic boxes of a block (thesis 4.2): an octree, of which only the divisions are kept.
/// A node is a box of size N / 2^level at a position in units of its size. The same bits are the
/// division trees of thesis 4.3: a plot on a box's face is divided where the box behind it is.
template <int N>
class BoxTree {
public:
    static constexpr int kLevels =
        std::countr_zero(static_cast<unsigned>(N));  ///< below: unit boxes
    static constexpr int kNodes = ((1 << 3 * kLevels) - 1) / 7;

    static int level(int size) { return kLevels - std::countr_zero(static_cast<unsigned>(size)); }
    static int node(const Box& box) {
        const int l = level(box.size), shift = kLevels - l;
        const int offset = ((1 << 3 * l) - 1) / 7;
        return offset + (box.x >> shift) + ((box.y >> shift) << l) + ((box.z >> shift) << 2 * l);
    }

    static BoxTree ofUnitBoxes() {
        BoxTree tree;
        for (int node = 0; node < kNodes; ++node) tree.divided_.set(node);
        return tree;
    }

    bool isDivided(const Box& box) const { return box.size > 1 && divided_.test(node(box)); }
    void divide(const Box& box) { divided_.set(node(box)); }

    /// Calls f(box) for every undivided box.
    template <class F>
    void forEachLeaf(const F& f) const {
        descend({0, 0, 0, N}, f);
    }

private:
    template <class F>
    void descend(const Box& box, const F& f) const {
        if (!isDivided(box)) {
            f(box);
            return;
        }
        const int half = box.size / 2;
        for (int child = 0; child < 8; ++child) {
            descend({box.x + (child & 1) * half, box.y + (child >> 1 & 1) * half,
                     box.z + (child >> 2) * half, half},
                    f);
        }
    }

    Bits<kNodes> divided_;
};

/// Divides boxes until each is simple and, where the grid ends within a block (open border), none
/// that holds surface reaches over the last sample: `cells[axis]` cells of the block lie in the
/// volume.
template <int N>
BoxTree<N> makeSimpleBoxes(const BlockSamples<N>& samples, const std::array<int, 3>& cells) {
    const VariationTrees<N> variation(samples);
    BoxTree<N> tree;
    const auto divideUntilSimple = [&](const auto& self, const Box& box) -> void {
        if (box.size == 1) return;
        bool overBorder = false;
        for (int axis = 0; axis < 3; ++axis) {
            overBorder |= box.low(axis) < cells[axis] && cells[axis] < box.low(axis) + box.size;
        }
        if (variation.isSimple(box)) {
            const unsigned corners = samples.corners(box);
            if (!overBorder || corners == 0 || corners == 255) return;  // an empty box cuts nothing
        }
        tree.divide(box);
        const int half = box.size / 2;
        for (int child = 0; child < 8; ++child) {
            self(self, {box.x + (child & 1) * half, box.y + (child >> 1 & 1) * half,
                        box.z + (child >> 2) * half, half});
        }
    };
    divideUntilSimple(divideUntilSimple, {0, 0, 0, N});
    return tree;
}

}  // namespace adaptiso::detail
