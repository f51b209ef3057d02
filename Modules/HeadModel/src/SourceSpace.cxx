#include "adaptiso/HeadModel/SourceSpace.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

constexpr double kOutsideMm = 0.5;  // half a voxel

/// Vertices and their neighbours along edges.
class EdgeGraph {
public:
    explicit EdgeGraph(const TriangleMesh& mesh) : begin_(mesh.points.size() + 1) {
        for (const Triangle& t : mesh.triangles) {
            for (const VertexId v : t) begin_[v + 1] += 2;
        }
        for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
        neighbours_.resize(begin_.back());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for (const auto& [a, b, c] : mesh.triangles) {
            for (const auto& [from, to] :
                 {std::pair{a, b}, {a, c}, {b, a}, {b, c}, {c, a}, {c, b}}) {
                neighbours_[next[from]++] = to;
            }
        }
    }

    std::span<const VertexId> of(VertexId v) const {
        return {neighbours_.data() + begin_[v], begin_[v + 1] - begin_[v]};
    }

private:
    std::vector<std::size_t> begin_;
    std::vector<VertexId> neighbours_;
};

/// The distance of every vertex to the nearest source, along edges.
class Distances {
public:
    explicit Distances(const TriangleMesh& mesh)
        : mesh_(mesh),
          graph_(mesh),
          mm_(mesh.points.size(), std::numeric_limits<double>::infinity()) {}

    double of(VertexId v) const { return mm_[v]; }

    void addSource(VertexId source) {
        using Entry = std::pair<double, VertexId>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
        mm_[source] = 0;
        front.emplace(0, source);
        while (!front.empty()) {
            const auto [mm, v] = front.top();
            front.pop();
            if (mm > mm_[v]) continue;
            for (const VertexId to : graph_.of(v)) {
                const double there = mm + norm(mesh_.points[to] - mesh_.points[v]);
                if (there >= mm_[to]) continue;
                mm_[to] = there;
                front.emplace(there, to);
            }
        }
    }

private:
    const TriangleMesh& mesh_;
    EdgeGraph graph_;
    std::vector<double> mm_;
};

