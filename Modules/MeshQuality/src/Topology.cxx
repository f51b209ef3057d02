#include "adaptiso/MeshQuality/Topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "Triangles.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/ParallelSort.h"
#include "adaptiso/Core/Reach.h"

namespace adaptiso {

namespace {

constexpr double kMinAltitude = 1e-9;  // of the longest edge; checkTopology says why

bool isInRange(const TriangleMesh& mesh, const Triangle& t) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    return std::all_of(t.begin(), t.end(), [&](VertexId v) { return v >= 0 && v < count; });
}

bool hasRepeatedIndex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Takes part in edges, fans and components.
bool isConnecting(const TriangleMesh& mesh, const Triangle& t) {
    return isInRange(mesh, t) && !hasRepeatedIndex(t);
}

/// The triangles round every vertex: those of vertex v are triangle[first[v]] ... in ascending
/// order, up to triangle[first[v + 1]].
/// \tparam Number  std::uint32_t where three times the triangles fit: the lists are then half as
///                 large, and they are most of what checking a mesh takes
template <class Number>
struct VertexTriangles {
    std::vector<Number> first;
    std::vector<Number> triangle;
};

template <class Number>
VertexTriangles<Number> collectVertexTriangles(const TriangleMesh& mesh) {
    VertexTriangles<Number> result;
    result.first.assign(mesh.points.size() + 2, 0);
    // Counted two places on and filled one place on, so that filling leaves `first` right.
    for (const Triangle& t : mesh.triangles) {
        if (!isConnecting(mesh, t)) continue;
        for (const VertexId v : t) ++result.first[v + 2];
    }
    std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
    result.triangle.resize(result.first.back());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        if (!isConnecting(mesh, mesh.triangles[n])) continue;
        for (const VertexId v : mesh.triangles[n]) {
            result.triangle[result.first[v + 1]++] = static_cast<Number>(n);
        }
    }
    result.first.pop_back();
    return result;
}

/// Checks the triangles round one vertex. Edges are counted at their lower end, duplicates at
/// the lowest corner, so that each counts once.
struct VertexFacts {
    std::uint32_t edges = 0;
    std::uint32_t boundaryEdges = 0;
    std::uint32_t nonManifoldEdges = 0;
    std::uint32_t inconsistentEdges = 0;
    std::uint32_t duplicateTriangles = 0;
    bool isNonManifold = false;

    bool isPlain() const { return *this == VertexFacts{.edges = edges}; }
    friend bool operator==(const VertexFacts&, const VertexFacts&) = default;
};

/// The facts of all vertices: what is more than a few edges is kept of those vertices alone that
/// have it, which are few.
class AllFacts {
public:
    explicit AllFacts(std::int64_t count) : edges_(static_cast<std::size_t>(count)) {}

    /// \param others  gets the vertex when it has more than a few edges
    void set(VertexId v, const VertexFacts& facts,
             std::vector<std::pair<VertexId, VertexFacts>>& others) {
        edges_[v] = static_cast<std::uint8_t>(facts.edges);
        if (!facts.isPlain() || facts.edges != edges_[v]) others.emplace_back(v, facts);
    }
    /// \pre pieces are added in the order of their vertices
    void add(const std::vector<std::pair<VertexId, VertexFacts>>& others) {
        others_.insert(others_.end(), others.begin(), others.end());
    }
    /// Calls f(vertex, facts), by vertex.
    template <class F>
    void forEach(const F& f) const {
        auto next = others_.begin();
        for (VertexId v = 0; v < std::ssize(edges_); ++v) {
            if (next != others_.end() && next->first == v) {
                f(v, next++->second);
            } else {
                f(v, VertexFacts{.edges = edges_[v]});
            }
        }
    }

private:
    std::vector<std::uint8_t> edges_;  ///< where there is nothing more, and they fit
    std::vector<std::pair<VertexId, VertexFacts>> others_;
};

/// Looks at the star of one vertex after the other; keeps its buffers.
template <class Number>
class StarInspector {
public:
    StarInspector(const TriangleMesh& mesh, const VertexTriangles<Number>& around)
        : mesh_(mesh), around_(around) {}

