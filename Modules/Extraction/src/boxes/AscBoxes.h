#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "boxes/SimpleBoxes.h"
#include "lattice/BlockSamples.h"

namespace adaptiso::detail {

/// A padi: a rectangle of a slab, the cells between two neighbouring farms at right angles to z,
/// in which no lign of either farm varies more than once. Its sides in x and y are dikes.
struct Padi {
    std::uint8_t x, y, sizeX, sizeY;

    friend bool operator==(const Padi&, const Padi&) = default;
};

/// A simple box that need not be a cube: its low cell in the block, its cells along each axis.
/// Dyadic in x and y, of any length in z.
struct AscBox {
    std::array<std::uint8_t, 3> low, size;

    friend bool operator==(const AscBox&, const AscBox&) = default;
};

/// Climbs from the edges of a block to its faces and boxes [Poston1998].
template <int N>
class SkeletonClimber {
public:
    /// \param cells  cells of the block that lie in the volume, along each axis: no dike reaches
    ///               over them
    SkeletonClimber(const BlockSamples<N>& samples, const std::array<int, 3>& cells)
        : variation_(samples), cells_(cells) {}

    /// Appends the padi of the slab between farms `slab` and slab + 1; they fill it once.
    ///
    /// From every simple dike of every strip a padi grows across the strips that follow while they
    /// have the same dike as their largest, as far as it is dyadic and its ligns along y stay
    /// simple. A cell has one largest dike in its strip, and over one dike dyadic lengths nest or
    /// lie apart: padi never overlap in part, and of those that nest the enclosing one stays.
    void findPadi(int slab, std::vector<Padi>& padi) const {
        for (int dike = 1; dike < 2 * N; ++dike) {
            if (startOf(dike) >= cells_[0]) continue;
            const std::uint32_t strips = stripsWithLargest(dike, slab);
            if (strips != 0) growAcross(strips, dike, 1, slab, padi);
        }
    }

    /// Appends the boxes of the block; they fill it once. From every padi a box grows through the
    /// slabs that follow while they have an equal padi there and no lign along z varies twice.
    void findBoxes(std::vector<AscBox>& boxes) const {
        constexpr std::size_t kNone = static_cast<std::size_t>(-1);
        std::array<std::size_t, std::size_t{N} * N> boxBelow;  // last one there, by its low x and y
        boxBelow.fill(kNone);
        std::vector<Padi> padi;
        for (int slab = 0; slab < cells_[2]; ++slab) {
            padi.clear();
            findPadi(slab, padi);
            for (const Padi& p : padi) {
                std::size_t& below = boxBelow[p.x + std::size_t{N} * p.y];
                if (below != kNone && canTake(boxes[below], p, slab)) {
                    ++boxes[below].size[2];
                } else {
                    below = boxes.size();
                    boxes.push_back(
                        {{p.x, p.y, static_cast<std::uint8_t>(slab)}, {p.sizeX, p.sizeY, 1}});
                }
            }
        }
    }

private:
    // a dike by its node in the variation trees
    static int levelOf(int dike) { return std::bit_width(static_cast<unsigned>(dike)) - 1; }
    static int sizeOf(int dike) { return N >> levelOf(dike); }
    static int startOf(int dike) { return (dike - (1 << levelOf(dike))) * sizeOf(dike); }
    static std::uint32_t cellsOf(int dike) { return ((1u << sizeOf(dike)) - 1) << startOf(dike); }
    static std::uint32_t lignsOf(int dike) { return ((2u << sizeOf(dike)) - 1) << startOf(dike); }

    /// Bit l: on lign l of one of the slab's farms the dike is not simple, or reaches over the
    /// volume's last sample.
    std::uint32_t varyingLigns(int axis, int dike, int slab) const {
        const int start = startOf(dike), end = start + sizeOf(dike);
        if (start < cells_[axis] && cells_[axis] < end) return ~std::uint32_t{0};
        return variation_.varying(axis, dike, slab) | variation_.varying(axis, dike, slab + 1);
    }

    /// Bit y: the dike along x is simple in strip y of the slab, on its ligns y and y + 1.
    std::uint32_t simpleStrips(int dike, int slab) const {
        const std::uint32_t ligns = varyingLigns(0, dike, slab);
        return ~(ligns | ligns >> 1) & ((1u << cells_[1]) - 1);
    }

    /// Bit y: it is, and no larger one that holds it.
    std::uint32_t stripsWithLargest(int dike, int slab) const {
        const std::uint32_t strips = simpleStrips(dike, slab);
        return dike == 1 ? strips : strips & ~simpleStrips(dike / 2, slab);
    }

    /// Padi over `dike`, as large as can be, in those of its strips that the dike `along` y covers.
    void growAcross(std::uint32_t strips, int dike, int along, int slab,
                    std::vector<Padi>& padi) const {
        const std::uint32_t wanted = cellsOf(along);
        if ((strips & wanted) == 0) return;
        const bool isSimple = (varyingLigns(1, along, slab) & lignsOf(dike)) == 0;
        if ((strips & wanted) == wanted && isSimple) {
            padi.push_back({static_cast<std::uint8_t>(startOf(dike)),
                            static_cast<std::uint8_t>(startOf(along)),
                            static_cast<std::uint8_t>(sizeOf(dike)),
                            static_cast<std::uint8_t>(sizeOf(along))});
            return;
        }
        growAcross(strips, dike, 2 * along, slab, padi);
        growAcross(strips, dike, 2 * along + 1, slab, padi);
    }

    /// May the box below the slab grow through the padi above its low cell?
    bool canTake(const AscBox& box, const Padi& padi, int slab) const {
        if (box.size[0] != padi.sizeX || box.size[1] != padi.sizeY ||
            box.low[2] + box.size[2] != slab) {
            return false;
        }
        const std::uint32_t ligns = ((2u << padi.sizeX) - 1) << padi.x;
        for (int y = padi.y; y <= padi.y + padi.sizeY; ++y) {
            std::uint32_t leaving = 0, entering = 0;
            for (int z = box.low[2]; z <= slab; ++z) {
                leaving |= variation_.leaving(2, N + z, y);
                entering |= variation_.entering(2, N + z, y);
            }
            if ((leaving & entering & ligns) != 0) return false;
        }
        return true;
    }

    VariationTrees<N> variation_;
    std::array<int, 3> cells_;
};

}  // namespace adaptiso::detail
