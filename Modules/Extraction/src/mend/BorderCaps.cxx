#include "mend/BorderCaps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adaptiso/Core/PolygonTriangulation.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "mend/PlanarFiller.h"

namespace adaptiso::detail {
namespace {

constexpr std::size_t kMostOfRing = 4096;

/// Rings of border edges, in the direction of triangles that close them.
std::vector<std::vector<VertexId>> borderRings(const MendInput& input) {
    constexpr VertexId kNone = -1, kSeveral = -2;
    std::vector<std::uint8_t> uses(input.edges.size());
    for (const auto& edges : input.edgeOf) {
        for (const std::uint32_t e : edges)
            uses[e] = static_cast<std::uint8_t>(std::min(uses[e] + 1, 3));
    }
    std::vector<VertexId> next(input.mesh.points.size(), kNone);
    for (std::size_t t = 0; t < input.edgeOf.size(); ++t) {
        const Triangle& corners = input.mesh.triangles[t];
        for (std::size_t i = 0; i < 3; ++i) {
            if (uses[input.edgeOf[t][i]] != 1) continue;
            VertexId& of = next[corners[(i + 1) % 3]];
            of = of == kNone ? corners[i] : kSeveral;
        }
    }
    std::vector<std::vector<VertexId>> rings;
    for (VertexId first = 0; first < std::ssize(next); ++first) {
        std::vector<VertexId> ring;
        for (VertexId v = first; next[v] >= 0;) {
            ring.push_back(v);
            v = std::exchange(next[v], kNone);
            if (v == first) {
                rings.push_back(std::move(ring));
                break;
            }
        }
    }
    return rings;
}

/// A ring seen along its mean normal, counter-clockwise. Empty where it has none.
std::vector<Point2> seenFlat(const std::vector<Vec3>& points, const std::vector<VertexId>& ring) {
    Vec3 normal;
    const Vec3& origin = points[ring[0]];
    for (std::size_t n = 0; n < ring.size(); ++n) {
        normal += cross(points[ring[n]] - origin, points[ring[(n + 1) % ring.size()]] - origin);
    }
    normal = normalized(normal);
    if (normal == Vec3{}) return {};
    Vec3 along;
    along[std::abs(normal.x) < 0.6 ? 0 : 1] = 1;
    const Vec3 u = normalized(cross(along, normal)), v = cross(normal, u);
    std::vector<Point2> flat;
    flat.reserve(ring.size());
    for (const VertexId p : ring) {
        flat.push_back({dot(u, points[p] - origin), dot(v, points[p] - origin)});
    }
    return flat;
}

}  // namespace

void addCaps(MendInput& input) {
    TriangleMesh& mesh = input.mesh;
    std::uint32_t caps = 0;
    for (const std::vector<VertexId>& ring : borderRings(input)) {
        if (ring.size() < 3 || ring.size() > kMostOfRing) continue;
        const auto cap = triangulatePolygon(seenFlat(mesh.points, ring));
        std::vector<Triangle> triangles;
        for (const auto& [a, b, c] : cap) triangles.push_back({ring[a], ring[b], ring[c]});
        const auto haveArea = [&] {
            return std::none_of(triangles.begin(), triangles.end(),
                                [&](const Triangle& t) { return isDegenerate(mesh, t); });
        };
        if (!haveArea()) {
            Vec3 normal;
            for (const auto& [a, b, c] : triangles) {
                normal += areaVector2(mesh.points[a], mesh.points[b], mesh.points[c]);
            }
            flipSlivers(mesh.points, normalized(normal), triangles);
            if (!haveArea()) continue;
        }
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
        input.capOf.insert(input.capOf.end(), triangles.size(), caps++);
    }
}

bool dropCrossingCaps(MendInput& input) {
    const std::int64_t first = input.firstCap();
    std::vector<std::uint8_t> isDropped(input.capOf.empty() ? 0 : input.capOf.back() + 1);
    const auto isCap = [&](std::uint32_t t) { return t >= first; };
    const auto judge = [&](std::uint32_t t) {
        if (isCap(t)) isDropped[input.capOf[t - first]] = 1;
    };
    for (const auto& [a, b] : input.crossingPairs) {
        judge(a);
        judge(b);
    }
    for (const std::uint32_t t : input.undecided) judge(t);
    if (std::find(isDropped.begin(), isDropped.end(), 1) == isDropped.end()) return false;
    // caps come last, so that no other triangle gets another number; none that crosses stays
    std::erase_if(input.crossingPairs,
                  [&](const auto& pair) { return isCap(pair[0]) || isCap(pair[1]); });
    std::erase_if(input.undecided, isCap);
    std::size_t next = 0;
    for (std::size_t n = 0; n < input.capOf.size(); ++n) {
        if (isDropped[input.capOf[n]] != 0) continue;
        input.mesh.triangles[first + next] = input.mesh.triangles[first + n];
        input.capOf[next++] = input.capOf[n];
    }
    input.mesh.triangles.resize(first + next);
    input.capOf.resize(next);
    return true;
}

}  // namespace adaptiso::detail
