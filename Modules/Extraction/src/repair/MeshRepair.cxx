#include "repair/MeshRepair.h"

#include <algorithm>
#include <map>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr double kFlatVoxels = 1e-5;  ///< a triangle lower than this is flat
constexpr int kSpreadRounds = 12;

/// Position in `t` of the vertex that follows the directed edge a -> b, or -1.
int edgeIn(const Triangle& t, VertexId a, VertexId b) {
    for (int c = 0; c < 3; ++c) {
        if (t[c] == a && t[(c + 1) % 3] == b) return (c + 2) % 3;
    }
    return -1;
}

double squaredHeight(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)});
    return longest > 0 ? squaredNorm(areaVector2(a, b, c)) / longest : 0;
}

}  // namespace

std::vector<CrowdedEdge> findCrowdedEdges(const TriangleMesh& mesh) {
    // of the half-edges a -> b with a < b, a sound edge has one
    const std::size_t vertices = mesh.points.size();
    std::vector<std::uint64_t> first(vertices + 1, 0);
    const auto forEachUpward = [&](const auto& f) {
        for (const Triangle& t : mesh.triangles) {
            for (int c = 0; c < 3; ++c) {
                const VertexId a = t[c], b = t[(c + 1) % 3];
                if (a < b) f(a, b);
            }
        }
    };
    forEachUpward([&](VertexId a, VertexId) { ++first[a + 1]; });
    for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    // how far the other vertex is, in numbers: 32 bits hold that in all but enormous meshes
    std::vector<std::uint32_t> far(first[vertices]);
    forEachUpward([&](VertexId a, VertexId b) {
        if (b - a > 0xFFFFFFFF) throw InternalError("findCrowdedEdges: mesh too large");
        far[first[a]++] = static_cast<std::uint32_t>(b - a);
    });
    // filling has moved every start to its end, which is the next one's start

    std::map<std::pair<VertexId, VertexId>, std::vector<std::uint64_t>> crowded;
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto begin = far.begin() + static_cast<std::ptrdiff_t>(v > 0 ? first[v - 1] : 0),
                   end = far.begin() + static_cast<std::ptrdiff_t>(first[v]);
        std::sort(begin, end);
        for (auto at = std::adjacent_find(begin, end); at != end;
             at = std::adjacent_find(at + 1, end)) {
            crowded[{static_cast<VertexId>(v), static_cast<VertexId>(v) + *at}];
        }
    }
    std::vector<CrowdedEdge> found;
    if (crowded.empty()) return found;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            const VertexId a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
            const auto at = crowded.find({std::min(a, b), std::max(a, b)});
            if (at != crowded.end()) at->second.push_back(t);
        }
    }
    for (auto& [edge, triangles] : crowded) {
        found.push_back({edge.first, edge.second, std::move(triangles)});
    }
    return found;
}

void splitChords(TriangleMesh& mesh, const std::vector<ChordToSplit>& chords) {
    std::map<std::uint64_t, std::vector<std::uint64_t>> parts;  // of triangles split before
    const auto halve = [&](std::uint64_t whole, VertexId a, VertexId b, VertexId middle) {
        std::vector<std::uint64_t>& pieces = parts[whole];
        if (pieces.empty()) pieces.push_back(whole);
        for (const std::uint64_t t : pieces) {
            Triangle& triangle = mesh.triangles[t];
            for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
                const int opposite = edgeIn(triangle, from, to);
                if (opposite < 0) continue;
                const VertexId apex = triangle[opposite];
                triangle = {from, middle, apex};
                pieces.push_back(mesh.triangles.size());
                mesh.triangles.push_back({middle, to, apex});
                return;
            }
        }
        throw InternalError("splitChords: a triangle does not hold the chord");
    };
    for (const ChordToSplit& chord : chords) {
        const VertexId middle = static_cast<VertexId>(mesh.points.size());
        mesh.points.push_back(0.5 * (mesh.points[chord.a] + mesh.points[chord.b]));
        mesh.normals.push_back(
            toNormal(toVec3(mesh.normals[chord.a]) + toVec3(mesh.normals[chord.b])));
        halve(chord.first, chord.a, chord.b, middle);
        halve(chord.second, chord.a, chord.b, middle);
    }
}

void spreadFlatTriangles(TriangleMesh& mesh, std::span<const EdgeKey> edges,
                         const ImageGeometry& geometry, std::int64_t latticeOffset) {
    const Vec3 spacing = geometry.spacingMm();
    const double least = kFlatVoxels * std::min({spacing.x, spacing.y, spacing.z});
    const std::int64_t count = static_cast<std::int64_t>(mesh.triangles.size());
    constexpr std::int64_t kPiece = 1 << 16;
    for (int round = 0;; ++round) {
        std::vector<std::vector<std::int64_t>> flatOf((count + kPiece - 1) / kPiece);
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t i = begin; i < end; ++i) {
                const Triangle& t = mesh.triangles[i];
                const double height2 =
                    squaredHeight(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
                if (!(height2 > least * least)) flatOf[begin / kPiece].push_back(i);
            }
        });
        std::vector<std::int64_t> flat;
        for (const auto& some : flatOf) flat.insert(flat.end(), some.begin(), some.end());
        if (flat.empty()) return;
        if (round == kSpreadRounds) {
            throw InternalError("spreadFlatTriangles: " + std::to_string(flat.size()) +
                                " triangles stay flat");
        }
        for (const std::int64_t i : flat) {
            // turn by turn another corner, each time a little further
            const VertexId v = mesh.triangles[i][(i + round) % 3];
            if (v >= static_cast<VertexId>(edges.size())) continue;
            const int axis = edges[v].axis();
            Vec3 index = geometry.toIndex(mesh.points[v]);
            const double low = static_cast<double>(edges[v].position(axis) - latticeOffset);
            const double t = index[axis] - low;
            index[axis] +=
                (t < 0.5 ? 1 : -1) * kHair * (1 + round + 0.25 * static_cast<double>(v % 4));
            mesh.points[v] = geometry.toPhysical(index);
        }
    }
}

void completeNormals(TriangleMesh& mesh) {
    const auto isMissing = [&](VertexId v) { return mesh.normals[v] == Normal{}; };
    if (std::none_of(mesh.normals.begin(), mesh.normals.end(),
                     [](const Normal& n) { return n == Normal{}; })) {
        return;
    }
    std::map<VertexId, Vec3> sums;
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) {
            if (!isMissing(v)) continue;
            sums[v] += areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
        }
    }
    for (const auto& [v, sum] : sums) {
        mesh.normals[v] = squaredNorm(sum) > 0 ? toNormal(sum) : Normal{0, 0, 1};
    }
}

}  // namespace adaptiso::detail
