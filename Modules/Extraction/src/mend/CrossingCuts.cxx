#include "mend/CrossingCuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "mend/Arrangement.h"
#include "mend/MendDistances.h"
#include "mend/NearnessProof.h"
#include "mend/WindingField.h"
#include "repair/FlatTriangles.h"

namespace adaptiso::detail {
namespace {

using Id = CutTriangle::Id;
using Numbers = std::array<Id, 3>;

constexpr double kPartRounded = 1e-3;  ///< of the bound: points may be rounded by as much
constexpr double kPartMoved = 0.01;    ///< of the bound, by which fans are parted

/// Triangles at one place, as one.
struct Face {
    Numbers corners;       ///< as the first of those that face as most do
    std::uint32_t number;  ///< its
    int count = 0;         ///< of those that face so, less the others; >= 0
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

/// Whether each face has the solid behind it and not in front. None where winding numbers are
/// unclear.
std::optional<std::vector<std::uint8_t>> findBorder(const Arrangement& arrangement,
                                                    const std::vector<Face>& faces,
                                                    const std::vector<Vec3>& points,
                                                    DisjointSets& patches, double sizeMm) {
    TriangleMesh all{points, {}, {}};
    all.triangles.reserve(arrangement.triangles.size());
    for (const auto& [a, b, c] : arrangement.triangles) all.triangles.push_back({a, b, c});
    const AabbTree tree(all);
    const WindingField field(all, tree);
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
    enum class Kind : std::uint8_t { Border, Other, Unclear };
    std::vector<Kind> kinds(ofPatch.size());
    parallelForPieces(std::ssize(ofPatch), 16, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            const Face& face = faces[ofPatch[n]];
            const Corners c = cornersAt(face);
            const double around = norm(c[1] - c[0]) + norm(c[2] - c[1]) + norm(c[0] - c[2]);
            const double depth = std::min(1e-9 * sizeMm, 0.1 * areaOf(face) / around);
            const Vec3 middle = 1.0 / 3 * (c[0] + c[1] + c[2]);
            const Vec3 step = depth * normalized(areaVector2(c[0], c[1], c[2]));
            kinds[n] = Kind::Unclear;
            for (const double far : {2.5, 8.0}) {
                const double front = field.at(middle + step, -1, far),
                             behind = field.at(middle - step, -1, far);
                const double inFront = std::round(front), inBack = std::round(behind);
                constexpr double kClear = 0.1;
                if (std::abs(front - inFront) > kClear || std::abs(behind - inBack) > kClear ||
                    inBack - inFront != face.count) {
                    continue;
                }
                kinds[n] = inFront < 1 && inBack >= 1 ? Kind::Border : Kind::Other;
                break;
            }
        }
    });
    if (std::find(kinds.begin(), kinds.end(), Kind::Unclear) != kinds.end()) return std::nullopt;
    std::vector<std::uint8_t> isBorder(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const std::size_t patch = numberOf.at(patches.find(static_cast<std::int64_t>(f)));
        isBorder[f] = kinds[patch] == Kind::Border ? 1 : 0;
    }
    return isBorder;
}

/// Cuts the triangles of a closed mesh where they meet, round by round.
class CrossingCutter {
public:
    CrossingCutter(const MendInput& input, double boundMm, double nearMm)
        : input_(input),
          bound_(boundMm),
          near_(nearMm),
          size_(sizeOf(input.mesh)),
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

    static double sizeOf(const TriangleMesh& mesh) {
        const BoundingBox box = boundingBox(mesh);
        return std::max(norm(box.minimum), norm(box.maximum));
    }

    /// \return  nothing crosses, or what does is that little that rounding leaves
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
        listDropped();
        return std::move(cut_);
    }

private:
    bool isGiven(std::int64_t origin) const { return origin < input_.firstCap(); }