    /// Calls onDefect(defect, triangle or -1, vertices) for each defect counted at `v`.
    template <class OnDefect>
    VertexFacts inspect(VertexId v, const OnDefect& onDefect) {
        gather(v);
        VertexFacts facts;
        inspectSpokes(v, facts, onDefect);
        inspectDuplicates(v, facts, onDefect);
        if (facts.isNonManifold) {
            onDefect(TopologyDefect::NonManifoldVertex, -1, Triangle{v, -1, -1});
        }
        return facts;
    }

private:
    /// An edge of the star from the vertex to `rim`, as one of its triangles sees it.
    struct Spoke {
        VertexId rim;
        std::int32_t triangle;  ///< place in triangles_
        bool isOutgoing;        ///< the triangle runs from the vertex to `rim`
    };
    struct StarTriangle {
        std::int64_t triangle;
        VertexId low, high;   ///< the other two corners, sorted
        std::int32_t parent;  ///< of the union-find forest that makes fans
    };

    void gather(VertexId v) {
        triangles_.clear();
        spokes_.clear();
        for (Number n = around_.first[v]; n < around_.first[v + 1]; ++n) {
            const std::int64_t triangle = around_.triangle[n];
            const Triangle& t = mesh_.triangles[triangle];
            const int corner = t[0] == v ? 0 : t[1] == v ? 1 : 2;
            const VertexId next = t[(corner + 1) % 3], last = t[(corner + 2) % 3];
            const auto place = static_cast<std::int32_t>(triangles_.size());
            spokes_.push_back({next, place, true});
            spokes_.push_back({last, place, false});
            triangles_.push_back({triangle, std::min(next, last), std::max(next, last), place});
        }
        std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) {
            return std::pair(a.rim, a.triangle) < std::pair(b.rim, b.triangle);
        });
    }

    std::int32_t fanOf(std::int32_t place) {
        while (triangles_[place].parent != place) {
            place = triangles_[place].parent = triangles_[triangles_[place].parent].parent;
        }
        return place;
    }

    template <class OnDefect>
    void inspectSpokes(VertexId v, VertexFacts& facts, const OnDefect& onDefect) {
        std::size_t fans = triangles_.size();
        for (std::size_t begin = 0, end = 0; begin < spokes_.size(); begin = end) {
            const VertexId rim = spokes_[begin].rim;
            for (end = begin + 1; end < spokes_.size() && spokes_[end].rim == rim; ++end) {
                const std::int32_t a = fanOf(spokes_[begin].triangle);
                const std::int32_t b = fanOf(spokes_[end].triangle);
                if (a == b) continue;
                triangles_[std::max(a, b)].parent = std::min(a, b);
                --fans;
            }
            const std::size_t sides = end - begin;
            facts.isNonManifold = facts.isNonManifold || sides > 2;
            if (rim < v) continue;  // counted at the other end
            ++facts.edges;
            const Triangle ends{v, rim, -1};
            if (sides == 1) {
                ++facts.boundaryEdges;
                onDefect(TopologyDefect::BoundaryEdge, triangles_[spokes_[begin].triangle].triangle,
                         ends);
            } else if (sides > 2) {
                ++facts.nonManifoldEdges;
                onDefect(TopologyDefect::NonManifoldEdge, -1, ends);
            } else if (spokes_[begin].isOutgoing == spokes_[begin + 1].isOutgoing) {
                ++facts.inconsistentEdges;
                onDefect(TopologyDefect::InconsistentEdge, -1, ends);
            }
        }
        facts.isNonManifold = facts.isNonManifold || fans > 1;
    }

    template <class OnDefect>
    void inspectDuplicates(VertexId v, VertexFacts& facts, const OnDefect& onDefect) {
        std::erase_if(triangles_, [&](const StarTriangle& t) { return t.low < v; });
        std::sort(
            triangles_.begin(), triangles_.end(), [](const StarTriangle& a, const StarTriangle& b) {
                return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
            });
        for (std::size_t n = 1; n < triangles_.size(); ++n) {
            const StarTriangle &a = triangles_[n - 1], &b = triangles_[n];
            if (a.low != b.low || a.high != b.high) continue;
            ++facts.duplicateTriangles;
            onDefect(TopologyDefect::DuplicateTriangle, b.triangle, Triangle{v, b.low, b.high});
        }
    }

    const TriangleMesh& mesh_;
    const VertexTriangles<Number>& around_;
    std::vector<StarTriangle> triangles_;
    std::vector<Spoke> spokes_;
};

