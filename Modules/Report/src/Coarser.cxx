// Vertices that lie in one cell of a grid become one [Lindstrom2000], where it is nearest to the
// planes of the triangles around. Only cells that hold a vertex are kept: what it takes grows with
// the surface that comes out, not with the cube of the grid.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "PageParts.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {
namespace {

using CellId = std::int32_t;

/// Cell of each vertex.
struct Cells {
    std::vector<CellId> ofVertex;  ///< -1: of no triangle
    std::vector<Vec3> middle;      ///< RAS
    double sideMm = 0;
    std::int64_t triangles = 0;  ///< whose corners lie in three of them
};

bool isKept(const Cells& cells, const Triangle& t) {
    const CellId a = cells.ofVertex[t[0]], b = cells.ofVertex[t[1]], c = cells.ofVertex[t[2]];
    return a != b && b != c && c != a;
}

Cells cellsOf(const SceneMesh& mesh, const BoundingBox& box, double sideMm) {
    constexpr int kBits = 21;  // of each of three numbers
    Cells cells;
    cells.ofVertex.assign(static_cast<std::size_t>(mesh.pointCount()), -1);
    cells.sideMm = sideMm;
    std::unordered_map<std::uint64_t, CellId> found;
    mesh.forEachTriangle([&](const Triangle& t) {
        for (const VertexId v : t) {
            if (cells.ofVertex[v] >= 0) continue;
            const Vec3 p = mesh.point(v) - box.minimum;
            Vec3 middle = box.minimum;
            std::uint64_t key = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const auto place = static_cast<std::uint64_t>(p[axis] / sideMm);
                key = key << kBits | place;
                middle[axis] += (static_cast<double>(place) + 0.5) * sideMm;
            }
            const auto [cell, isNew] =
                found.try_emplace(key, static_cast<CellId>(cells.middle.size()));
            if (isNew) cells.middle.push_back(middle);
            cells.ofVertex[v] = cell->second;
        }
        cells.triangles += isKept(cells, t);
    });
    return cells;
}

/// The finest grid found in a few trials that leaves no more than `maxTriangles`.
Cells chooseCells(const SceneMesh& mesh, std::int64_t maxTriangles) {
    constexpr int kTrials = 6;
    constexpr double kEnough = 0.85, kAim = 0.93;
    const BoundingBox box = boxOf(mesh);
    const Vec3 extent = box.size();
    const double longest = std::max({extent.x, extent.y, extent.z});
    const auto most = static_cast<double>(std::max<std::int64_t>(maxTriangles, 1));
    const double finest = longest / (1 << 20);  // so that a cell's place fits its bits
    // a surface meets about 1.5 cells of each square as large as their side, two triangles in each
    double sideMm = std::max(std::sqrt(3.5 * surfaceArea(mesh) / most), finest);
    Cells best;
    for (int trial = 0; trial < kTrials || best.ofVertex.empty(); ++trial) {
        if (!(sideMm > 0)) sideMm = 1;  // all points are one
        Cells cells = cellsOf(mesh, box, sideMm);
        const auto count = static_cast<double>(cells.triangles);
        const bool isAllowed = cells.triangles <= maxTriangles;
        if (isAllowed && (best.ofVertex.empty() || cells.triangles > best.triangles)) {
            best = std::move(cells);
        }
        if (isAllowed && (count >= kEnough * most || sideMm <= finest)) break;
        // a step of no more than 4, and never none
        const double factor = std::sqrt(std::max(count, 1.0) / (kAim * most));
        sideMm *=
            std::clamp(isAllowed ? std::min(factor, 0.97) : std::max(factor, 1.05), 0.25, 4.0);
        sideMm = std::max(sideMm, finest);
    }
    return best;
}

/// The sum of squared distances, mm2, to planes, weighted by the triangles' areas.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    Vec3 pull;

    void add(const Vec3& normal, double weight, double offsetMm) {
        xx += weight * normal.x * normal.x;
        xy += weight * normal.x * normal.y;
        xz += weight * normal.x * normal.z;
        yy += weight * normal.y * normal.y;
        yz += weight * normal.y * normal.z;
        zz += weight * normal.z * normal.z;
        pull += weight * offsetMm * normal;
    }

    /// Where it is least, held to `near` where the planes leave that open.
    Vec3 lowest(const Vec3& near) const {
        constexpr double kHold = 1e-3;  // of the weight of the planes
        const double hold = kHold * (xx + yy + zz);
        if (!(hold > 0)) return near;
        const Mat3 matrix{{{{xx + hold, xy, xz}, {xy, yy + hold, yz}, {xz, yz, zz + hold}}}};
        return inverse(matrix) * (pull + hold * near);
    }
};