    /// Cuts the triangles, and keeps those that have the solid on one side.
    bool keepBorder(bool isFirst) {
        const auto arrangement = arrange(cut_, cut_.crossingPairs, near_);
        if (!arrangement) return false;
        const std::vector<Face> faces = facesOf(arrangement->triangles);
        auto patches = patchesOf(faces);
        if (!patches) return false;
        const auto& points = cut_.mesh.points;
        const auto isBorder = findBorder(*arrangement, faces, points, *patches, size_);
        if (!isBorder) return false;
        std::vector<Triangle> triangles;
        std::vector<std::int64_t> origins;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto& [a, b, c] = faces[f].corners;
            const std::uint32_t whole = arrangement->origin[faces[f].number];
            const std::int64_t origin = origin_[whole];
            const bool isPart = arrangement->isCut[whole] != 0, isOfBorder = (*isBorder)[f] != 0;
            if (isPart) isChanged_[origin] = 1;
            if (isFirst && isGiven(origin)) {
                const Corners corners{points[a], points[b], points[c]};
                if (!isOfBorder) dropped_.push_back(corners);
                if (isOfBorder && isPart) kept_.push_back(corners);
                if (isOfBorder && !isPart) isKept_[origin] = 1;
            }
            if (!isOfBorder) continue;
            triangles.push_back({a, b, c});
            origins.push_back(origin);
        }
        cut_.mesh.triangles = std::move(triangles);
        origin_ = std::move(origins);
        return true;
    }

    /// Rounds points from `first` on to single precision, so that most files hold them; those at
    /// one place become one.
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
            for (int axis = 0; axis < 3 && v >= first; ++axis) {
                const double rounded = static_cast<float>(p[axis]);
                if (std::abs(rounded - p[axis]) <= kPartRounded * bound_) p[axis] = rounded;
            }
            becomes[v] = places.add(p, static_cast<Id>(v));
        }
        std::size_t kept = 0;
        for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
            Triangle t = mesh.triangles[n];
            for (VertexId& v : t) v = becomes[v];
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
            mesh.triangles[kept] = t;
            origin_[kept++] = origin_[n];
        }
        mesh.triangles.resize(kept);
        origin_.resize(kept);
    }

    /// Removes triangles that have no area by now.
    void splitFlat() {
        const AreaTriangles area = withoutFlatTriangles(cut_.mesh, kPartRounded * bound_);
        if (area.triangles.empty()) return;
        std::vector<std::int64_t> origins;
        cut_.mesh.triangles.clear();
        for (std::size_t t = 0; t < area.triangles.size(); ++t) {
            if (area.isLeftOut[t] != 0) continue;
            cut_.mesh.triangles.push_back(area.triangles[t]);
            origins.push_back(origin_[t]);
        }
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

    /// Of triangles at edges of more than two, the one across the solid between them.
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
        const double length = std::min(kPartOfEdge * shortest, kPartMoved * bound_);
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
        std::vector<std::uint32_t> lastOf(input_.mesh.triangles.size()), becomes(origin_.size());
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
        cut_.lostPairs = input_.lostPairs;
        for (LostPair& pair : cut_.lostPairs) pair.triangle = lastOf[pair.triangle];
        findEdges(cut_);
        MendStatistics found;
        judgeSurface(cut_, found);
    }

    /// How far what was kept may lie from what became of it, and the other way. What is farther is
    /// dropped. None where there is such a thing in the result.
    std::optional<double> prove() {
        double upperMm = 0;
        const auto farther = [&](const TriangleMesh& surface, std::vector<Corners> pieces) {
            // a small bound first: what is proved is no nearer than it has to be
            for (const double part : {2 * kPartRounded, 2 * kPartMoved, 8 * kPartMoved, 0.5}) {
                if (pieces.empty()) break;
                const NearnessProof proof(surface, part * bound_);
                NearnessProof::Result result;
                for (const Corners& c : pieces) {
                    constexpr double kSmallest = 0.1;  // of the piece
                    proof.prove(c, kSmallest * norm(boxOf(c).size()), result);
                }
                upperMm = std::max(upperMm, result.upperMm);
                pieces = std::move(result.others);
            }
            return pieces;
        };
        std::vector<Corners> changed;
        for (std::size_t t = 0; t < cut_.partOf.size(); ++t) {
            if (cut_.partOf[t] < 0) continue;
            changed.push_back(cornersOf(cut_.mesh, static_cast<std::int64_t>(t)));
        }
        if (!farther(input_.mesh, std::move(changed)).empty()) return std::nullopt;
        const auto lost = farther(cut_.mesh, std::move(kept_));
        dropped_.insert(dropped_.end(), lost.begin(), lost.end());
        return upperMm;
    }

    void listDropped() {
        TriangleMesh lost;
        PointPlaces places;
        for (const Corners& c : dropped_) {
            Triangle t{};
            for (std::size_t i = 0; i < 3; ++i) {
                t[i] = places.add(c[i], static_cast<Id>(lost.points.size()));
                lost.points.push_back(c[i]);
            }
            lost.triangles.push_back(t);
        }
        const std::vector<std::uint8_t> all(lost.triangles.size(), 1);
        for (const auto& of : connectedPlaces(lost, all)) cut_.dropped.push_back(of.first);
    }

    const MendInput& input_;
    double bound_, near_, size_;
    std::size_t firstNew_;  ///< points from this on are not the input's
    MendInput cut_;
    std::vector<std::uint8_t> isChanged_;  ///< of the input's triangles: cut, or a corner moved
    std::vector<std::uint8_t> isKept_;     ///< of the input's triangles: whole, in the first round
    std::vector<std::int64_t> origin_;     ///< of cut_'s triangles
    std::vector<Corners> kept_, dropped_;  ///< of the input's triangles, as they were cut first
};

}  // namespace

std::optional<MendInput> cutCrossings(const MendInput& input, MendStatistics& statistics) {
    const bool isClosed = std::all_of(input.edges.begin(), input.edges.end(),
                                      [](const MendInput::Edge& e) { return e.isSound; });
    if ((input.crossingPairs.empty() && isClosed) || !input.undecided.empty()) return std::nullopt;
    const double boundMm = statistics.maxErrorMm - statistics.movedMm;
    const double sizeMm = CrossingCutter::sizeOf(input.mesh);
    // of double precision, of planes found by some steps of it, of single precision
    std::optional<CrossingCutter> best;
    for (const double part : {1e-11, 1e-8, 1e-6}) {
        CrossingCutter cutter(input, boundMm, std::min(part * sizeMm, kPartRounded * boundMm));
        if (!cutter.cut() || (best && best->crossingPairs() <= cutter.crossingPairs())) continue;
        best.emplace(std::move(cutter));
        if (best->crossingPairs() == 0) break;
    }
    if (!best) return std::nullopt;
    return std::move(*best).finish(statistics);
}

}  // namespace adaptiso::detail
