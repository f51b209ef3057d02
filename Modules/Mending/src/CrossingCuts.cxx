#include "CrossingCuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "Arrangement.h"
#include "MendDistances.h"
#include "NearnessProof.h"
#include "WindingField.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/Extraction/detail/FlatTriangles.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"

namespace adaptiso::detail {
namespace {

using Id = CutTriangle::Id;
using Numbers = std::array<Id, 3>;

constexpr double kPartRounded = 1e-3;  ///< of the bound: points may be rounded by as much
constexpr double kPartMoved = 0.01;    ///< of the bound, by which fans are parted

/// Numbers points by their place.
class PointPlaces {
public:
    /// \return  the first point that was given for the place
    Id add(const Vec3& p, Id number) {
        return first_.try_emplace({p.x, p.y, p.z}, number).first->second;
    }

private:
    std::map<std::array<double, 3>, Id> first_;
};

/// Triangles on the same corners.
struct Face {
    Numbers corners;       ///< in the order of the first triangle that faces as most do
    std::uint32_t number;  ///< of that triangle
    int count = 0;         ///< of triangles that face as it does, less the others; >= 0
};

std::vector<Face> facesOf(const std::vector<Numbers>& triangles) {
    struct Placed {
        Numbers sorted;
        std::uint32_t number;
        bool isEven;
        bool operator<(const Placed& o) const {
            return std::tie(sorted, number) < std::tie(o.sorted, o.number);
        }
    };
    std::vector<Placed> all;
    all.reserve(triangles.size());
    for (std::uint32_t n = 0; n < triangles.size(); ++n) {
        Numbers c = triangles[n];
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        const bool isEven = c[1] < c[2];
        if (!isEven) std::swap(c[1], c[2]);
        all.push_back({c, n, isEven});
    }
    std::sort(all.begin(), all.end());
    std::vector<Face> faces;
    for (std::size_t begin = 0, end; begin < all.size(); begin = end) {
        int even = 0;
        for (end = begin; end < all.size() && all[end].sorted == all[begin].sorted; ++end) {
            even += all[end].isEven ? 1 : -1;
        }
        std::size_t first = begin;
        while (even != 0 && all[first].isEven != (even > 0)) ++first;
        faces.push_back({triangles[all[first].number], all[first].number, std::abs(even)});
    }
    std::sort(faces.begin(), faces.end(),
              [](const Face& a, const Face& b) { return a.number < b.number; });
    return faces;
}

/// Joins faces across edges that two of them have. \return none where the faces are open
std::optional<DisjointSets> patchesOf(const std::vector<Face>& faces) {
    struct Side {
        Id a, b;
        std::uint32_t face;
        bool isUp;
        bool operator<(const Side& o) const {
            return std::tie(a, b, face) < std::tie(o.a, o.b, o.face);
        }
    };
    std::vector<Side> sides;
    sides.reserve(3 * faces.size());
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Id a = faces[f].corners[i], b = faces[f].corners[(i + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), f, a < b});
        }
    }
    std::sort(sides.begin(), sides.end());
    DisjointSets patches(std::ssize(faces));
    for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
        int sum = 0;
        for (end = begin;
             end < sides.size() && sides[end].a == sides[begin].a && sides[end].b == sides[begin].b;
             ++end) {
            sum += (sides[end].isUp ? 1 : -1) * faces[sides[end].face].count;
        }
        if (sum != 0) return std::nullopt;
        if (end - begin == 2 && sides[begin].isUp != sides[begin + 1].isUp) {
            patches.join(sides[begin].face, sides[begin + 1].face);
        }
    }
    return patches;
}

/// Where the solid is.
enum class Kind : std::uint8_t {
    Border,  ///< behind, not in front
    Inner,   ///< on both sides
    Outer,   ///< on neither: the surface is inside out, or lies on itself
    Unclear  ///< rounding leaves winding numbers open
};