template <class Number>
AllFacts inspectVertices(const TriangleMesh& mesh, const VertexTriangles<Number>& around) {
    constexpr std::int64_t kGrain = 1 << 14;
    const std::int64_t count = std::ssize(mesh.points);
    AllFacts facts(count);
    std::vector<std::vector<std::pair<VertexId, VertexFacts>>> others((count + kGrain - 1) /
                                                                      kGrain);
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        StarInspector inspector(mesh, around);
        for (VertexId v = begin; v < end; ++v) {
            facts.set(v, inspector.inspect(v, [](TopologyDefect, std::int64_t, const Triangle&) {}),
                      others[begin / kGrain]);
        }
    });
    for (const auto& piece : others) facts.add(piece);
    return facts;
}

/// Counts defects and keeps the first few of each.
class DefectRecorder {
public:
    DefectRecorder(const TriangleMesh& mesh, const TopologyOptions& options, TopologyReport& report)
        : mesh_(mesh), maxExamples_(options.maxExamplesPerDefect), report_(report) {}

    bool wantsExample(TopologyDefect defect) const {
        return kept_[static_cast<std::size_t>(defect)] < maxExamples_;
    }
    void count(TopologyDefect defect, std::int64_t number) {
        report_.defects[static_cast<std::size_t>(defect)] += number;
    }
    void keepExample(TopologyDefect defect, std::int64_t triangle, const Triangle& vertices) {
        if (!wantsExample(defect)) return;
        ++kept_[static_cast<std::size_t>(defect)];
        report_.examples.push_back({defect, triangle, vertices, middle(vertices)});
    }
    void add(TopologyDefect defect, std::int64_t triangle, const Triangle& vertices) {
        count(defect, 1);
        keepExample(defect, triangle, vertices);
    }

private:
    /// Middle of those vertices that are there.
    Vec3 middle(const Triangle& vertices) const {
        Vec3 sum;
        int number = 0;
        for (const VertexId v : vertices) {
            if (v < 0 || v >= static_cast<VertexId>(mesh_.points.size())) continue;
            sum += mesh_.points[v];
            ++number;
        }
        return number > 0 ? 1.0 / number * sum : sum;
    }

    const TriangleMesh& mesh_;
    int maxExamples_;
    TopologyReport& report_;
    std::array<int, kTopologyDefectCount> kept_{};
};

template <class Number>
void recordVertexDefects(const TriangleMesh& mesh, const VertexTriangles<Number>& around,
                         const AllFacts& facts, DefectRecorder& recorder) {
    StarInspector inspector(mesh, around);
    const auto keep = [&](TopologyDefect defect, std::int64_t triangle, const Triangle& vertices) {
        recorder.keepExample(defect, triangle, vertices);
    };
    facts.forEach([&](VertexId v, const VertexFacts& of) {
        const std::array<std::pair<TopologyDefect, std::int64_t>, 5> found{{
            {TopologyDefect::BoundaryEdge, of.boundaryEdges},
            {TopologyDefect::NonManifoldEdge, of.nonManifoldEdges},
            {TopologyDefect::InconsistentEdge, of.inconsistentEdges},
            {TopologyDefect::DuplicateTriangle, of.duplicateTriangles},
            {TopologyDefect::NonManifoldVertex, of.isNonManifold ? 1 : 0},
        }};
        bool isWanted = false;
        for (const auto& [defect, number] : found) {
            recorder.count(defect, number);
            isWanted = isWanted || (number > 0 && recorder.wantsExample(defect));
        }
        if (isWanted) inspector.inspect(v, keep);
    });
}

