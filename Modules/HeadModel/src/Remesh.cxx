#include "adaptiso/HeadModel/Remesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "Handles.h"
#include "Remesher.h"
#include "SizeField.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

std::string at(const Vec3& p) {
    std::ostringstream text;
    text.precision(1);
    text << std::fixed << "(" << p.x << ", " << p.y << ", " << p.z << ") mm";
    return text.str();
}

template <class Number>
std::string rounded(Number value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

void checkRemeshOptions(const RemeshOptions& options) {
    constexpr std::int64_t kMinVertices = 12;  // an icosahedron
    const bool isAdaptive = options.edgeLengthMm || !options.wantedEdgesMm.empty();
    if (options.vertices < kMinVertices && !(options.vertices == 0 && isAdaptive)) {
        throw InvalidInput("remeshForBem: vertices is " + std::to_string(options.vertices) +
                           ", must be at least 12, or 0 with edge lengths");
    }
    if (!(options.fitMm >= 0) || !std::isfinite(options.fitMm)) {
        throw InvalidInput("remeshForBem: fitMm is " + rounded(options.fitMm) +
                           ", must be at least 0");
    }
    if (std::any_of(options.wantedEdgesMm.begin(), options.wantedEdgesMm.end(),
                    [](double mm) { return !(mm > 0); })) {
        throw InvalidInput("remeshForBem: an edge length is not above 0");
    }
    if (!options.edgeLengthMm) return;
    const auto [minimum, maximum] = *options.edgeLengthMm;
    if (!(minimum > 0) || !(maximum >= minimum) || !std::isfinite(maximum)) {
        throw InvalidInput("remeshForBem: edge lengths are " + rounded(minimum) + " to " +
                           rounded(maximum) + " mm, must be above 0 and in this order");
    }
}

void checkSurface(const TriangleMesh& surface) {
    const TopologyReport report = checkTopology(surface);
    const auto isFlaw = [](TopologyDefect defect) {
        return defect != TopologyDefect::UnusedVertex &&
               defect != TopologyDefect::DegenerateTriangle;
    };
    for (const TopologyExample& example : report.examples) {
        if (!isFlaw(example.defect)) continue;
        throw InvalidInput("remeshForBem: the surface has a " +
                           std::string(toString(example.defect)) + " at " + at(example.pointMm) +
                           "; it must be closed, oriented and manifold");
    }
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto [a, b, c] = surface.triangles[t];
        if (a != b && b != c && c != a) continue;
        throw InvalidInput("remeshForBem: triangle " + std::to_string(t) + " names vertex " +
                           std::to_string(a == b ? a : c) + " twice");
    }
    if (report.components.size() != 1) {
        throw InvalidInput("remeshForBem: the surface has " +
                           std::to_string(report.components.size()) +
                           " components, must have one; keep the largest");
    }
    if (!report.components[0].isOutward()) {
        throw InvalidInput("remeshForBem: the surface encloses " +
                           rounded(report.components[0].signedVolumeMm3) +
                           " mm3; triangles must be counter-clockwise seen from outside");
    }
    if (*report.genus() == 0) return;
    const HandleLoop loop = findHandleLoop(surface);
    throw InvalidInput("remeshForBem: the surface has " + std::to_string(*report.genus()) +
                       " handle(s), must have none; a loop of " + rounded(loop.lengthMm) +
                       " mm round or through one lies about " + at(loop.centreMm) +
                       "; fill or cut it in the image");
}

/// Edges of the wanted lengths, as in [Botsch2004].
void makeIsotropic(Remesher& remesher, std::int64_t vertices, int rounds) {
    constexpr std::int64_t kMostVertices = 4;  // times those wanted, should collapses get stuck
    for (int round = 0; round < rounds; ++round) {
        if (vertices > 0) remesher.setScale(remesher.scaleFor(vertices));
        remesher.splitLongEdges(kMostVertices * std::max(vertices, remesher.verticesWanted()));
        remesher.collapseShortEdges();
        remesher.evenValences();
        remesher.relax(3);
    }
}

/// Splits the longest or collapses the shortest edges until the number is right, or can't be had.
void reachVertexCount(Remesher& remesher, std::int64_t vertices) {
    constexpr int kMaxRounds = 60;
    for (int round = 0; round < kMaxRounds && remesher.vertexCount() != vertices; ++round) {
        const std::int64_t missing = vertices - remesher.vertexCount();
        if (missing > 0) {
            remesher.splitLongest(missing);
        } else {
            remesher.collapseShortest(-missing);
        }
        remesher.evenValences();
        remesher.relax(3);
    }
}

