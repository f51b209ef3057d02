#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "DualComplex.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::detail {
namespace {

using Polygon = DualComplex::Polygon;

/// Cut of a polygon.
enum class Cut : std::uint8_t { First, Second, Fan };  ///< diagonal 0-2, 1-3, none

/// The altitude on the longest side is so small a part of it that the triangle is as good as none.
bool isFlat(const Corners& t) {
    constexpr double kLeast = 1e-5;
    double longest = 0;
    for (int c = 0; c < 3; ++c) longest = std::max(longest, squaredNorm(t[c] - t[(c + 1) % 3]));
    return !(norm(areaVector2(t[0], t[1], t[2])) > kLeast * longest);
}

class PolygonCutter {
public:
    PolygonCutter(DualComplex&& complex, const LabelGrid& grid, std::vector<Vec3>&& points,
                  const ImageGeometry& geometry)
        : complex_(std::move(complex)),
          grid_(grid),
          lattice_(std::move(points)),
          geometry_(geometry),
          cuts_(complex_.polygons.size(), Cut::First) {
        // room for the points of fans, so that nothing is copied later but in rare cases
        constexpr std::size_t kFewMore = 50;
        const auto fans = std::count_if(complex_.polygons.begin(), complex_.polygons.end(),
                                        [](const Polygon& p) { return !p.isWhole; });
        pointsMm_.reserve(lattice_.size() + static_cast<std::size_t>(fans) +
                          lattice_.size() / kFewMore);
        pointsMm_.resize(lattice_.size());
        parallelForPieces(count(lattice_), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) pointsMm_[v] = toMm(lattice_[v]);
        });
    }

    void chooseCuts() {
        parallelForPieces(count(cuts_), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t p = begin; p < end; ++p) cuts_[p] = firstCut(complex_.polygons[p]);
        });
    }

    /// Turns the cuts of polygons that cross others, until none do.
    std::int64_t mend() {
        findUses();
        std::vector<std::uint8_t> turns(cuts_.size(), 0);
        std::vector<std::uint8_t> isChanged(complex_.groupCount, 1);
        std::int64_t mended = 0;
        for (bool isDone = false; !isDone;) {
            std::vector<std::uint8_t> crosses(cuts_.size(), 0);
            findCrossings(isChanged, crosses);
            std::fill(isChanged.begin(), isChanged.end(), 0);
            isDone = true;
            for (std::size_t p = 0; p < cuts_.size(); ++p) {
                if (crosses[p] == 0 || cuts_[p] == Cut::Fan) continue;
                cuts_[p] = otherCut(complex_.polygons[p], cuts_[p], turns[p]);
                mended += turns[p] == 0 ? 1 : 0;
                turns[p] = 1;
                isDone = false;
                for (const VertexId v : complex_.cornersOf(complex_.polygons[p])) isChanged[v] = 1;
            }
        }
        freeMemory(useBegin_);
        freeMemory(uses_);
        return mended;
    }

    LabelComplex takeComplex() {
        LabelComplex walls;
        walls.points = std::move(pointsMm_);
        VertexId nextCentre = count(walls.points);
        std::size_t triangles = 0;
        for (std::size_t p = 0; p < cuts_.size(); ++p) {
            const bool isFan = cuts_[p] == Cut::Fan;
            triangles += complex_.polygons[p].count - (isFan ? 0 : 2);
            if (isFan) walls.points.push_back(toMm(centreOf(complex_.polygons[p])));
        }
        freeMemory(lattice_);
        walls.triangles.reserve(triangles);
        walls.labels.reserve(triangles);
        for (std::size_t p = 0; p < cuts_.size(); ++p) {
            const Polygon& polygon = complex_.polygons[p];
            const VertexId centre = cuts_[p] == Cut::Fan ? nextCentre++ : -1;
            const auto [from, into] = polygon.labels;
            // 0 comes last: it is larger than any other as an unsigned number less one
            const auto rank = [](Label l) { return static_cast<std::uint32_t>(l) - 1U; };
            const bool isTurned = (rank(from) > rank(into)) != geometry_.isMirrored();
            const std::array<Label, 2> labels =
                rank(from) > rank(into) ? std::array{into, from} : std::array{from, into};
            forEachTriangle(polygon, cuts_[p], [&](VertexId a, VertexId b, VertexId c) {
                Triangle t{a < 0 ? centre : a, b, c};
                if (isTurned) std::swap(t[1], t[2]);
                walls.triangles.push_back(t);
                walls.labels.push_back(labels);
            });
        }
        return walls;
    }

