#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::checker {
namespace {

constexpr std::size_t kMostMembers = 1000;

const Check* failed(const std::vector<Check>& checks, std::string_view key) {
    const auto found = std::find_if(checks.begin(), checks.end(),
                                    [&](const Check& check) { return check.key == key; });
    return found != checks.end() && found->hasFailed() ? &*found : nullptr;
}

/// The spots of one surface.
class SurfaceSpots {
public:
    SurfaceSpots(const SurfaceRun& surface, const TriangleMesh& mesh)
        : surface_(surface), mesh_(mesh), in_(" in " + baseName(surface.file)) {}

    std::vector<ReportSpot> find() && {
        addCrossings();
        addHoles();
        addExamples("manifoldEdges", TopologyDefect::NonManifoldEdge,
                    "edge in more than two triangles");
        addExamples("manifoldVertices", TopologyDefect::NonManifoldVertex,
                    "vertex whose triangles are not one fan");
        addExamples("consistentOrientation", TopologyDefect::InconsistentEdge, "flipped triangle");
        addExamples("noDegenerateTriangles", TopologyDefect::DegenerateTriangle,
                    "triangle without area");
        addExamples("noUnusedVertices", TopologyDefect::UnusedVertex, "vertex that nothing uses");
        addDuplicates();
        addComponents();
        addSliver();
        addDeviation();
        return std::move(spots_);
    }

private:
    void addCrossings() {
        const Check* check = failed(surface_.checks, "noSelfIntersections");
        if (!check) return;
        SpotClusters clusters(mesh_);
        const auto& pairs = surface_.facts.intersections.pairs;
        for (std::size_t n = 0; n < std::min(pairs.size(), kMostMembers); ++n) {
            clusters.add(middleOf(mesh_, pairs[n][0]));
        }
        clusters.tell("crossing triangles" + in_, check->isRequired, spots_);
    }

    void addHoles() {
        const Check* check = failed(surface_.checks, "closed");
        if (!check || surface_.facts.isSoup()) return;
        const std::vector<Hole> holes = findHoles(mesh_);
        for (std::size_t n = 0; n < std::min(holes.size(), kMostSpotsOfAKind); ++n) {
            spots_.push_back({"hole of " + formatCount(holes[n].edges) + " edges, " +
                                  formatLength(holes[n].lengthMm, 1) + " mm round," + in_,
                              holes[n].middleMm, check->isRequired, static_cast<int>(n)});
        }
    }

    void addExamples(std::string_view key, TopologyDefect defect, const std::string& what) {
        const Check* check = failed(surface_.checks, key);
        if (!check) return;
        SpotClusters clusters(mesh_);
        for (const TopologyExample& example : surface_.facts.topology.examples) {
            if (example.defect == defect) clusters.add(placeOf(example));
        }
        clusters.tell(what + in_, check->isRequired, spots_);
    }

    Vec3 placeOf(const TopologyExample& example) const {
        Vec3 sum;
        int found = 0;
        for (const VertexId v : example.vertices) {
            if (v < 0 || v >= std::ssize(mesh_.points)) continue;
            sum += mesh_.points[v];
            ++found;
        }
        return found > 0 ? 1.0 / found * sum : Vec3{std::numeric_limits<double>::quiet_NaN(), 0, 0};
    }

    void addDuplicates() {
        if (const Check* check = failed(surface_.checks, "noDuplicateTriangles")) {
            SpotClusters clusters(mesh_);
            for (const std::int64_t t : surface_.facts.duplicates.triangles) {
                clusters.add(middleOf(mesh_, t));
            }
            clusters.tell("triangle that is there twice" + in_, check->isRequired, spots_);
        }
        const Check* check = failed(surface_.checks, "noDuplicateVertices");
        if (!check || surface_.facts.isSoup()) return;
        SpotClusters clusters(mesh_);
        for (const VertexId v : surface_.facts.duplicates.vertices) clusters.add(mesh_.points[v]);
        clusters.tell("vertex that is there twice" + in_, check->isRequired, spots_);
    }