/// As many rounds up to 20,000 vertices, then fewer by their square, a tenth of them at least: each
/// takes time by the vertices, and irregular ones matter less the shorter edges are.
int roundsFor(int rounds, std::int64_t vertices) {
    constexpr double kMany = 20'000;
    const double share = std::min(1.0, kMany / static_cast<double>(vertices));
    return std::max(rounds / 10, static_cast<int>(rounds * share * share));
}

/// Puts vertices where edges are longest and takes as many where they are shortest, ever fewer of
/// them: this heals vertices of valence 5 and 7 that relaxing alone leaves as they are.
void evenOut(Remesher& remesher, int rounds) {
    constexpr std::int64_t kPart = 40;  // of the vertices that the first round moves
    for (int round = 0; round < rounds; ++round) {
        const std::int64_t share = remesher.vertexCount() * (rounds - round) / (rounds * kPart);
        const std::int64_t added = remesher.splitLongest(std::max<std::int64_t>(1, share));
        remesher.evenValences();
        remesher.relax(2);
        remesher.collapseShortest(added);
        remesher.evenValences();
        remesher.flipToDelaunay();
        remesher.relax(4);
    }
}

void settleShapes(Remesher& remesher) {
    constexpr int kRounds = 15;
    const int rounds = roundsFor(kRounds, remesher.vertexCount());
    for (int round = 0; round < rounds; ++round) {
        remesher.flipToDelaunay();
        remesher.relax(2);
    }
    remesher.flipToDelaunay();
}

Vec3 centreOf(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return 1.0 / 3 * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
}

/// Where two sheets cross, edges of 0.6 of the length; spread smoothly to the rest.
std::vector<double> shorterWhereCrossing(const RemeshTarget& target, const Remesher& remesher,
                                         const TriangleMesh& mesh,
                                         const SelfIntersections& crossings) {
    constexpr double kShorter = 0.6;
    std::vector<SizeSeed> seeds;
    const TriangleMesh& surface = target.surface();
    for (VertexId v = 0; v < std::ssize(surface.points); ++v) {
        if (!target.trianglesAround(v).empty()) {
            seeds.push_back({v, remesher.scale() * target.atVertex(v).sizeMm});
        }
    }
    for (const TrianglePair& pair : crossings.pairs) {
        for (const std::int64_t t : pair) {
            const Vec3 centre = centreOf(mesh, t);
            const auto look = [&](const Vec3& p) {
                const Landing landing = target.project(p, -1);
                for (const VertexId v : surface.triangles[landing.triangle]) {
                    seeds.push_back({v, kShorter * remesher.scale() * landing.sizeMm});
                }
            };
            look(centre);
            for (const VertexId v : mesh.triangles[t]) look(mesh.points[v]);
        }
    }
    return spreadSizes(target, seeds);
}

RemeshStatistics measure(const TriangleMesh& mesh, const RemeshTarget& target) {
    RemeshStatistics s;
    s.minimumEdgeMm = std::numeric_limits<double>::infinity();
    std::vector<double> anglesDeg;
    for (const Triangle& t : mesh.triangles) {
        double smallest = 180;
        for (int side = 0; side < 3; ++side) {
            const Vec3 &p = mesh.points[t[side]], &q = mesh.points[t[(side + 1) % 3]],
                       &r = mesh.points[t[(side + 2) % 3]];
            const double edge = norm(q - p);
            s.minimumEdgeMm = std::min(s.minimumEdgeMm, edge);
            s.maximumEdgeMm = std::max(s.maximumEdgeMm, edge);
            s.meanEdgeMm += edge / static_cast<double>(3 * mesh.triangles.size());
            const double angle = std::atan2(norm(areaVector2(p, q, r)), dot(q - p, r - p));
            smallest = std::min(smallest, angle * 180 / std::numbers::pi);
        }
        anglesDeg.push_back(smallest);
    }
    const auto rank = (anglesDeg.size() + 19) / 20 - 1;
    std::sort(anglesDeg.begin(), anglesDeg.end());
    s.minimumAngleDeg = anglesDeg.front();
    s.p5SmallestAngleDeg = anglesDeg[rank];
    for (const Vec3& p : mesh.points) {
        const double distance = std::sqrt(target.tree().closestPoint(p).squaredDistanceMm2);
        s.meanVertexDistanceMm += distance / static_cast<double>(mesh.points.size());
        s.maximumVertexDistanceMm = std::max(s.maximumVertexDistanceMm, distance);
    }
    return s;
}

