#include <algorithm>
#include <array>
#include <cmath>

#include "Regions.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/LabelCentres.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfacePipeline/Verification.h"

namespace adaptiso::labels {
namespace {

constexpr std::size_t kMostPlaces = 12;  // to look at, of each check

Vec3 middleOfTriangle(const std::vector<Vec3>& points, const Triangle& t) {
    return (1.0 / 3) * (points[t[0]] + points[t[1]] + points[t[2]]);
}

/// The fault of a region's surface alone; empty if it is sound.
std::string faultOf(const TriangleMesh& mesh, const TopologyReport& topology,
                    const RegionMeasure& measure) {
    if (topology.triangles == 0) return "has no surface";
    for (int n = 0; n < kTopologyDefectCount; ++n) {
        if (topology.defects[n] == 0) continue;
        const auto defect = static_cast<TopologyDefect>(n);
        return "has " + formatCount(topology.defects[n]) + " x " + std::string(toString(defect));
    }
    double volume = 0;
    for (const SurfaceComponent& component : topology.components) {
        volume += component.signedVolumeMm3;
    }
    if (!(volume > 0)) return "faces inward";
    const auto pieces = findInsideOutPieces(mesh, topology);
    if (!pieces) return "has too many pieces within or across each other to check their sides";
    if (!pieces->empty()) {
        const std::int64_t insideOut = std::ssize(*pieces);
        return "has " + counted(insideOut, "piece") + " inside out";
    }
    const bool isMeasured = topology.triangles == measure.triangles &&
                            topology.vertices == measure.vertices &&
                            std::ssize(topology.components) == measure.components &&
                            topology.eulerCharacteristic() == measure.eulerCharacteristic;
    return isMeasured ? "" : "is not as it was measured";
}

LabelsCheck checkSurfaces(const RegionSurfaces& surfaces, const LabelsRun& run) {
    LabelsCheck check{"every region's surface is closed, outward and manifold"};
    std::vector<std::string> faults(run.regions.size());
    std::vector<Vec3> places(run.regions.size());
    parallelForPieces(std::ssize(run.regions), 1, [&](std::int64_t n, std::int64_t) {
        const TriangleMesh mesh = surfaces.surface(n);
        const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 1});
        faults[n] = faultOf(mesh, topology, run.regions[n].measure);
        if (faults[n].empty() || mesh.triangles.empty()) return;
        places[n] = topology.examples.empty()
                        ? middleOfTriangle(mesh.points, mesh.triangles.front())
                        : topology.examples.front().pointMm;
    });
    std::int64_t count = 0;
    for (std::size_t n = 0; n < faults.size(); ++n) {
        if (faults[n].empty()) continue;
        if (count++ == 0) check.finding = run.nameOf(run.regions[n].label) + " " + faults[n];
        if (check.pointsMm.size() < kMostPlaces) check.pointsMm.push_back(places[n]);
    }
    check.isPassed = count == 0;
    if (count > 1) check.finding += ", and " + formatCount(count - 1) + " more have faults";
    return check;
}

/// The regions' surfaces hold each wall once on either side by how they are made; what is left to
/// ask is whether the labels are those of regions.
LabelsCheck checkSides(const LabelComplex& complex, const LabelsRun& run) {
    LabelsCheck check{"every wall lies between exactly two regions"};
    std::int64_t count = 0;
    for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
        const auto& [first, second] = complex.labels[t];
        // of chosen regions, the other side may be any
        const bool isBetween =
            first != second && (run.find(first) != nullptr || run.find(second) != nullptr);
        if (isBetween) continue;
        if (count++ == 0) {
            check.finding = " between " + run.ids.text(first) + " and " + run.ids.text(second);
        }
        if (check.pointsMm.size() < kMostPlaces) {
            check.pointsMm.push_back(middleOfTriangle(complex.points, complex.triangles[t]));
        }
    }
    check.isPassed = count == 0;
    if (count > 0) check.finding = formatCount(count) + " triangles, the first" + check.finding;
    return check;
}

LabelsCheck checkCrossings(const LabelComplex& complex) {
    LabelsCheck check{"no two triangles cross"};
    const TriangleMesh whole{complex.points, {}, complex.triangles};
    const SelfIntersections found = findSelfIntersections(whole, {.maxPairs = kMostPlaces});
    check.isPassed = found.isClear();
    for (const TrianglePair& pair : found.pairs) {
        check.pointsMm.push_back(middleOfTriangle(complex.points, complex.triangles[pair[0]]));
    }
    if (!check.isPassed) {
        check.finding = crossingText(found);
    }
    return check;
}

LabelsCheck checkCentres(const LabelComplex& complex, const VolumeView& map, const LabelsRun& run) {
    LabelsCheck check{"every voxel centre lies in the region of its label"};
    const MislabelledCentres found = findMislabelledCentres(
        {complex.points, complex.triangles, complex.labels}, map, labelsOf(run.regions));
    check.isPassed = found.count == 0;
    if (check.isPassed) return check;
    const Index3& at = *found.first;
    check.finding = counted(found.count, "does", "do") + " not, the first voxel (" +
                    std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " +
                    std::to_string(at[2]) + ")";
    check.pointsMm.push_back(map.geometry().toPhysical(
        {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}));
    return check;
}

}  // namespace

void checkComplex(const LabelComplex& complex, const RegionSurfaces& surfaces,
                  const VolumeView& map, LabelsRun& run) {
    const auto stage = [&](const char* name, const auto& check) {
        run.checks.push_back(run.stage(name, check));
    };
    stage("check", [&] { return checkSurfaces(surfaces, run); });
    stage("check", [&] { return checkSides(complex, run); });
    stage("crossings", [&] { return checkCrossings(complex); });
    stage("centres", [&] { return checkCentres(complex, map, run); });
}

}  // namespace adaptiso::labels
