#include <cmath>

#include "Common/Numbers.h"
#include "SurfaceSteps.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Size.h"
#include "adaptiso/MeshQuality/SolidAngle.h"

namespace adaptiso {
namespace {

/// What MNE takes for millimetres: every side of a surface's bounding box.
constexpr double kLeastExtentMm = 50;

std::string nameOf(std::size_t n) {
    return std::string(toString(static_cast<HeadSurface>(n)));
}

Vec3 middleOf(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return (1.0 / 3) * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
}

Vec3 middleOf(const TriangleMesh& mesh) {
    const BoundingBox box = boundingBox(mesh);
    return 0.5 * (box.minimum + box.maximum);
}

class Checklist {
public:
    explicit Checklist(BemRun& run) : run_(run) {}

    /// \param pointMm  where to look when it did not pass
    void add(const std::string& name, bool isPassed, const std::string& detail,
             const Vec3& pointMm) {
        run_.checks.push_back(
            {name, isPassed, detail, isPassed ? std::nullopt : std::optional(pointMm)});
        if (!isPassed) run_.findings.push_back({name + ": " + detail, pointMm});
    }

private:
    BemRun& run_;
};

void checkTopologyOf(const std::string& name, const TriangleMesh& mesh, const BemSurface& surface,
                     Checklist& list) {
    const TopologyReport& topology = surface.topology;
    const bool isBall = topology.isSound() && topology.isWatertight() &&
                        topology.components.size() == 1 && topology.genus() == 0;
    const Vec3 place = !topology.examples.empty() ? topology.examples.front().pointMm
                       : topology.components.size() > 1
                           ? mesh.points[topology.components[1].firstVertex]
                           : middleOf(mesh);
    std::string detail = formatCount(std::ssize(topology.components)) + " components, genus ";
    detail += topology.genus() ? formatCount(*topology.genus()) : "none";
    for (int n = 0; n < kTopologyDefectCount; ++n) {
        const auto defect = static_cast<TopologyDefect>(n);
        if (topology.count(defect) == 0) continue;
        detail += ", " + std::string(toString(defect)) + ": " + formatCount(topology.count(defect));
    }
    list.add(name + ": one closed surface of genus 0", isBall, detail, place);
}

void checkSurface(std::size_t n, const TriangleMesh& mesh, BemRun& run, Checklist& list) {
    const std::string name = nameOf(n);
    BemSurface& surface = run.surfaces[n];
    surface.topology = checkTopology(mesh);
    surface.areaMm2 = surfaceArea(mesh);
    surface.volumeMm3 = enclosedVolume(mesh);
    surface.shape = measureShape(mesh);
    checkTopologyOf(name, mesh, surface, list);

    const SolidAngleCriterion angle = solidAngleFromMean(mesh);
    surface.solidAngleShare = angle.share;
    list.add(name + ": complete and outward (solid angle, as MNE has it)", angle.isMet(),
             formatNumber(angle.share) + " of the whole sphere", middleOf(mesh));

    const SelfIntersections crossings = findSelfIntersections(mesh, {.maxPairs = 1});
    surface.crossingPairs = crossings.pairCount;
    list.add(name + ": does not cross itself", crossings.pairCount == 0,
             formatCount(crossings.pairCount) + " pairs of triangles",
             crossings.pairs.empty() ? middleOf(mesh) : middleOf(mesh, crossings.pairs[0][0]));

    const SizeReport size = judgeSize(mesh, {.minExtentMm = kLeastExtentMm,
                                             .minLargestExtentMm = kLeastExtentMm,
                                             .maxLargestExtentMm = 1000});
    surface.extentMm = size.extentMm;
    list.add(name + ": the size of a head in mm", size.verdict == SizeVerdict::Plausible,
             formatRounded(size.extentMm.x) + " x " + formatRounded(size.extentMm.y) + " x " +
                 formatRounded(size.extentMm.z) + " mm",
             middleOf(mesh));
}

}  // namespace

void checkModel(const std::vector<TriangleMesh>& surfaces, BemRun& run, ProgressLine& progress) {
    progress.show("check");
    run.timer.time("check", [&] {
        Checklist list(run);
        for (std::size_t n = 0; n < surfaces.size(); ++n) checkSurface(n, surfaces[n], run, list);
        const std::array<double, 2> gaps{run.options.boundaries.minSkullMm,
                                         run.options.boundaries.minScalpMm};
        run.gaps.clear();
        for (std::size_t n = 0; n + 1 < surfaces.size(); ++n) {
            const NestingReport nesting =
                checkNesting(surfaces[n], surfaces[n + 1], {.maxPairs = 0});
            const NearestPoints& nearest = nesting.gap.nearest;
            run.gaps.push_back({nearest.distanceMm, nearest.pointA, nearest.pointB});
            const std::string pair = nameOf(n) + " in " + nameOf(n + 1);
            list.add(pair + ": strictly nested", nesting.isStrictlyNested(),
                     std::string(toString(nesting.relation)), nearest.pointA);
            // nestSurfaces() measures as this does: rounding of a last digit is forgiven
            constexpr double kRoundingMm = 1e-9;
            list.add(pair + ": gap of " + formatNumber(gaps[n]) + " mm or more",
                     nearest.distanceMm >= gaps[n] - kRoundingMm,
                     formatFixed(nearest.distanceMm, 3) + " mm", nearest.pointA);
        }
    });
}

}  // namespace adaptiso