/// The kind of each face. None where one is unclear, or there are too many.
/// \param before  the triangles before they were cut
std::optional<std::vector<Kind>> kindsOf(const TriangleMesh& before, const Arrangement& arrangement,
                                         const std::vector<Face>& faces,
                                         const std::vector<Vec3>& points, DisjointSets& patches,
                                         double sizeMm, double nearMm) {
    const auto cornersAt = [&](const Face& face) {
        return Corners{points[face.corners[0]], points[face.corners[1]], points[face.corners[2]]};
    };
    const auto areaOf = [&](const Face& face) {
        const Corners c = cornersAt(face);
        return norm(areaVector2(c[0], c[1], c[2]));
    };
    std::map<std::int64_t, std::pair<double, std::size_t>> largest;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const double own = areaOf(faces[f]);
        const auto patch = patches.find(static_cast<std::int64_t>(f));
        auto& [area, face] = largest.try_emplace(patch, own, f).first->second;
        if (own > area) std::tie(area, face) = std::pair(own, f);
    }
    std::vector<std::size_t> ofPatch;  // its largest face
    std::map<std::int64_t, std::size_t> numberOf;
    for (const auto& [patch, of] : largest) {
        numberOf.emplace(patch, ofPatch.size());
        ofPatch.push_back(of.second);
    }
    std::vector<Kind> kinds(ofPatch.size(), Kind::Unclear);
    /// Judges the patches that are still unclear by the winding numbers of `mesh`, `depthMm` in
    /// front of a face and behind it.
    const auto judge = [&](const TriangleMesh& mesh, double depthMm) {
        constexpr double kMostTriangles = 4e9;  // that are looked at
        const auto unclear = std::count(kinds.begin(), kinds.end(), Kind::Unclear);
        const auto most = static_cast<double>(std::min<std::size_t>(mesh.triangles.size(), 30'000));
        if (unclear == 0 || static_cast<double>(unclear) * most > kMostTriangles) return;
        const AabbTree tree(mesh);
        const WindingField field(mesh, tree);
        parallelForPieces(std::ssize(ofPatch), 16, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) {
                if (kinds[n] != Kind::Unclear) continue;
                const Face& face = faces[ofPatch[n]];
                const Corners c = cornersAt(face);
                const double around = norm(c[1] - c[0]) + norm(c[2] - c[1]) + norm(c[0] - c[2]);
                const double depth = std::min(depthMm, 0.1 * areaOf(face) / around);
                const Vec3 middle = 1.0 / 3 * (c[0] + c[1] + c[2]);
                const Vec3 step = depth * normalized(areaVector2(c[0], c[1], c[2]));
                for (const double far : {2.5, 8.0}) {
                    const double front = field.at(middle + step, -1, far),
                                 behind = field.at(middle - step, -1, far);
                    const double inFront = std::round(front), inBack = std::round(behind);
                    constexpr double kClear = 0.1;
                    if (std::abs(front - inFront) > kClear || std::abs(behind - inBack) > kClear ||
                        inBack - inFront != face.count) {
                        continue;
                    }
                    kinds[n] = inFront >= 1  ? Kind::Inner
                               : inBack >= 1 ? Kind::Border
                                             : Kind::Outer;
                    break;
                }
            }
        });
    };
    const double depthMm = 1e-9 * sizeMm;
    judge(before, depthMm + 8 * nearMm);  // fewer triangles, but such as lie near each other
    if (std::find(kinds.begin(), kinds.end(), Kind::Unclear) != kinds.end()) {
        TriangleMesh all{points, {}, {}};
        all.triangles.reserve(arrangement.triangles.size());
        for (const auto& [a, b, c] : arrangement.triangles) all.triangles.push_back({a, b, c});
        judge(all, depthMm);
    }
    if (std::find(kinds.begin(), kinds.end(), Kind::Unclear) != kinds.end()) return std::nullopt;
    std::vector<Kind> ofFace(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        ofFace[f] = kinds[numberOf.at(patches.find(static_cast<std::int64_t>(f)))];
    }
    return ofFace;
}

