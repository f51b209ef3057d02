#include "adaptive/full/FlatTriangles.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "adaptiso/Core/DisjointSets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::detail {
namespace {

bool hasRepeatedIndex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

class Repair {
public:
    Repair(const TriangleMesh& mesh, std::vector<std::int64_t> flat)
        : mesh_(mesh), flat_(std::move(flat)) {
        result_.triangles = mesh.triangles;
        result_.isLeftOut.assign(mesh.triangles.size(), 0);
        result_.flat = std::ssize(flat_);
    }

    AreaTriangles run() {
        mergeCorners();
        std::erase_if(flat_, [&](std::int64_t t) {
            const bool isGone = hasRepeatedIndex(result_.triangles[t]);
            if (isGone) result_.isLeftOut[t] = 1;
            return isGone;
        });
        listEdges();
        // a neighbour that is flat itself has its turn first
        for (std::size_t before = flat_.size() + 1; flat_.size() < before;) {
            before = flat_.size();
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

    /// Of flat triangles and those beside them.
    void listEdges() {
        std::vector<std::uint8_t> isNear(mesh_.points.size(), 0);
        for (const std::int64_t t : flat_) {
            for (const VertexId v : result_.triangles[t]) isNear[v] = 1;
        }
        for (std::int64_t t = 0; t < std::ssize(result_.triangles); ++t) {
            const Triangle& c = result_.triangles[t];
            const bool isWanted =
                result_.isLeftOut[t] == 0 && !hasRepeatedIndex(c) &&
                std::any_of(c.begin(), c.end(), [&](VertexId v) { return isNear[v] != 0; });
            if (!isWanted) continue;
            for (int i = 0; i < 3; ++i) {
                const auto [at, isNew] = triangleAt_.try_emplace({c[i], c[(i + 1) % 3]}, t);
                if (!isNew) at->second = kSeveral;
            }
        }
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
    AreaTriangles result_;
    std::map<Edge, std::int64_t> triangleAt_;  ///< kSeveral: of more than one
};

}  // namespace

AreaTriangles withoutFlatTriangles(const TriangleMesh& mesh) {
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
    return Repair(mesh, std::move(flat)).run();
}

}  // namespace adaptiso::detail
