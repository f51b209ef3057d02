#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// A triangle cut at points and along segments that lie in it: their constrained Delaunay
/// triangulation [Chew1989], seen along the axis that its plane is steepest to. Decided by
/// orient2d().
///
/// What segments enclose is cut alike in all triangles of a plane: of four points on a circle the
/// one of the smallest number is joined to the one across.
class CutTriangle {
public:
    using Id = std::uint32_t;
    using Line = std::uint64_t;  ///< what a segment is a part of
    /// The point where two lines cross in the triangle.
    using CrossingOf = std::function<std::optional<Id>(Line, Line)>;

    /// Keeps a reference to `points`, which may grow.
    /// \param nearMm  points as near to a segment are on it
    CutTriangle(const std::vector<Vec3>& points, const std::array<Id, 3>& corners, double nearMm);

    // each returns false where rounded points are not where they were found to be: the triangle is
    // then of no use
    bool addOnBorder(Id p, Id from, Id to);  ///< between two neighbours on the border
    bool add(Id p);                          ///< anywhere; no-op where it is one already
    bool addSegment(Id from, Id to, Line line, const CrossingOf& crossingOf);

    /// Improves the triangles. \return all of them, ascending, as the triangle faces
    std::vector<std::array<Id, 3>> finish();

private:
    struct Segment {
        Id from, to;
        Line line;
    };
    static constexpr Id kNone = ~Id{0};

    static std::uint64_t key(Id a, Id b) { return std::uint64_t{a} << 32 | b; }
    static std::uint64_t sideKey(Id a, Id b) { return a < b ? key(a, b) : key(b, a); }
    Point2 flat(Id p) const { return {points_[p][u_], points_[p][v_]}; }
    int side(Id a, Id b, Id c) const { return orient2d(flat(a), flat(b), flat(c)); }
    bool isAhead(Id from, Id to, Id p) const;
    int sideOfSegment(Id from, Id to, Id p) const;
    /// The third corner of the triangle on the left of a -> b.
    Id across(Id a, Id b) const;
    bool hasEdge(Id a, Id b) const { return across(a, b) != kNone || across(b, a) != kNone; }
    bool has(Id p) const { return spoke_.contains(p); }
    void put(Id a, Id b, Id c);
    void take(Id a, Id b, Id c);
    bool isConvex(Id u, Id v, Id w, Id x) const { return side(x, v, w) > 0 && side(w, u, x) > 0; }
    void flip(Id u, Id v, Id w, Id x);
    bool splitEdge(Id p, Id a, Id b);
    bool isBetterFlipped(Id u, Id v, Id w, Id x) const;
    void improve(std::vector<std::array<Id, 2>> edges);
    bool pass(const Segment& segment, std::vector<Segment>& stack, const CrossingOf& crossingOf);
    bool meet(const Segment& segment, Id a, Id b, std::vector<Segment>& stack,
              const CrossingOf& crossingOf);
    bool force(const Segment& segment, std::vector<std::array<Id, 2>> crossed);

    const std::vector<Vec3>& points_;
    double nearMm_;
    int u_ = 0, v_ = 1;
    std::unordered_map<std::uint64_t, Id> across_;   ///< by an edge with its triangle on the left
    std::unordered_map<std::uint64_t, Line> lines_;  ///< by an edge, ends ascending
    std::unordered_map<Id, Id> spoke_;               ///< a point, and one that an edge leads to
    std::array<Id, 2> last_{};                       ///< an edge near the last point
};

}  // namespace adaptiso::detail