/// Cuts the triangles of a closed mesh where they meet, round by round.
class CrossingCutter {
public:
    CrossingCutter(const MendInput& input, double sizeMm, double boundMm, double nearMm,
                   bool isSingle)
        : input_(input),
          boundMm_(boundMm),
          nearMm_(nearMm),
          isSingle_(isSingle),
          sizeMm_(sizeMm),
          sheets_(labelComponents(input.mesh)),
          firstNew_(input.mesh.points.size()),
          isChanged_(input.mesh.triangles.size()),
          isKept_(input.mesh.triangles.size()),
          origin_(input.mesh.triangles.size()) {
        cut_.mesh = input.mesh;
        cut_.edgeOf = input.edgeOf;
        cut_.edges = input.edges;
        cut_.crossingPairs = input.crossingPairs;
        std::iota(origin_.begin(), origin_.end(), std::int64_t{0});
    }

    /// \return  it could be cut; where rounding leaves crossings, crossingPairs() counts them
    bool cut() {
        constexpr int kMostRounds = 6;
        for (int round = 0; round < kMostRounds; ++round) {
            if (!keepBorder(round == 0)) return round > 0;
            roundPoints(firstNew_);
            if (cut_.mesh.triangles.empty()) return false;
            splitFlat();
            findEdges(cut_);
            partFans();
            const auto triangles = inShort(cut_.mesh);
            CrossingPairs crossing = findCrossingPairs({cut_.mesh.points, triangles});
            if (!crossing.undecided.empty()) return false;
            cut_.crossingPairs = std::move(crossing.pairs);
            if (cut_.crossingPairs.empty()) break;
        }
        return true;
    }

    std::size_t crossingPairs() const { return cut_.crossingPairs.size(); }

    /// \return  none where what was cut can't be proved to lie near the input
    std::optional<MendInput> finish(MendStatistics& statistics) && {
        for (std::size_t t = 0; t < isKept_.size(); ++t) {
            if (isKept_[t] == 0 || isChanged_[t] == 0) continue;
            kept_.push_back(cornersOf(input_.mesh, static_cast<std::int64_t>(t)));
        }
        bringOver();
        const auto movedMm = prove();
        if (!movedMm) return std::nullopt;
        statistics.movedMm += *movedMm;
        cut_.inner = placesOf(inner_);
        cut_.outer = placesOf(outer_);
        return std::move(cut_);
    }

private:
    struct Dropped {
        Corners corners;
        std::int64_t sheet;
    };

    std::int64_t sheetOf(std::int64_t origin) const {
        return sheets_.ofVertex[input_.mesh.triangles[origin][0]];
    }
    bool isGiven(std::int64_t origin) const { return origin < input_.firstCap(); }