template <class Number>
void recordPointDefects(const TriangleMesh& mesh, const std::vector<Number>& first,
                        DefectRecorder& recorder) {
    // A vertex that only a triangle with a repeated index names is used, if to no purpose.
    std::vector<bool> isNamed(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {
        if (isConnecting(mesh, t)) continue;
        for (const VertexId v : t) {
            if (v >= 0 && v < static_cast<VertexId>(mesh.points.size())) isNamed[v] = true;
        }
    }
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        const Triangle where{static_cast<VertexId>(n), -1, -1};
        if (first[n] == first[n + 1] && !isNamed[n]) {
            recorder.add(TopologyDefect::UnusedVertex, -1, where);
        }
        if (!isFinite(mesh.points[n])) recorder.add(TopologyDefect::NonFiniteVertex, -1, where);
    }
}

void recordTriangleDefects(const TriangleMesh& mesh, DefectRecorder& recorder) {
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const Triangle& t = mesh.triangles[n];
        const auto number = static_cast<std::int64_t>(n);
        if (!isInRange(mesh, t)) {
            recorder.add(TopologyDefect::IndexOutOfRange, number, t);
        } else if (isDegenerate(mesh, t)) {
            recorder.add(TopologyDefect::DegenerateTriangle, number, t);
        }
    }
}

template <class Number>
std::vector<SurfaceComponent> measureComponents(const TriangleMesh& mesh,
                                                const std::vector<Number>& first,
                                                const AllFacts& facts) {
    std::vector<VertexId> component = findComponentRoots(mesh);
    std::vector<SurfaceComponent> components;
    facts.forEach([&](VertexId v, const VertexFacts& of) {
        if (first[v] == first[v + 1]) return;
        // Labels become component numbers as we pass: a root comes before the rest of its piece.
        if (component[v] == v) {
            component[v] = static_cast<std::int64_t>(components.size());
            components.emplace_back().firstVertex = v;
        } else {
            component[v] = component[component[v]];
        }
        SurfaceComponent& piece = components[component[v]];
        ++piece.vertices;
        piece.edges += of.edges;
        piece.boundaryEdges += of.boundaryEdges;
        piece.isManifold = piece.isManifold && !of.isNonManifold;
        piece.isOriented = piece.isOriented && of.inconsistentEdges == 0;
    });
    for (const Triangle& t : mesh.triangles) {
        if (!isConnecting(mesh, t)) continue;
        SurfaceComponent& piece = components[component[t[0]]];
        ++piece.triangles;
        const Vec3 apex = mesh.points[piece.firstVertex];  // nearby: less cancellation
        const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        if (!isFinite(a) || !isFinite(b) || !isFinite(c) || !isFinite(apex)) continue;
        const Vec3 area2 = areaVector2(a, b, c);
        piece.areaMm2 += norm(area2) / 2;
        piece.signedVolumeMm3 += dot(a - apex, area2) / 6;
    }
    return components;
}

template <class Number>
void inspect(const TriangleMesh& mesh, const TopologyOptions& options, TopologyReport& report) {
    VertexTriangles<Number> around = collectVertexTriangles<Number>(mesh);
    const AllFacts facts = inspectVertices(mesh, around);

    DefectRecorder recorder(mesh, options, report);
    recordVertexDefects(mesh, around, facts, recorder);
    freeMemory(around.triangle);  // before components take as much
    recordPointDefects(mesh, around.first, recorder);
    recordTriangleDefects(mesh, recorder);
    report.components = measureComponents(mesh, around.first, facts);
}

}  // namespace

std::string_view toString(TopologyDefect defect) {
    constexpr const char* kWords[] = {
        "boundary edge",       "non-manifold edge",   "inconsistently oriented edge",
        "non-manifold vertex", "degenerate triangle", "duplicate triangle",
        "unused vertex",       "non-finite vertex",   "index out of range"};
    return kWords[static_cast<std::size_t>(defect)];
}

