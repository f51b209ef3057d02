#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Extraction/detail/BoxCases.h"

namespace adaptiso::detail {

using LatticePosition = std::array<std::int64_t, 3>;

/// A cubic lattice along the axes. Its positions have few binary digits: coordinates of lattice
/// planes are exact.
class MendLattice {
public:
    /// \param shift  of the planes, 0 to 127, in parts of 128 of the spacing
    MendLattice(const BoundingBox& box, double spacingMm, const std::array<int, 3>& shift)
        : spacing_(spacingMm) {
        for (int a = 0; a < 3; ++a) {
            origin_[a] =
                (std::floor(box.minimum[a] / spacing_) - kMargin + shift[a] / 128.0) * spacing_;
        }
    }

    double spacing() const { return spacing_; }
    double coordinate(int axis, std::int64_t i) const {
        return origin_[axis] + static_cast<double>(i) * spacing_;
    }
    Vec3 at(const LatticePosition& p) const {
        return {coordinate(0, p[0]), coordinate(1, p[1]), coordinate(2, p[2])};
    }
    /// The cell that holds a coordinate; a plane belongs to the one above it.
    std::int64_t cellOf(int axis, double x) const {
        auto i = static_cast<std::int64_t>(std::floor((x - origin_[axis]) / spacing_));
        while (coordinate(axis, i) > x) --i;
        while (coordinate(axis, i + 1) <= x) ++i;
        return i;
    }
    LatticePosition cellOf(const Vec3& p) const {
        return {cellOf(0, p.x), cellOf(1, p.y), cellOf(2, p.z)};
    }
    BoundingBox boxOf(const LatticePosition& low, const LatticePosition& high) const {
        return {at(low), at({high[0] + 1, high[1] + 1, high[2] + 1})};
    }

private:
    static constexpr int kMargin = 8;  ///< cells around the box, for what closes holes

    double spacing_;
    Vec3 origin_;
};

/// Number of a lattice position, in the order of z, y, x.
constexpr int kLatticeBits = 20;
inline std::uint64_t keyOf(const LatticePosition& p) {
    return static_cast<std::uint64_t>(p[2]) << 2 * kLatticeBits |
           static_cast<std::uint64_t>(p[1]) << kLatticeBits | static_cast<std::uint64_t>(p[0]);
}
inline LatticePosition positionOf(std::uint64_t key) {
    constexpr std::uint64_t kMask = (1u << kLatticeBits) - 1;
    return {static_cast<std::int64_t>(key & kMask),
            static_cast<std::int64_t>(key >> kLatticeBits & kMask),
            static_cast<std::int64_t>(key >> 2 * kLatticeBits & kMask)};
}

/// Number of the lattice edge, or face, that begins at a position: along the axis, or at right
/// angles to it.
inline std::uint64_t keyOf(const LatticePosition& p, int axis) {
    return keyOf(p) << 2 | static_cast<std::uint64_t>(axis);
}
inline int axisOf(std::uint64_t key) {
    return static_cast<int>(key & 3);
}

inline LatticePosition moved(LatticePosition p, int axis, std::int64_t by) {
    p[axis] += by;
    return p;
}

/// The lattice position of a box's corner, the number of its edge or face (BoxCases.h).
inline LatticePosition cornerOfCell(const LatticePosition& cell, int corner) {
    return {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
}
inline std::uint64_t edgeOfCell(const LatticePosition& cell, int edge) {
    return keyOf(cornerOfCell(cell, lowCorner(edge)), edgeAxis(edge));
}
inline std::uint64_t faceOfCell(const LatticePosition& cell, int face) {
    return keyOf(moved(cell, face / 2, face & 1), face / 2);
}
inline LatticePosition neighbourOf(const LatticePosition& cell, int face) {
    return moved(cell, face / 2, face % 2 == 1 ? 1 : -1);
}

/// A triangle may have a point in a box: no separating axis lies between them, rounding against it.
bool mayTouch(const std::array<Vec3, 3>& triangle, const BoundingBox& box);

/// Calls visit(cell) for the cells from `low` to `high` whose boxes pass isWanted(box), by halves.
template <class IsWanted, class Visit>
void forEachCell(const MendLattice& lattice, const LatticePosition& low,
                 const LatticePosition& high, const IsWanted& isWanted, const Visit& visit) {
    if (!isWanted(lattice.boxOf(low, high))) return;
    int longest = 0;
    for (int a = 1; a < 3; ++a) {
        if (high[a] - low[a] > high[longest] - low[longest]) longest = a;
    }
    if (high[longest] == low[longest]) {
        visit(low);
        return;
    }
    const std::int64_t middle = (low[longest] + high[longest]) / 2;
    LatticePosition end = high, begin = low;
    end[longest] = middle;
    begin[longest] = middle + 1;
    forEachCell(lattice, low, end, isWanted, visit);
    forEachCell(lattice, begin, high, isWanted, visit);
}

}  // namespace adaptiso::detail