    /// Cuts the triangles, and keeps those that have the solid on one side.
    bool keepBorder(bool isFirst) {
        const TriangleMesh before = cut_.mesh;
        const auto arrangement = arrange(cut_, cut_.crossingPairs, nearMm_);
        if (!arrangement) return false;
        movedMm_ += arrangement->movedMm;
        const std::vector<Face> faces = facesOf(arrangement->triangles);
        auto patches = patchesOf(faces);
        if (!patches) return false;
        const auto& points = cut_.mesh.points;
        const auto kinds = kindsOf(before, *arrangement, faces, points, *patches, sizeMm_, nearMm_);
        if (!kinds) return false;
        std::vector<Triangle> triangles;
        std::vector<std::int64_t> origins;
        std::vector<std::uint8_t> isSeen(before.triangles.size());
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto& [a, b, c] = faces[f].corners;
            const std::uint32_t whole = arrangement->origin[faces[f].number];
            const std::int64_t origin = origin_[whole];
            const Kind kind = (*kinds)[f];
            const bool isPart = arrangement->isCut[whole] != 0;
            isSeen[whole] = 1;
            if (isPart || kind != Kind::Border) isChanged_[origin] = 1;
            if (isFirst && isGiven(origin)) {
                const Corners corners{points[a], points[b], points[c]};
                const std::int64_t sheet = sheetOf(origin);
                if (kind == Kind::Inner) inner_.push_back({corners, sheet});
                if (kind == Kind::Outer) outer_.push_back({corners, sheet});
                if (kind == Kind::Border && isPart) kept_.push_back(corners);
                if (kind == Kind::Border && !isPart) isKept_[origin] = 1;
            }
            if (kind != Kind::Border) continue;
            triangles.push_back({a, b, c});
            origins.push_back(origin);
        }
        for (std::size_t t = 0; t < isSeen.size() && isFirst; ++t) {  // flat, or twice there
            if (isSeen[t] != 0 || !isGiven(static_cast<std::int64_t>(t))) continue;
            isChanged_[t] = 1;
            kept_.push_back(cornersOf(before, static_cast<std::int64_t>(t)));
        }
        cut_.mesh.triangles = std::move(triangles);
        origin_ = std::move(origins);
        return true;
    }

    /// Rounds points from `first` on to single precision, where asked, so that most files hold
    /// them; those at one place become one.
    void roundPoints(std::size_t first) {
        TriangleMesh& mesh = cut_.mesh;
        std::vector<std::uint8_t> isBeside(mesh.points.size());  // in a triangle with a new point
        for (const Triangle& t : mesh.triangles) {
            const bool hasNew = std::any_of(
                t.begin(), t.end(), [&](VertexId v) { return v >= static_cast<VertexId>(first); });
            if (!hasNew) continue;
            for (const VertexId v : t) isBeside[v] = 1;
        }
        PointPlaces places;
        std::vector<VertexId> becomes(mesh.points.size());
        for (std::size_t v = 0; v < becomes.size(); ++v) {
            becomes[v] = static_cast<VertexId>(v);
            if (isBeside[v] == 0) continue;
            Vec3& p = mesh.points[v];
            for (int axis = 0; axis < 3 && v >= first && isSingle_; ++axis) {
                const double rounded = static_cast<float>(p[axis]);
                if (std::abs(rounded - p[axis]) <= kPartRounded * boundMm_) p[axis] = rounded;
            }
            becomes[v] = places.add(p, static_cast<Id>(v));
        }
        std::size_t kept = 0;
        for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
            Triangle t = mesh.triangles[n];
            for (VertexId& v : t) v = becomes[v];
            if (t != mesh.triangles[n]) isChanged_[origin_[n]] = 1;
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
            mesh.triangles[kept] = t;
            origin_[kept++] = origin_[n];
        }
        mesh.triangles.resize(kept);
        origin_.resize(kept);
    }

    /// Removes triangles that have no area by now.
    void splitFlat() {
        const AreaTriangles area = withoutFlatTriangles(cut_.mesh, kPartRounded * boundMm_);
        if (area.triangles.empty()) return;
        std::vector<std::int64_t> origins;
        std::vector<Triangle> triangles;
        for (std::size_t t = 0; t < area.triangles.size(); ++t) {
            const bool isLeftOut = area.isLeftOut[t] != 0;
            if (isLeftOut || area.triangles[t] != cut_.mesh.triangles[t])
                isChanged_[origin_[t]] = 1;
            if (isLeftOut) continue;
            triangles.push_back(area.triangles[t]);
            origins.push_back(origin_[t]);
        }
        cut_.mesh.triangles = std::move(triangles);
        origin_ = std::move(origins);
    }

    /// Gives each fan of triangles at a point but the first a point of its own, a little inward of
    /// the fan, so that parts that touch there do not: a star that crosses itself may end in
    /// several, and so do solids that touch along an edge.
    void partFans() {
        MendStatistics found;
        judgeSurface(cut_, found);
        if (cut_.badVertices.empty()) return;
        TriangleMesh& mesh = cut_.mesh;
        const Buckets<std::uint32_t> atPoint(mesh.points.size(), [&](const auto& give) {
            for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
                for (const VertexId v : mesh.triangles[t]) give(static_cast<std::size_t>(v), t);
            }
        });
        const Partners partners = findPartners(atPoint);
        const std::size_t firstOwn = mesh.points.size();
        for (const std::uint32_t v : cut_.badVertices) {
            const auto fans = fansAt(v, atPoint.of(v), partners);
            for (std::size_t n = 1; n < fans.size(); ++n) {
                moveInward(v, fans[n]);
                for (const std::uint32_t t : fans[n]) isChanged_[origin_[t]] = 1;
            }
        }
        if (mesh.points.size() == firstOwn) return;
        roundPoints(firstOwn);
        findEdges(cut_);
    }

    /// At edges of more than two triangles: by edge and triangle, the triangle on the other side of
    /// the solid's wedge there.
    using Partners = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;

    Partners findPartners(const Buckets<std::uint32_t>& atPoint) const {
        const TriangleMesh& mesh = cut_.mesh;
        Partners partners;
        for (std::uint32_t e = 0; e < cut_.edges.size(); ++e) {
            if (cut_.edges[e].isSound) continue;
            const VertexId a = cut_.edges[e].a, b = cut_.edges[e].b;
            const Vec3 along = normalized(mesh.points[b] - mesh.points[a]);
            struct Turned {
                double angle;  // of a square instead of a circle
                std::uint32_t triangle;
                bool isUp;
            };
            std::vector<Turned> around;
            Vec3 x, y;
            for (const std::uint32_t t : atPoint.of(static_cast<std::size_t>(a))) {
                const Triangle& corners = mesh.triangles[t];
                const auto at = std::find(corners.begin(), corners.end(), b) - corners.begin();
                if (at == 3) continue;
                const bool isUp = corners[(at + 2) % 3] == a;
                const Vec3 out = mesh.points[corners[(at + (isUp ? 1 : 2)) % 3]] - mesh.points[a];
                if (around.empty()) {
                    x = normalized(out - dot(out, along) * along);
                    y = cross(along, x);
                }
                const double u = dot(out, x), v = dot(out, y), size = std::abs(u) + std::abs(v);
                const double part = size > 0 ? u / size : 1;
                around.push_back({v < 0 ? 3 + part : 1 - part, t, isUp});
            }
            std::sort(around.begin(), around.end(),
                      [](const Turned& p, const Turned& q) { return p.angle < q.angle; });
            // the solid lies before a triangle that runs from a to b, and after the others
            for (std::size_t n = 0; n < around.size(); ++n) {
                const Turned &one = around[n], &next = around[(n + 1) % around.size()];
                if (one.isUp || !next.isUp) continue;
                partners[{e, one.triangle}] = next.triangle;
                partners[{e, next.triangle}] = one.triangle;
            }
        }
        return partners;
    }

    /// \return none where it is open which triangles at an edge belong together
    std::vector<std::vector<std::uint32_t>> fansAt(std::uint32_t v,
                                                   std::span<const std::uint32_t> around,
                                                   const Partners& partners) const {
        DisjointSets sets(std::ssize(around));
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> seen;  // edge, pair
        for (std::int64_t n = 0; n < std::ssize(around); ++n) {
            for (const std::uint32_t e : cut_.edgeOf[around[n]]) {
                const MendInput::Edge& edge = cut_.edges[e];
                if (edge.a != v && edge.b != v) continue;
                std::uint32_t pair = 0;
                if (!edge.isSound) {
                    const auto partner = partners.find({e, around[n]});
                    if (partner == partners.end()) return {};
                    pair = std::min(around[n], partner->second);
                }
                const auto [other, isFirst] = seen.try_emplace({e, pair}, n);
                if (!isFirst) sets.join(other->second, n);
            }
        }
        std::map<std::int64_t, std::vector<std::uint32_t>> bySet;
        for (std::int64_t n = 0; n < std::ssize(around); ++n) {
            bySet[sets.find(n)].push_back(around[n]);
        }
        std::vector<std::vector<std::uint32_t>> fans;
        for (auto& [set, triangles] : bySet) fans.push_back(std::move(triangles));
        return fans;
    }

    void moveInward(VertexId v, const std::vector<std::uint32_t>& fan) {
        constexpr double kPartOfEdge = 0.1;
        TriangleMesh& mesh = cut_.mesh;
        const Vec3 apex = mesh.points[v];
        Vec3 inward;
        double shortest = std::numeric_limits<double>::infinity();
        for (const std::uint32_t t : fan) {
            for (const VertexId w : mesh.triangles[t]) {
                if (w == v) continue;
                const Vec3 spoke = mesh.points[w] - apex;
                shortest = std::min(shortest, norm(spoke));
                inward += normalized(spoke);
            }
        }
        const double length = std::min(kPartOfEdge * shortest, kPartMoved * boundMm_);
        const VertexId own = std::ssize(mesh.points);
        mesh.points.push_back(apex + length * normalized(inward));
        for (const std::uint32_t t : fan) {
            std::replace(mesh.triangles[t].begin(), mesh.triangles[t].end(), v, own);
        }
    }

    /// Brings over what else is known of the input, caps last.
    void bringOver() {
        std::vector<std::size_t> order(origin_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return origin_[a] < origin_[b]; });
        constexpr std::uint32_t kNone = ~std::uint32_t{0};
        std::vector<std::uint32_t> lastOf(input_.mesh.triangles.size(), kNone),
            becomes(origin_.size());
        std::vector<Triangle> sorted;
        for (const std::size_t t : order) {
            const std::int64_t origin = origin_[t];
            lastOf[origin] = becomes[t] = static_cast<std::uint32_t>(sorted.size());
            sorted.push_back(cut_.mesh.triangles[t]);
            cut_.partOf.push_back(isChanged_[origin] != 0 ? origin : -1);
            if (!isGiven(origin)) cut_.capOf.push_back(input_.capOf[origin - input_.firstCap()]);
        }
        cut_.mesh.triangles = std::move(sorted);
        for (auto& [s, t] : cut_.crossingPairs) {
            s = becomes[s];
            t = becomes[t];
            if (t < s) std::swap(s, t);
        }
        for (const LostPair& pair : input_.lostPairs) {
            const std::uint32_t t = lastOf[pair.triangle];
            if (t == kNone) inner_.push_back({pair.corners, sheetOf(pair.triangle)});
            if (t != kNone) cut_.lostPairs.push_back({pair.corners, t});
        }
        findEdges(cut_);
        MendStatistics found;
        judgeSurface(cut_, found);
    }

    /// How far what was kept may lie from what became of it, and the other way. What is farther is
    /// dropped. None where there is such a thing in the result.
    std::optional<double> prove() {
        double upperMm = 8 * nearMm_ + movedMm_;  // by which parts were moved as they were cut
        std::vector<Corners> changed;
        for (std::size_t t = 0; t < cut_.partOf.size(); ++t) {
            const std::int64_t origin = cut_.partOf[t];
            if (origin < 0 || !isGiven(origin)) continue;
            const Corners part = cornersOf(cut_.mesh, static_cast<std::int64_t>(t)),
                          whole = cornersOf(input_.mesh, origin);
            double away = 1e-12 * sizeMm_;  // largest at a corner, as the distance is convex
            for (const Vec3& p : part) {
                const Vec3 nearest = closestPointOnTriangle(p, whole[0], whole[1], whole[2]);
                away = std::max(away, norm(nearest - p) + 1e-12 * sizeMm_);
            }
            if (away <= 2 * kPartMoved * boundMm_) {
                upperMm = std::max(upperMm, away);
            } else {
                changed.push_back(part);
            }
        }
        if (!farther(input_.given(), changed, upperMm).empty()) return std::nullopt;
        for (const Corners& lost : farther(cut_.given(), kept_, upperMm)) {
            inner_.push_back({lost, 0});
        }
        return upperMm;
    }

    /// The parts of `pieces` that are not proved to lie near `given`, within half of the bound.
    /// \param upperMm  raised to the distance that is proved for the others
    std::vector<Corners> farther(const TriangleMesh& given, const std::vector<Corners>& pieces,
                                 double& upperMm) const {
        if (pieces.empty()) return {};
        const TriangleMesh surface = withoutUnusedPoints(given);
        constexpr double kHalf = 0.5;
        // a small bound first: what is proved is no nearer than it has to be
        std::vector<std::int64_t> left(pieces.size());
        std::iota(left.begin(), left.end(), std::int64_t{0});
        std::vector<Corners> others;
        for (const double part : {2 * kPartRounded, 2 * kPartMoved, 8 * kPartMoved, kHalf}) {
            const NearnessProof proof(surface, part * boundMm_);
            std::vector<NearnessProof::Result> results(left.size());
            parallelForPieces(std::ssize(left), 64, [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t n = begin; n < end; ++n) {
                    const Corners& c = pieces[left[n]];
                    const double size = norm(boxOf(c).size());
                    proof.prove(c,
                                part < kHalf ? 0.1 * size : std::max(0.02 * size, 0.2 * boundMm_),
                                results[n]);
                }
            });
            std::vector<std::int64_t> next;
            for (std::size_t n = 0; n < left.size(); ++n) {
                const auto& result = results[n];
                if (!result.others.empty() && part < kHalf) {
                    next.push_back(left[n]);
                    continue;
                }
                upperMm = std::max(upperMm, result.upperMm);
                others.insert(others.end(), result.others.begin(), result.others.end());
            }
            left = std::move(next);
            if (left.empty()) break;
        }
        return others;
    }

    static std::vector<MendedPlace> placesOf(const std::vector<Dropped>& pieces) {
        TriangleMesh lost;
        std::map<std::int64_t, PointPlaces> places;  // of a sheet: two may meet where they are cut
        for (const Dropped& piece : pieces) {
            Triangle t{};
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3& p = piece.corners[i];
                t[i] = places[piece.sheet].add(p, static_cast<Id>(lost.points.size()));
                lost.points.push_back(p);
            }
            lost.triangles.push_back(t);
        }
        const std::vector<std::uint8_t> all(lost.triangles.size(), 1);
        std::vector<MendedPlace> found;
        for (const auto& of : connectedPlaces(lost, all)) found.push_back(of.first);
        return found;
    }

    const MendInput& input_;
    double boundMm_, nearMm_;
    bool isSingle_;
    double sizeMm_;
    double movedMm_ = 0;      ///< by corners that became one with others
    ComponentLabels sheets_;  ///< of the input
    std::size_t firstNew_;    ///< points from this on are not the input's
    MendInput cut_;
    std::vector<std::uint8_t> isChanged_;  ///< of the input's triangles: cut, or a corner moved
    std::vector<std::uint8_t> isKept_;     ///< of the input's triangles: whole, in the first round
    std::vector<std::int64_t> origin_;     ///< of cut_'s triangles
    std::vector<Corners> kept_;            ///< of the input's triangles, as they were cut first
    std::vector<Dropped> inner_, outer_;   ///< likewise
};

}  // namespace