std::vector<VertexId> findComponentRoots(const TriangleMesh& mesh) {
    DisjointSets sets(std::ssize(mesh.points));
    for (const Triangle& t : mesh.triangles) {
        if (!isConnecting(mesh, t)) continue;
        sets.join(t[0], t[1]);
        sets.join(t[1], t[2]);
    }
    return std::move(sets).names();
}

std::optional<std::int64_t> SurfaceComponent::genus() const {
    if (!isClosed() || !isManifold || !isOriented) return std::nullopt;
    return (2 - eulerCharacteristic()) / 2;
}

bool TopologyReport::isSound() const {
    return std::all_of(defects.begin(), defects.end(), [](std::int64_t n) { return n == 0; });
}

std::optional<std::int64_t> TopologyReport::genus() const {
    std::int64_t sum = 0;
    for (const SurfaceComponent& component : components) {
        const auto genus = component.genus();
        if (!genus) return std::nullopt;
        sum += *genus;
    }
    return sum;
}

bool isDegenerate(const TriangleMesh& mesh, const Triangle& t) {
    if (hasRepeatedIndex(t)) return true;
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const double longest2 = std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)});
    return norm(areaVector2(a, b, c)) <= kMinAltitude * longest2;  // false with NaN
}

TopologyReport checkTopology(const TriangleMesh& mesh, const TopologyOptions& options) {
    TopologyReport report;
    report.vertices = static_cast<std::int64_t>(mesh.points.size());
    report.triangles = static_cast<std::int64_t>(mesh.triangles.size());

    if (mesh.triangles.size() <= std::numeric_limits<std::uint32_t>::max() / 3) {
        inspect<std::uint32_t>(mesh, options, report);
    } else {
        inspect<std::uint64_t>(mesh, options, report);
    }
    for (const SurfaceComponent& component : report.components) report.edges += component.edges;
    return report;
}

namespace {

constexpr VertexId kNowhere = -1;

/// The smallest number of a vertex at the same place, for every vertex.
std::vector<VertexId> findPlaces(const std::vector<Vec3>& points) {
    std::vector<VertexId> place(points.size(), kNowhere), order;
    order.reserve(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        if (std::isfinite(squaredNorm(points[v]))) order.push_back(static_cast<VertexId>(v));
    }
    parallelSort(order, [&](VertexId l, VertexId r) {
        const Vec3 &a = points[l], &b = points[r];
        return std::tie(a.x, a.y, a.z, l) < std::tie(b.x, b.y, b.z, r);
    });
    for (std::size_t n = 0; n < order.size(); ++n) {
        const bool isNew = n == 0 || points[order[n]] != points[order[n - 1]];
        place[order[n]] = isNew ? order[n] : place[order[n - 1]];
    }
    return place;
}

/// Three places, ascending, and the triangle's number.
using Seat = std::array<std::int64_t, 4>;

std::vector<Seat> findSeats(const TriangleMesh& mesh, const std::vector<VertexId>& place) {
    std::vector<Seat> seats;
    seats.reserve(mesh.triangles.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const Triangle& t = mesh.triangles[n];
        Seat seat{place[t[0]], place[t[1]], place[t[2]], static_cast<std::int64_t>(n)};
        std::sort(seat.begin(), seat.begin() + 3);
        if (seat[0] == kNowhere || seat[0] == seat[1] || seat[1] == seat[2]) continue;
        seats.push_back(seat);
    }
    parallelSort(seats);
    return seats;
}

/// The smallest `count` of `numbers`, ascending.
void keepFirst(std::vector<std::int64_t>& numbers, std::int64_t count) {
    std::sort(numbers.begin(), numbers.end());
    if (std::ssize(numbers) > count) numbers.resize(count);
}

}  // namespace

