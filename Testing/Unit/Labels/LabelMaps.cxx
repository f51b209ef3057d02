#include "LabelMaps.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::testing {
namespace {

/// Euler characteristic of what a label's voxels span in Kuhn's triangulation: vertices - edges +
/// triangles - tetrahedra all of whose corners have it. Its surface has twice that.
std::int64_t solidEulerCharacteristic(const Map& map, Label label) {
    // simplices are chains of steps, each with more of the bits 1, 2, 4 than the one before
    const std::vector<std::vector<int>> chains{
        {},     {1},    {2},       {3},       {4},       {5},       {6},       {7},      {1, 3},
        {1, 5}, {1, 7}, {2, 3},    {2, 6},    {2, 7},    {4, 5},    {4, 6},    {4, 7},   {3, 7},
        {5, 7}, {6, 7}, {1, 3, 7}, {1, 5, 7}, {2, 3, 7}, {2, 6, 7}, {4, 5, 7}, {4, 6, 7}};
    std::int64_t sum = 0;
    for (std::int64_t k = 0; k < map.geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < map.geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < map.geometry.size[0]; ++i) {
                if (map.at(i, j, k) != label) continue;
                for (const auto& chain : chains) {
                    bool isOwn = true;
                    for (const int c : chain) {
                        isOwn =
                            isOwn && map.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) == label;
                    }
                    if (isOwn) sum += chain.size() % 2 == 0 ? 1 : -1;
                }
            }
        }
    }
    return sum;
}

}  // namespace

Map noise(const ImageGeometry& geometry, int kinds, std::uint64_t seed) {
    return {geometry, [&](const Index3&) {
                return static_cast<Label>(nextRandom(seed) % static_cast<std::uint64_t>(kinds));
            }};
}

Map longCells(const ImageGeometry& geometry, std::uint64_t seed) {
    std::vector<Vec3> sites(60);
    for (Vec3& site : sites) {
        Vec3 index;
        for (int axis = 0; axis < 3; ++axis) {
            index[axis] = static_cast<double>(nextRandom(seed) %
                                              static_cast<std::uint64_t>(geometry.size[axis]));
        }
        site = geometry.toPhysical(index);
    }
    return Map::inSpace(geometry, [&](const Vec3& p) {
        const auto nearest = std::ranges::min_element(
            sites, {}, [&](const Vec3& site) { return squaredNorm(p - site); });
        return static_cast<Label>(nearest - sites.begin()) % 9;
    });
}

Map halfBalls(double radius) {
    const auto side = static_cast<std::int64_t>(2 * radius + 8);
    return Map::inSpace(centredGeometry({side, side, side}), [&](const Vec3& p) {
        return norm(p) >= radius ? 0 : p.x < 0 ? 1 : 2;
    });
}

LabelOptions fullResolution() {
    LabelOptions options;
    options.maxErrorMm = 0;
    return options;
}

::testing::AssertionResult keepsPromises(const Map& map, const LabelOptions& options) {
    const LabelComplex complex = extractLabels(map.view(), options).complex;
    TriangleMesh all;
    all.points = complex.points;
    all.triangles = complex.triangles;
    if (const SelfIntersections crossings = findSelfIntersections(all); crossings.pairCount != 0) {
        return ::testing::AssertionFailure() << crossings.pairCount << " pairs of triangles cross";
    }
    std::vector<Label> labels = options.labels.empty() ? findLabels(map.view()) : options.labels;
    std::ranges::sort(labels);
    const std::vector<RegionMeasure> measures = measureRegions(complex, labels);
    if (measures.size() != labels.size()) {
        return ::testing::AssertionFailure()
               << measures.size() << " of " << labels.size() << " regions are there";
    }
    for (const RegionMeasure& m : measures) {
        const TriangleMesh mesh = regionSurface(complex, m.label);
        if (const auto sound = isSound(mesh); !sound) {
            return ::testing::AssertionFailure() << "region " << m.label << ": " << sound.message();
        }
        if (!(m.volumeMm3 > 0)) {
            return ::testing::AssertionFailure() << "region " << m.label << " is inside out";
        }
        if (const auto own = 2 * solidEulerCharacteristic(map, m.label);
            own != m.eulerCharacteristic) {
            return ::testing::AssertionFailure()
                   << "region " << m.label << ": Euler characteristic " << m.eulerCharacteristic
                   << " instead of " << own;
        }
        const AabbTree tree(mesh);
        const InsideTest inside(mesh, tree);
        for (std::int64_t k = 0; k < map.geometry.size[2]; ++k) {
            for (std::int64_t j = 0; j < map.geometry.size[1]; ++j) {
                for (std::int64_t i = 0; i < map.geometry.size[0]; ++i) {
                    const Side own = map.at(i, j, k) == m.label ? Side::Inside : Side::Outside;
                    if (inside.sideOf(map.centre(i, j, k)) != own) {
                        return ::testing::AssertionFailure()
                               << "voxel " << i << ' ' << j << ' ' << k
                               << " is on the wrong side of region " << m.label;
                    }
                }
            }
        }
    }
    return ::testing::AssertionSuccess();
}

}  // namespace adaptiso::testing
