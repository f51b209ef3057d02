#include "adaptiso/Extraction/detail/FlatTriangles.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::detail {
namespace {

bool hasRepeatedIndex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

class Repair {
public:
    Repair(const TriangleMesh& mesh, std::vector<std::int64_t> flat, double mayMoveMm)
        : mesh_(mesh), flat_(std::move(flat)), mayMoveMm_(mayMoveMm) {
        result_.triangles = mesh.triangles;
        result_.isLeftOut.assign(mesh.triangles.size(), 0);
        result_.flat = std::ssize(flat_);
    }

    AreaTriangles run() {
        mergeCorners();
        for (const std::int64_t t : flat_) {
            if (hasRepeatedIndex(result_.triangles[t])) result_.isLeftOut[t] = 1;
        }
        collapseNeedles();
        std::erase_if(flat_, [&](std::int64_t t) { return result_.isLeftOut[t] != 0; });
        listEdges();
        // a neighbour that is flat itself has its turn first
        constexpr std::size_t kMostTries = 1 << 24;
        std::size_t tries = 0;
        for (std::size_t before = flat_.size() + 1; flat_.size() < before && tries < kMostTries;) {
            before = flat_.size();
            tries += before;
            std::erase_if(flat_, [&](std::int64_t t) { return splitAcross(t); });
        }
        for (const std::int64_t t : flat_) result_.isLeftOut[t] = 1;
        return std::move(result_);
    }

private:
    using Edge = std::pair<VertexId, VertexId>;
    static constexpr std::int64_t kSeveral = -1;

    /// Vertices at one place, of flat triangles.
    void mergeCorners() {
        DisjointSets sets(std::ssize(mesh_.points));
        bool isMerged = false;
        for (const std::int64_t t : flat_) {
            const Triangle& c = mesh_.triangles[t];
            for (int i = 0; i < 3; ++i) {
                const VertexId a = c[i], b = c[(i + 1) % 3];
                if (a == b || mesh_.points[a] != mesh_.points[b]) continue;
                sets.join(a, b);
                isMerged = true;
            }
        }
        if (!isMerged) return;
        for (Triangle& t : result_.triangles) {
            for (VertexId& v : t) v = sets.find(v);
        }
    }

    /// Collapses the shortest edges of flat triangles, where they are next to nothing.
    void collapseNeedles() {
        if (std::none_of(flat_.begin(), flat_.end(), [&](auto t) { return isNeedle(t); })) return;
        forEachAtFlatCorners([&](std::int64_t t) {
            for (const VertexId v : result_.triangles[t]) trianglesAt_[v].push_back(t);
        });
        for (const std::int64_t t : flat_) {
            if (!isNeedle(t)) continue;
            const Edge edge = shortestEdge(t);
            if (reachAfter(edge) <= mayMoveMm_ && isCollapsible(edge)) collapse(edge);
        }
    }

    bool isNeedle(std::int64_t t) const {
        constexpr double kNext = 1e-9;  // isDegenerate()'s
        if (result_.isLeftOut[t] != 0) return false;
        const Triangle& c = result_.triangles[t];
        const auto [a, b] = shortestEdge(t);
        double longest = 0;
        for (int i = 0; i < 3; ++i) longest = std::max(longest, lengthMm(c[i], c[(i + 1) % 3]));
        return lengthMm(a, b) <= kNext * longest;
    }

    double lengthMm(VertexId a, VertexId b) const {
        return norm(mesh_.points[b] - mesh_.points[a]);
    }

    Edge shortestEdge(std::int64_t t) const {
        const Triangle& c = result_.triangles[t];
        Edge shortest{c[0], c[1]};
        for (int i = 1; i < 3; ++i) {
            const Edge edge{c[i], c[(i + 1) % 3]};
            if (lengthMm(edge.first, edge.second) < lengthMm(shortest.first, shortest.second)) {
                shortest = edge;
            }
        }
        return std::minmax(shortest.first, shortest.second);
    }

    /// The neighbours of a vertex that a single fan of triangles closes around; none of others.
    std::set<VertexId> ringOf(VertexId v) const {
        std::map<VertexId, VertexId> after;
        for (const std::int64_t t : trianglesAt_.at(v)) {
            if (result_.isLeftOut[t] != 0) continue;
            const Triangle& c = result_.triangles[t];
            const auto i = std::find(c.begin(), c.end(), v) - c.begin();
            if (!after.try_emplace(c[(i + 1) % 3], c[(i + 2) % 3]).second) return {};
        }
        std::set<VertexId> ring;
        if (after.empty()) return ring;
        for (VertexId at = after.begin()->first; ring.insert(at).second;) {
            const auto next = after.find(at);
            if (next == after.end()) return {};
            at = next->second;
        }
        return ring.size() == after.size() ? ring : std::set<VertexId>();
    }

    /// The link condition away from borders, and no triangle loses its area.
    bool isCollapsible(const Edge& edge) const {
        constexpr std::size_t kMostAround = 1 << 12;  // at more, each would take as long as all
        if (std::max(trianglesAt_.at(edge.first).size(), trianglesAt_.at(edge.second).size()) >
            kMostAround) {
            return false;
        }
        const std::set<VertexId> a = ringOf(edge.first), b = ringOf(edge.second);
        std::vector<VertexId> common;
        std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
        if (common.size() != 2) return false;
        const std::vector<std::int64_t>& changed = trianglesAt_.at(edge.second);
        return std::all_of(changed.begin(), changed.end(), [&](std::int64_t t) {
            const Triangle after = renamed(result_.triangles[t], edge);
            return result_.isLeftOut[t] != 0 || hasRepeatedIndex(after) ||
                   !isDegenerate(mesh_, after) || isDegenerate(mesh_, result_.triangles[t]);
        });
    }