private:
    static constexpr std::int64_t kPiece = 4096;

    template <class T>
    static std::int64_t count(const std::vector<T>& of) {
        return static_cast<std::int64_t>(of.size());
    }

    /// Lattice point 1 is voxel 0.
    Vec3 toMm(const Vec3& p) const { return geometry_.toPhysical(p - Vec3{1, 1, 1}); }

    /// The point of a fan: on the lattice edge, level with the middle of the corners.
    Vec3 centreOf(const Polygon& polygon) const {
        constexpr double kGap = 1.0 / 16;
        const Index3 index = grid_.indexOf(polygon.place);
        const Vec3 begin{static_cast<double>(index[0]), static_cast<double>(index[1]),
                         static_cast<double>(index[2])};
        const Vec3 along{static_cast<double>(polygon.kind & 1),
                         static_cast<double>(polygon.kind >> 1 & 1),
                         static_cast<double>(polygon.kind >> 2)};
        double sum = 0;
        for (const VertexId v : complex_.cornersOf(polygon)) sum += dot(lattice_[v] - begin, along);
        const double part = sum / polygon.count / squaredNorm(along);
        return begin + std::clamp(part, kGap, 1 - kGap) * along;
    }

    /// Calls f(a, b, c) for the triangles; a is -1 for the point of a fan.
    template <class F>
    void forEachTriangle(const Polygon& polygon, Cut cut, const F& f) const {
        const auto corners = complex_.cornersOf(polygon);
        if (cut == Cut::Fan) {
            for (std::size_t n = 0; n < corners.size(); ++n) {
                f(-1, corners[n], corners[(n + 1) % corners.size()]);
            }
            return;
        }
        const std::size_t o = cut == Cut::First ? 0 : 1;
        f(corners[o], corners[o + 1], corners[o + 2]);
        f(corners[o], corners[o + 2], corners[(o + 3) % 4]);
    }

    bool isSound(const Polygon& polygon, Cut cut) const {
        bool isSound = true;
        forEachTriangle(polygon, cut, [&](VertexId a, VertexId b, VertexId c) {
            isSound = isSound && !isFlat({pointsMm_[a], pointsMm_[b], pointsMm_[c]});
        });
        return isSound;
    }

    Cut firstCut(const Polygon& polygon) const {
        if (!polygon.isWhole) return Cut::Fan;
        const auto corners = complex_.cornersOf(polygon);
        const auto length = [&](int a, int b) {
            return squaredNorm(pointsMm_[corners[a]] - pointsMm_[corners[b]]);
        };
        const Cut shorter = length(1, 3) < length(0, 2) ? Cut::Second : Cut::First;
        return isSound(polygon, shorter) ? shorter : otherCut(polygon, shorter, 0);
    }

    Cut otherCut(const Polygon& polygon, Cut cut, int turns) const {
        const Cut other = cut == Cut::First ? Cut::Second : Cut::First;
        return turns == 0 && isSound(polygon, other) ? other : Cut::Fan;
    }

    /// Polygons of each vertex of a whole cell.
    void findUses() {
        useBegin_.assign(complex_.groupCount + 1, 0);
        const auto forEach = [&](const auto& f) {
            for (std::size_t p = 0; p < complex_.polygons.size(); ++p) {
                for (const VertexId v : complex_.cornersOf(complex_.polygons[p])) {
                    if (v < complex_.groupCount) f(v, static_cast<std::uint32_t>(p));
                }
            }
        };
        forEach([&](VertexId v, std::uint32_t) { ++useBegin_[v + 1]; });
        for (std::size_t v = 1; v < useBegin_.size(); ++v) useBegin_[v] += useBegin_[v - 1];
        uses_.resize(useBegin_.back());
        std::vector<std::uint32_t> at(useBegin_.begin(), useBegin_.end() - 1);
        forEach([&](VertexId v, std::uint32_t p) { uses_[at[v]++] = p; });
    }

    struct Use {
        std::int64_t polygon;
        std::array<VertexId, 3> vertices;
        Corners corners;
    };

    void collect(VertexId v, std::vector<Use>& uses) const {
        uses.clear();
        for (std::uint32_t n = useBegin_[v]; n < useBegin_[v + 1]; ++n) {
            const std::int64_t p = uses_[n];
            const Polygon& polygon = complex_.polygons[p];
            const bool isFan = cuts_[p] == Cut::Fan;
            const Vec3 centre = isFan ? toMm(centreOf(polygon)) : Vec3{};
            forEachTriangle(polygon, cuts_[p], [&](VertexId a, VertexId b, VertexId c) {
                if (!isFan && a != v && b != v && c != v && passesBy(v, polygon, cuts_[p])) return;
                uses.push_back(
                    {p, {a, b, c}, {isFan ? centre : pointsMm_[a], pointsMm_[b], pointsMm_[c]}});
            });
        }
    }

    /// The diagonal of a polygon of four corners passes on the other side of its lattice edge, so
    /// that the triangle without this corner stays out of the corner's cell.
    bool passesBy(VertexId v, const Polygon& polygon, Cut cut) const {
        constexpr double kClear = 1e-6;
        const Index3 begin = grid_.indexOf(polygon.place);
        const int axis = polygon.kind == 1 ? 0 : polygon.kind == 2 ? 1 : 2;
        const int u = (axis + 1) % 3, w = (axis + 2) % 3;
        const auto fromEdge = [&](VertexId of) {
            const Vec3& p = lattice_[of];
            return std::array{p[u] - static_cast<double>(begin[u]),
                              p[w] - static_cast<double>(begin[w])};
        };
        const auto corners = complex_.cornersOf(polygon);
        const int o = cut == Cut::First ? 0 : 1;
        const auto at = fromEdge(v), a = fromEdge(corners[o]), b = fromEdge(corners[o + 2]);
        // a and b lie in the quadrants beside that of v: with its signs turned, one of each
        const double turned = at[0] * at[1] > 0 ? 1 : -1;
        const double side = (a[0] * b[1] - a[1] * b[0]) * turned;
        return (a[0] * at[0] < 0 ? side : -side) > kClear;
    }

    /// Triangles that cross lie in polygons with a vertex of a cell in common: what crosses in a
    /// cell is not a fan, so the cell is whole, and all that enters it has its vertex.
    void findCrossings(const std::vector<std::uint8_t>& isChanged,
                       std::vector<std::uint8_t>& crosses) const {
        std::vector<std::vector<std::int64_t>> found((complex_.groupCount + kPiece - 1) / kPiece);
        parallelForPieces(complex_.groupCount, kPiece, [&](std::int64_t begin, std::int64_t end) {
            std::vector<Use> uses;
            for (std::int64_t v = begin; v < end; ++v) {
                if (isChanged[v] == 0) continue;
                collect(v, uses);
                if (isClear(v, uses)) continue;
                for (std::size_t a = 0; a < uses.size(); ++a) {
                    for (std::size_t b = 0; b < a; ++b) {
                        if (mayCross(uses[a], uses[b]) &&
                            trianglesCross(uses[a].corners, uses[b].corners)) {
                            found[begin / kPiece].push_back(uses[a].polygon);
                            found[begin / kPiece].push_back(uses[b].polygon);
                        }
                    }
                }
            }
        });
        for (const auto& own : found) {
            for (const std::int64_t p : own) crosses[p] = 1;
        }
    }

    bool mayCross(const Use& a, const Use& b) const {
        if (cuts_[a.polygon] == Cut::Fan && cuts_[b.polygon] == Cut::Fan) return false;
        for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
            const auto [lowA, highA] =
                std::minmax({a.corners[0].*axis, a.corners[1].*axis, a.corners[2].*axis});
            const auto [lowB, highB] =
                std::minmax({b.corners[0].*axis, b.corners[1].*axis, b.corners[2].*axis});
            if (highA < lowB || highB < lowA) return false;
        }
        return true;
    }

    /// The triangles are one sheet that goes round the vertex once, seen along one direction, so
    /// none crosses another.
    bool isClear(VertexId v, std::vector<Use>& uses) const {
        constexpr double kLeastCosine = 0.02;
        struct Sector {
            VertexId from, into;
            Vec3 a, b;
        };
        constexpr std::size_t kMost = 24;
        std::array<Sector, kMost> sectors;
        std::size_t count = 0;
        for (const Use& use : uses) {
            const auto at = std::find(use.vertices.begin(), use.vertices.end(), v);
            if (at == use.vertices.end() || use.vertices[0] < 0 || count == kMost) return false;
            const auto c = static_cast<std::size_t>(at - use.vertices.begin());
            const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
            sectors[count] = {use.vertices[d], use.vertices[e], use.corners[d] - use.corners[c],
                              use.corners[e] - use.corners[c]};
            // polygons between the same two labels, the one turned round where the other is not
            if (complex_.polygons[use.polygon].labels[0] >
                complex_.polygons[use.polygon].labels[1]) {
                std::swap(sectors[count].from, sectors[count].into);
                std::swap(sectors[count].a, sectors[count].b);
            }
            ++count;
        }
        Vec3 axis;
        for (std::size_t n = 0; n < count; ++n) {
            if (n > 0) {
                const auto next =
                    std::find_if(sectors.begin() + n, sectors.begin() + count,
                                 [&](const Sector& s) { return s.from == sectors[n - 1].into; });
                if (next == sectors.begin() + count) return false;
                std::swap(sectors[n], *next);
            }
            axis += cross(sectors[n].a, sectors[n].b);
        }
        if (count < 3 || sectors[count - 1].into != sectors[0].from) return false;
        const Vec3 across =
            std::abs(axis.x) < std::abs(axis.y) ? cross(axis, {1, 0, 0}) : cross(axis, {0, 1, 0});
        int rounds = 0;  // how often sectors pass the direction from which `across` grows
        for (std::size_t n = 0; n < count; ++n) {
            const Vec3 area2 = cross(sectors[n].a, sectors[n].b);
            const double upright = dot(area2, axis);
            if (!(upright > 0 && upright * upright > kLeastCosine * kLeastCosine *
                                                         squaredNorm(axis) * squaredNorm(area2))) {
                return false;
            }
            rounds += dot(sectors[n].a, across) < 0 && dot(sectors[n].b, across) >= 0 ? 1 : 0;
        }
        return rounds == 1;
    }

    DualComplex complex_;
    const LabelGrid& grid_;
    std::vector<Vec3> lattice_;
    const ImageGeometry& geometry_;
    std::vector<Vec3> pointsMm_;
    std::vector<Cut> cuts_;
    std::vector<std::uint32_t> useBegin_, uses_;
};

}  // namespace

Walls cutPolygons(DualComplex&& complex, const LabelGrid& grid, std::vector<Vec3>&& points,
                  const ImageGeometry& geometry) {
    PolygonCutter cutter(std::move(complex), grid, std::move(points), geometry);
    cutter.chooseCuts();
    Walls walls;
    walls.mendedCrossings = cutter.mend();
    walls.complex = cutter.takeComplex();
    return walls;
}

}  // namespace adaptiso::detail