/// Edges of one length or of the target's own, before the number of vertices counts.
/// \return  the number to reach
std::int64_t startOver(Remesher& remesher, std::int64_t vertices, int rounds, bool isThorough) {
    // room to choose from, times the vertices wanted; more where only the lengths say how many
    constexpr std::int64_t kCoarse = 4, kFine = 16;
    remesher.setThorough(isThorough);
    remesher.coarsen(vertices > 0 ? (isThorough ? kFine : kCoarse) * vertices
                                  : kFine * remesher.verticesWanted());
    remesher.compact();
    makeIsotropic(remesher, vertices, rounds);
    remesher.compact();
    return vertices > 0 ? vertices : std::max<std::int64_t>(12, remesher.verticesWanted());
}

/// The number of vertices, and shapes as good as they get.
TriangleMesh finish(Remesher& remesher, std::int64_t vertices, double fitMm) {
    constexpr int kEvenRounds = 20;
    reachVertexCount(remesher, vertices);
    evenOut(remesher, roundsFor(kEvenRounds, vertices));
    reachVertexCount(remesher, vertices);
    settleShapes(remesher);
    if (fitMm > 0) remesher.fitVertices(fitMm);
    return remesher.mesh().toMesh();
}

}  // namespace

std::vector<double> wantedEdgesMm(const TriangleMesh& surface, const RemeshOptions& options) {
    checkRemeshOptions(options);
    checkSurface(surface);
    return adaptiveSizes(RemeshTarget(surface), *options.edgeLengthMm, options.neighbours);
}

std::int64_t verticesForEdges(const TriangleMesh& surface, const std::vector<double>& edgesMm) {
    double triangles = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const double size = (edgesMm[a] + edgesMm[b] + edgesMm[c]) / 3;
        const Vec3 area2 = areaVector2(surface.points[a], surface.points[b], surface.points[c]);
        triangles += norm(area2) / 2 / (std::numbers::sqrt3 / 4 * size * size);
    }
    return std::max<std::int64_t>(12, std::llround(triangles / 2) + 2);  // Euler: T = 2 V - 4
}

Remeshed remeshForBem(const TriangleMesh& surface, const RemeshOptions& options) {
    checkRemeshOptions(options);
    checkSurface(surface);
    if (!options.wantedEdgesMm.empty() && options.wantedEdgesMm.size() != surface.points.size()) {
        throw InvalidInput("remeshForBem: " + std::to_string(options.wantedEdgesMm.size()) +
                           " edge lengths of " + std::to_string(surface.points.size()) +
                           " vertices");
    }
    // Where sheets cross it is mostly by chance: other rounds put vertices elsewhere. Shorter edges
    // cost the rest of the surface, and come last.
    constexpr std::array<int, 3> kIsotropicRounds{8, 10, 12};
    constexpr int kMendings = 4;

    RemeshTarget target(surface);
    if (!options.wantedEdgesMm.empty()) {
        target.setSizes(options.wantedEdgesMm);
    } else if (options.edgeLengthMm) {
        target.setSizes(adaptiveSizes(target, *options.edgeLengthMm, options.neighbours));
    }
    Remeshed result;
    SelfIntersections crossings;
    std::optional<Remesher> remesher;
    std::int64_t vertices = 0;
    for (const int rounds : kIsotropicRounds) {
        remesher.emplace(target);
        const bool isAgain = rounds != kIsotropicRounds.front();
        vertices = startOver(*remesher, options.vertices, rounds, isAgain);
        result.mesh = finish(*remesher, vertices, options.fitMm);
        crossings = findSelfIntersections(result.mesh);
        if (crossings.isClear()) break;
    }
    for (int n = 0; n < kMendings && !crossings.isClear(); ++n) {
        target.setSizes(shorterWhereCrossing(target, *remesher, result.mesh, crossings));
        // from the surface again: a mesh that crosses itself lands on the wrong sheet, ever worse
        remesher.emplace(target);
        vertices = startOver(*remesher, options.vertices, kIsotropicRounds.front(), true);
        result.mesh = finish(*remesher, vertices, options.fitMm);
        crossings = findSelfIntersections(result.mesh);
    }
    if (!crossings.isClear()) {
        const std::int64_t first = crossings.pairs.empty() ? 0 : crossings.pairs[0][0];
        result.findings.push_back({crossingText(crossings) +
                                       " at this number of vertices; ask for more vertices or a "
                                       "smoother surface",
                                   centreOf(result.mesh, first)});
    }
    if (std::ssize(result.mesh.points) != vertices) {
        result.findings.push_back({std::to_string(vertices) +
                                       " vertices can't be had: edits that keep the shape end at " +
                                       std::to_string(result.mesh.points.size()),
                                   result.mesh.points.front()});
    }
    result.statistics = measure(result.mesh, target);
    if (!result.findings.empty()) result.mesh = {};
    return result;
}

}  // namespace adaptiso