    /// All but the largest piece, and those that are the wrong way round.
    void addComponents() {
        std::vector<SurfaceComponent> pieces = surface_.facts.topology.components;
        if (const Check* check = failed(surface_.checks, "outward")) {
            const std::vector<std::int64_t>& wrong = *surface_.facts.insideOut;
            for (std::size_t n = 0; n < std::min(wrong.size(), kMostSpotsOfAKind); ++n) {
                const SurfaceComponent& piece = pieces[static_cast<std::size_t>(wrong[n])];
                spots_.push_back({"piece of " + formatCount(piece.triangles) +
                                      " triangles that is inside out" + in_,
                                  mesh_.points[piece.firstVertex], check->isRequired,
                                  static_cast<int>(n)});
            }
        }
        const Check* check = failed(surface_.checks, "oneComponent");
        if (!check || surface_.facts.isSoup()) return;
        std::stable_sort(pieces.begin(), pieces.end(),
                         [](const auto& a, const auto& b) { return a.triangles > b.triangles; });
        for (std::size_t n = 1; n < std::min(pieces.size(), kMostSpotsOfAKind); ++n) {
            spots_.push_back(
                {"loose piece of " + formatCount(pieces[n].triangles) + " triangles" + in_,
                 mesh_.points[pieces[n].firstVertex], check->isRequired, static_cast<int>(n) - 1});
        }
    }

    void addSliver() {
        const Check* check = failed(surface_.checks, "minAngle");
        if (!check) return;
        const Spread& angles = surface_.facts.shape.minAngleDeg;
        spots_.push_back({"smallest angle, " + formatFixed(angles.minimum, 2) + " degrees," + in_,
                          middleOf(mesh_, angles.triangleOfMinimum), check->isRequired});
    }

    void addDeviation() {
        if (!surface_.deviation) return;
        const Check* check = failed(surface_.checks, "onIsosurface");
        const Vec3& ras = surface_.deviation->maxPointMm;
        spots_.push_back({"farthest from the isosurface, " +
                              formatLength(surface_.deviation->maxMm, 2) + " mm," + in_,
                          {-ras.x, -ras.y, ras.z},
                          check && check->isRequired});
    }

    const SurfaceRun& surface_;
    const TriangleMesh& mesh_;
    std::string in_;
    std::vector<ReportSpot> spots_;
};

}  // namespace

std::vector<ReportSpot> spotsOf(const SurfaceRun& surface, const TriangleMesh& mesh) {
    return SurfaceSpots(surface, mesh).find();
}

std::vector<ReportSpot> spotsOf(const NestingRun& pair, const std::string& innerName,
                                const std::string& outerName, const TriangleMesh& inner,
                                const TriangleMesh& outer) {
    std::vector<ReportSpot> spots;
    const NestingReport& report = pair.report;
    const std::string names = innerName + " and " + outerName;
    if (const Check* check = failed(pair.checks, "noCrossing")) {
        SpotClusters clusters(inner);
        for (std::size_t n = 0; n < std::min(report.pairs.size(), kMostMembers); ++n) {
            clusters.add(middleOf(inner, report.pairs[n][0]));
        }
        clusters.tell(
            names + (report.relation == NestingRelation::Identical ? " are the same surface"
                                                                   : " cross"),
            check->isRequired, spots);
    }
    if (const Check* check = failed(pair.checks, "strictlyNested");
        check && report.firstNotInside >= 0) {
        spots.push_back({innerName + " is not inside " + outerName,
                         inner.points[report.firstNotInside], check->isRequired});
    }
    if (report.gap.triangleA < 0 || report.crossingPairs > 0) return spots;
    const Check* check = failed(pair.checks, "minGap");
    const NearestPoints nearest = triangleDistance(cornersOf(inner, report.gap.triangleA),
                                                   cornersOf(outer, report.gap.triangleB));
    spots.push_back(
        {"smallest gap, " + formatLength(nearest.distanceMm, 2) + " mm, between " + names,
         0.5 * (nearest.pointA + nearest.pointB), check && check->isRequired});
    return spots;
}

}  // namespace adaptiso::checker