    static Triangle renamed(Triangle t, const Edge& edge) {
        std::replace(t.begin(), t.end(), edge.second, edge.first);
        return t;
    }

    double reachAfter(const Edge& edge) {
        const auto [stays, goes] = edge;
        return std::max(reachMm_[stays], reachMm_[goes] + lengthMm(stays, goes));
    }

    void collapse(const Edge& edge) {
        const auto [stays, goes] = edge;
        std::vector<std::int64_t>& at = trianglesAt_[stays];
        for (const std::int64_t t : std::exchange(trianglesAt_[goes], {})) {
            if (result_.isLeftOut[t] != 0) continue;
            Triangle& c = result_.triangles[t];
            c = renamed(c, edge);
            if (hasRepeatedIndex(c)) {
                result_.isLeftOut[t] = 1;
            } else {
                at.push_back(t);
            }
        }
        reachMm_[stays] = reachAfter(edge);
        result_.movedMm = std::max(result_.movedMm, reachMm_[stays]);
    }

    /// Calls f(triangle) for flat triangles and those beside them.
    template <class F>
    void forEachAtFlatCorners(const F& f) const {
        std::vector<std::uint8_t> isNear(mesh_.points.size(), 0);
        for (const std::int64_t t : flat_) {
            for (const VertexId v : result_.triangles[t]) isNear[v] = 1;
        }
        for (std::int64_t t = 0; t < std::ssize(result_.triangles); ++t) {
            const Triangle& c = result_.triangles[t];
            const bool isWanted =
                result_.isLeftOut[t] == 0 && !hasRepeatedIndex(c) &&
                std::any_of(c.begin(), c.end(), [&](VertexId v) { return isNear[v] != 0; });
            if (isWanted) f(t);
        }
    }

    void listEdges() {
        forEachAtFlatCorners([&](std::int64_t t) {
            const Triangle& c = result_.triangles[t];
            for (int i = 0; i < 3; ++i) {
                const auto [at, isNew] = triangleAt_.try_emplace({c[i], c[(i + 1) % 3]}, t);
                if (!isNew) at->second = kSeveral;
            }
        });
    }
    /// Puts a changed triangle in the place of another on its edges.
    void list(std::int64_t t) {
        const Triangle& c = result_.triangles[t];
        for (int i = 0; i < 3; ++i) {
            std::int64_t& at = triangleAt_[{c[i], c[(i + 1) % 3]}];
            if (at != kSeveral) at = t;
        }
    }

    /// Gives a flat triangle and the one across its longest side their other diagonal, where these
    /// two alone have that side: a third one would be left with an edge of its own.
    bool splitAcross(std::int64_t t) {
        const Triangle flat = result_.triangles[t];
        const auto lengthOf = [&](int i) {
            return squaredNorm(mesh_.points[flat[(i + 1) % 3]] - mesh_.points[flat[i]]);
        };
        int longest = 0;
        for (int i = 1; i < 3; ++i) {
            if (lengthOf(i) > lengthOf(longest)) longest = i;
        }
        const VertexId a = flat[longest], b = flat[(longest + 1) % 3], c = flat[(longest + 2) % 3];
        const auto across = triangleAt_.find(Edge{b, a});
        if (across == triangleAt_.end() || across->second == t || across->second == kSeveral ||
            triangleAt_.at({a, b}) != t) {
            return false;
        }
        const std::int64_t u = across->second;
        const Triangle other = result_.triangles[u];
        const VertexId d =
            *std::find_if(other.begin(), other.end(), [&](VertexId v) { return v != a && v != b; });
        if (triangleAt_.contains({c, d}) || triangleAt_.contains({d, c})) return false;
        const Triangle first{a, d, c}, second{d, b, c};
        if (isDegenerate(mesh_, first) || isDegenerate(mesh_, second)) return false;
        triangleAt_.erase({a, b});
        triangleAt_.erase({b, a});
        result_.triangles[t] = first;
        result_.triangles[u] = second;
        list(t);
        list(u);
        return true;
    }

    const TriangleMesh& mesh_;
    std::vector<std::int64_t> flat_;  ///< those that are still there
    double mayMoveMm_;
    AreaTriangles result_;
    std::map<VertexId, std::vector<std::int64_t>> trianglesAt_;  ///< around flat triangles, all
    std::map<VertexId, double> reachMm_;       ///< of the vertices that became this one
    std::map<Edge, std::int64_t> triangleAt_;  ///< kSeveral: of more than one
};

}  // namespace

AreaTriangles withoutFlatTriangles(const TriangleMesh& mesh, double mayMoveMm) {
    constexpr std::int64_t kPiece = 1 << 13;
    const std::int64_t count = std::ssize(mesh.triangles);
    std::vector<std::vector<std::int64_t>> flatIn((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            if (isDegenerate(mesh, mesh.triangles[t])) flatIn[begin / kPiece].push_back(t);
        }
    });
    std::vector<std::int64_t> flat;
    for (const auto& some : flatIn) flat.insert(flat.end(), some.begin(), some.end());
    if (flat.empty()) return {};
    return Repair(mesh, std::move(flat), mayMoveMm).run();
}

}  // namespace adaptiso::detail