/// Sum over the vertices that become one.
struct Cluster {
    Quadric quadric;
    Vec3 sum;  ///< of its vertices, from the cell's middle
    double valueSum = 0;
    std::int64_t vertices = 0, values = 0;
};

std::vector<Cluster> gather(const SceneSurface& surface, const Cells& cells) {
    const SceneMesh& mesh = surface.mesh;
    std::vector<Cluster> clusters(cells.middle.size());
    for (std::size_t v = 0; v < cells.ofVertex.size(); ++v) {
        const CellId cell = cells.ofVertex[v];
        if (cell < 0) continue;
        Cluster& cluster = clusters[cell];
        cluster.sum += mesh.point(static_cast<VertexId>(v)) - cells.middle[cell];
        ++cluster.vertices;
        if (surface.valuesMm.empty() || !std::isfinite(surface.valuesMm[v])) continue;
        cluster.valueSum += surface.valuesMm[v];
        ++cluster.values;
    }
    mesh.forEachTriangle([&](const Triangle& t) {
        const Vec3 p = mesh.point(t[0]);
        const Vec3 area = areaVector2(p, mesh.point(t[1]), mesh.point(t[2]));
        const Vec3 normal = normalized(area);
        for (const VertexId v : t) {
            const CellId cell = cells.ofVertex[v];
            clusters[cell].quadric.add(normal, norm(area), dot(normal, p - cells.middle[cell]));
        }
    });
    return clusters;
}

/// Never outside its cell.
Vec3 pointOf(const Cluster& cluster, const Cells& cells, std::size_t cell) {
    const Vec3 mean = 1 / static_cast<double>(cluster.vertices) * cluster.sum;
    Vec3 p = cluster.quadric.lowest(mean);
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(p[axis])) return cells.middle[cell] + mean;
        p[axis] = std::clamp(p[axis], -cells.sideMm / 2, cells.sideMm / 2);
    }
    return cells.middle[cell] + p;
}

/// Each once; those that face each other stay both.
std::vector<Triangle> trianglesOf(const SceneMesh& mesh, const Cells& cells) {
    std::vector<std::array<CellId, 3>> found;
    found.reserve(static_cast<std::size_t>(cells.triangles));
    mesh.forEachTriangle([&](const Triangle& t) {
        if (!isKept(cells, t)) return;
        std::array<CellId, 3> corners{cells.ofVertex[t[0]], cells.ofVertex[t[1]],
                                      cells.ofVertex[t[2]]};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                    corners.end());
        found.push_back(corners);
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<Triangle> triangles;
    triangles.reserve(found.size());
    for (const auto& [a, b, c] : found) triangles.push_back({a, b, c});
    return triangles;
}

}  // namespace

SceneSurface coarser(const SceneSurface& surface, std::int64_t maxTriangles) {
    if (surface.mesh.triangleCount() <= maxTriangles) return surface;
    const Cells cells = chooseCells(surface.mesh, maxTriangles);
    const std::vector<Cluster> clusters = gather(surface, cells);
    TriangleMesh lps;
    lps.triangles = trianglesOf(surface.mesh, cells);
    lps.points.reserve(clusters.size());
    std::vector<double> values;
    for (std::size_t n = 0; n < clusters.size(); ++n) {
        lps.points.push_back(lpsToRas(pointOf(clusters[n], cells, n)));
        if (surface.valuesMm.empty()) continue;
        values.push_back(clusters[n].valueSum / static_cast<double>(clusters[n].values));
    }
    SceneSurface result = surface;
    result.mesh = SceneMesh(std::move(lps));
    result.ownValues = std::make_shared<const std::vector<double>>(std::move(values));
    result.valuesMm = *result.ownValues;
    return result;
}

TriangleMesh coarserMesh(const TriangleMesh& mesh, std::int64_t maxTriangles) {
    SceneSurface surface;
    surface.mesh = SceneMesh::of(mesh);
    return coarser(surface, maxTriangles).mesh.lps();
}

std::vector<std::int64_t> shareTriangles(const std::vector<std::int64_t>& counts,
                                         std::int64_t maxTriangles) {
    std::vector<std::size_t> order(counts.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return counts[a] < counts[b]; });
    std::vector<std::int64_t> shares(counts.size());
    std::int64_t left = std::max<std::int64_t>(maxTriangles, 0);
    for (std::size_t n = 0; n < order.size(); ++n) {
        const auto equal = left / static_cast<std::int64_t>(order.size() - n);
        shares[order[n]] = std::min(counts[order[n]], equal);
        left -= shares[order[n]];
    }
    return shares;
}

}  // namespace adaptiso