std::optional<MendInput> cutCrossings(const MendInput& input, const BoundingBox& box,
                                      MendStatistics& statistics) {
    const bool isClosed = std::all_of(input.edges.begin(), input.edges.end(),
                                      [](const MendInput::Edge& e) { return e.isSound; });
    if ((input.crossingPairs.empty() && isClosed) || !input.undecided.empty()) return std::nullopt;
    const double boundMm = statistics.maxErrorMm - statistics.movedMm;
    const double sizeMm = std::max(norm(box.minimum), norm(box.maximum));
    struct Precision {
        double near;    ///< of the size
        bool isSingle;  ///< that of new points
    };
    // what near is: by double precision; for planes that are its results; by single precision. Last
    // for faces that cross at so small an angle that single precision moves where they do
    constexpr std::array<Precision, 4> kPrecisions{
        {{1e-11, true}, {1e-8, true}, {1e-6, true}, {1e-11, false}}};
    std::optional<CrossingCutter> best;
    for (const auto& [near, isSingle] : kPrecisions) {
        CrossingCutter cutter(input, sizeMm, boundMm,
                              std::min(near * sizeMm, kPartRounded * boundMm), isSingle);
        if (!cutter.cut() || (best && best->crossingPairs() <= cutter.crossingPairs())) continue;
        best.emplace(std::move(cutter));
        if (best->crossingPairs() == 0) break;
    }
    if (!best) return std::nullopt;
    return std::move(*best).finish(statistics);
}

}  // namespace adaptiso::detail