std::vector<VertexId> verticesOfTriangles(const TriangleMesh& mesh) {
    std::vector<VertexId> vertices;
    for (const Triangle& t : mesh.triangles) vertices.insert(vertices.end(), t.begin(), t.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

/// A closed surface and how near to it sources may lie.
class Compartment {
public:
    explicit Compartment(const TriangleMesh& surface)
        : surface_(surface), tree_(surface), inside_(surface, tree_) {}

    struct Place {
        ClosestPoint nearest;
        bool isInside;
        double mm, edgeMm;

        bool isOutside() const { return !isInside && mm > kOutsideMm; }
        bool isFarEnough() const { return isInside && mm >= edgeMm; }
        bool isFarOutside() const { return !isInside && mm > edgeMm; }
    };

    Place at(const Vec3& p) const {
        const ClosestPoint nearest = tree_.closestPoint(p);
        const auto [a, b, c] = cornersOf(surface_, nearest.triangle);
        return {nearest, inside_.sideOf(p) == Side::Inside, std::sqrt(nearest.squaredDistanceMm2),
                (norm(b - a) + norm(c - b) + norm(a - c)) / 3};
    }

    /// The place for a source: where it is, or one edge inside.
    std::optional<Vec3> placeFor(Vec3 p) const {
        constexpr int kTries = 8;          // where the surface bends another triangle gets nearest
        constexpr double kBeyond = 1.001;  // rounding
        for (int n = 0; n < kTries; ++n) {
            const Place place = at(p);
            if (place.isFarEnough()) return p;
            if (n == 0 && place.isFarOutside()) return std::nullopt;
            const auto [a, b, c] = cornersOf(surface_, place.nearest.triangle);
            Vec3 inward = -normalized(cross(b - a, c - a));
            constexpr double kTouchingMm = 1e-6;
            if (place.mm > kTouchingMm) {
                inward = ((place.isInside ? 1 : -1) / place.mm) * (p - place.nearest.pointMm);
            }
            p = place.nearest.pointMm + kBeyond * place.edgeMm * inward;
        }
        return std::nullopt;
    }

private:
    const TriangleMesh& surface_;
    AabbTree tree_;
    InsideTest inside_;
};

template <class Body>
void forPoints(std::size_t count, const Body& body) {
    constexpr std::int64_t kGrain = 256;
    parallelForPieces(static_cast<std::int64_t>(count), kGrain,
                      [&](std::int64_t begin, std::int64_t end) {
                          for (std::int64_t n = begin; n < end; ++n) body(n);
                      });
}

}  // namespace

std::vector<Vec3> SourceSpace::orientations(std::int64_t point) const {
    if (grid) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return {toVec3(surface.normals[static_cast<std::size_t>(point)])};
}

SourceSpace surfaceSources(TriangleMesh surface, std::int64_t count) {
    const bool isClosed = checkTopology(surface, {.maxExamplesPerDefect = 0}).isClosed();
    if (isClosed && enclosedVolume(surface) < 0) flipOrientation(surface);
    surface.normals = areaWeightedNormals(surface);
    SourceSpace sources{std::move(surface), {}};
    sources.isOpen = !isClosed;
    const std::vector<VertexId> vertices = verticesOfTriangles(sources.surface);
    if (count >= std::ssize(vertices)) {
        sources.used.assign(vertices.begin(), vertices.end());
        return sources;
    }
    // the farthest first, of equally far ones the lowest number; distances only shrink, so that an
    // entry that is out of date goes back
    using Entry = std::pair<double, VertexId>;
    std::priority_queue<Entry> farthest;
    Distances distances(sources.surface);
    for (const VertexId v : vertices) farthest.emplace(distances.of(v), -v);
    while (std::ssize(sources.used) < count) {
        const auto [mm, minusVertex] = farthest.top();
        farthest.pop();
        const VertexId v = -minusVertex;
        if (mm > distances.of(v)) {
            farthest.emplace(distances.of(v), minusVertex);
            continue;
        }
        sources.used.push_back(v);
        distances.addSource(v);
    }
    std::sort(sources.used.begin(), sources.used.end());
    return sources;
}

SourceSpace gridSources(const TriangleMesh& compartment, double stepMm) {
    const BoundingBox box = boundingBox(compartment);
    ImageGeometry grid;
    for (int axis = 0; axis < 3; ++axis) {
        grid.originMm[axis] = stepMm * std::floor(box.minimum[axis] / stepMm);
        grid.indexToPhysical.column[axis][axis] = stepMm;
        grid.size[axis] = static_cast<std::int64_t>(
                              std::ceil((box.maximum[axis] - grid.originMm[axis]) / stepMm)) +
                          1;
    }
    SourceSpace sources;
    sources.grid = grid;
    std::vector<Vec3>& points = sources.surface.points;
    points.resize(static_cast<std::size_t>(grid.voxelCount()));
    std::vector<char> isSource(points.size());
    const Compartment within(compartment);
    forPoints(points.size(), [&](std::int64_t n) {
        points[n] = grid.toPhysical({static_cast<double>(n % grid.size[0]),
                                     static_cast<double>(n / grid.size[0] % grid.size[1]),
                                     static_cast<double>(n / grid.size[0] / grid.size[1])});
        isSource[n] = within.at(points[n]).isFarEnough() ? 1 : 0;
    });
    for (std::int64_t n = 0; n < std::ssize(points); ++n) {
        if (isSource[n] != 0) sources.used.push_back(n);
    }
    return sources;
}

SourceMoves keepWithin(SourceSpace& sources, const TriangleMesh& compartment) {
    const Compartment within(compartment);
    std::vector<std::optional<Vec3>> places(sources.used.size());
    std::vector<char> isOutside(sources.used.size());
    forPoints(places.size(), [&](std::int64_t n) {
        const Vec3& p = sources.surface.points[sources.used[n]];
        isOutside[n] = within.at(p).isOutside() ? 1 : 0;
        places[n] = within.placeFor(p);
    });
    SourceMoves moves;
    moves.outside = std::count(isOutside.begin(), isOutside.end(), 1);
    std::vector<std::int64_t> kept;
    for (std::size_t n = 0; n < places.size(); ++n) {
        if (!places[n]) {
            ++moves.dropped;
            continue;
        }
        kept.push_back(sources.used[n]);
        Vec3& p = sources.surface.points[sources.used[n]];
        const double mm = norm(*places[n] - p);
        if (mm == 0) continue;
        ++moves.moved;
        moves.meanMm += mm;
        moves.farthestMm = std::max(moves.farthestMm, mm);
        p = *places[n];
    }
    if (moves.moved > 0) moves.meanMm /= static_cast<double>(moves.moved);
    sources.used = std::move(kept);
    return moves;
}

std::int64_t pointsOutside(const std::vector<Vec3>& pointsMm, const TriangleMesh& surface) {
    const Compartment within(surface);
    std::vector<char> isOutside(pointsMm.size());
    forPoints(pointsMm.size(),
              [&](std::int64_t n) { isOutside[n] = within.at(pointsMm[n]).isOutside() ? 1 : 0; });
    return std::count(isOutside.begin(), isOutside.end(), 1);
}

}  // namespace adaptiso