DuplicateReport findDuplicates(const TriangleMesh& mesh, const DuplicateOptions& options) {
    if (options.maxExamples < 0) {
        throw InvalidInput("findDuplicates: maxExamples is " + std::to_string(options.maxExamples) +
                           ", must be at least 0");
    }
    requireIndices(mesh, "findDuplicates");
    DuplicateReport report;
    const std::vector<VertexId> place = findPlaces(mesh.points);
    for (std::size_t n = 0; n < place.size(); ++n) {
        const auto v = static_cast<VertexId>(n);
        if (place[n] != kNowhere && place[n] != v) report.vertices.push_back(v);
    }
    const std::vector<Seat> seats = findSeats(mesh, place);
    for (std::size_t n = 1; n < seats.size(); ++n) {
        if (std::equal(seats[n].begin(), seats[n].begin() + 3, seats[n - 1].begin())) {
            report.triangles.push_back(seats[n][3]);
        }
    }
    report.vertexCount = std::ssize(report.vertices);
    report.triangleCount = std::ssize(report.triangles);
    keepFirst(report.vertices, options.maxExamples);
    keepFirst(report.triangles, options.maxExamples);
    return report;
}

std::int64_t joinVertices(TriangleMesh& mesh) {
    requireIndices(mesh, "joinVertices");
    const std::vector<VertexId> place = findPlaces(mesh.points);
    std::vector<std::uint8_t> isJoined(mesh.points.size());
    for (Triangle& t : mesh.triangles) {
        for (VertexId& v : t) {
            if (place[v] == kNowhere || place[v] == v) continue;
            isJoined[v] = 1;
            v = place[v];
        }
    }
    return std::count(isJoined.begin(), isJoined.end(), 1);
}

namespace {

using Edge = std::array<VertexId, 2>;  ///< the smaller number first

/// Edges that lie in one triangle only, ascending.
std::vector<Edge> boundaryEdges(const TriangleMesh& mesh) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) {
            if (v < 0 || v >= count) {
                throw InvalidInput("findHoles: a triangle names vertex " + std::to_string(v) +
                                   ", there are " + std::to_string(count));
            }
        }
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        for (int n = 0; n < 3; ++n) {
            const VertexId a = t[n], b = t[(n + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<Edge> single;
    for (std::size_t n = 0; n < edges.size();) {
        std::size_t end = n + 1;
        while (end < edges.size() && edges[end] == edges[n]) ++end;
        if (end == n + 1) single.push_back(edges[n]);
        n = end;
    }
    return single;
}

/// Sets of vertices; a set goes by its smallest number.
class VertexSets {
public:
    VertexId find(VertexId v) {
        auto [place, isNew] = parents_.try_emplace(v, v);
        if (isNew || place->second == v) return v;
        return place->second = find(place->second);
    }
    void join(VertexId a, VertexId b) {
        a = find(a);
        b = find(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::map<VertexId, VertexId> parents_;
};

}  // namespace

std::vector<Hole> findHoles(const TriangleMesh& mesh) {
    const std::vector<Edge> edges = boundaryEdges(mesh);
    VertexSets sets;
    for (const Edge& edge : edges) sets.join(edge[0], edge[1]);
    std::map<VertexId, Hole> holes;  // by their smallest vertex
    std::map<VertexId, Reach> reaches;
    for (const Edge& edge : edges) {
        const Vec3 &a = mesh.points[edge[0]], &b = mesh.points[edge[1]];
        const double lengthMm = norm(b - a);
        if (!std::isfinite(lengthMm)) continue;
        Hole& hole = holes[sets.find(edge[0])];
        Reach& reach = reaches[sets.find(edge[0])];
        reach.add(a);
        reach.add(b);
        ++hole.edges;
        hole.lengthMm += lengthMm;
        hole.middleMm += 0.5 * lengthMm * (a + b);
    }
    std::vector<Hole> result;
    for (auto& [vertex, hole] : holes) {
        hole.middleMm = hole.lengthMm > 0 ? 1 / hole.lengthMm * hole.middleMm : mesh.points[vertex];
        hole.spanMm = reaches.at(vertex).spanMm();
        result.push_back(hole);
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Hole& a, const Hole& b) { return a.lengthMm > b.lengthMm; });
    return result;
}

}  // namespace adaptiso
