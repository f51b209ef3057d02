#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace adaptiso::detail {

/// A corner of plane polygons with holes: its place and the corners before and after it on its
/// loop, the inside on the left.
struct PlanarCorner {
    std::int64_t u, v;
    std::uint32_t previous, next;
};

using LocalTriangle = std::array<std::uint32_t, 3>;

/// Cuts polygons with holes into triangles without adding a corner: a sweep into monotone parts,
/// each triangulated by a stack [deBerg2008, chapter 3]. Integer arithmetic, hence exact.
///
/// Loops may touch at corners (two corners in one place), but neither cross nor touch within an
/// edge. Every triangle is counter-clockwise and has positive area, also where corners lie on a
/// straight line. Work space is kept from call to call.
/// Cost: O(n log n) for n corners (O(n) more for each edge the sweep line meets at once).
class PlanarTriangulator {
public:
    /// Appends the triangles, by corner numbers, to `out`.
    /// \throws InternalError when the loops do not bound a plane region
    void triangulate(const std::vector<PlanarCorner>& corners, std::vector<LocalTriangle>& out);

private:
    using Index = std::uint32_t;
    enum class Kind : std::uint8_t { End, Merge, Regular, Split, Start };

    bool isBefore(Index a, Index b) const;
    std::int64_t cross(Index a, Index b, Index c) const;
    Kind kindOf(Index i) const;
    void sweep();
    void handle(Index i);
    bool edgeIsLeftOf(Index upper, Index point, Index above) const;
    std::size_t edgesLeftOf(Index point, Index above) const;
    std::size_t findEdge(Index upper);
    Index& helperLeftOf(Index i);
    void connectToMerge(Index i, Index helper);
    void walkParts(std::vector<LocalTriangle>& out);
    void mergeChains();
    void triangulateMonotone(std::vector<LocalTriangle>& out);
    void emit(Index a, Index b, Index c, std::vector<LocalTriangle>& out) const;

    /// An edge on the left border of the inside, cut by the sweep line: runs down from `upper` to
    /// the corner after it. `helper` is the last corner seen beside it.
    struct SweepEdge {
        Index upper, helper;
    };

    const std::vector<PlanarCorner>* corners_ = nullptr;
    std::vector<Index> order_;
    std::vector<Kind> kind_;
    std::vector<SweepEdge> status_;
    std::vector<std::array<Index, 2>> diagonals_;
    std::vector<Index> diagonalBegin_, diagonalEnd_;
    std::vector<std::uint8_t> used_;
    std::vector<Index> part_, merged_, stack_;
    std::vector<std::uint8_t> onLeft_;
};

}  // namespace adaptiso::detail
