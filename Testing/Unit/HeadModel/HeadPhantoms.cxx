#include "HeadPhantoms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Support/Soundness.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

template <class T, class Value>
std::vector<T> sampledAt(const ImageGeometry& geometry, const Value& value) {
    std::vector<T> samples;
    samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                samples.push_back(static_cast<T>(value(geometry.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}))));
            }
        }
    }
    return samples;
}

double partAt(const Shape& shape, const Vec3& p, double voxelMm) {
    return std::clamp(0.5 + shape.depthMm(p) / voxelMm, 0.0, 1.0);
}

double voxelSide(const ImageGeometry& geometry) {
    return std::cbrt(geometry.voxelVolumeMm3());
}

}  // namespace

HeadShapes sphericalHead(const Vec3& centreMm, double innerMm, double outerMm, double skinMm) {
    return {sphere(centreMm, innerMm), sphere(centreMm, outerMm), sphere(centreMm, skinMm)};
}

std::vector<std::uint8_t> headLabels(const HeadShapes& head, const ImageGeometry& geometry) {
    return sampledAt<std::uint8_t>(geometry, [&](const Vec3& p) {
        return head.innerSkull.depthMm(p) >= 0   ? 1
               : head.outerSkull.depthMm(p) >= 0 ? 2
               : head.skin.depthMm(p) >= 0       ? 3
                                                 : 0;
    });
}

std::vector<float> partInside(const Shape& shape, const ImageGeometry& geometry) {
    return sampledAt<float>(geometry,
                            [&](const Vec3& p) { return partAt(shape, p, voxelSide(geometry)); });
}

std::vector<float> headT1(const HeadShapes& head, double csfMm, const ImageGeometry& geometry) {
    const double voxel = voxelSide(geometry);
    return sampledAt<float>(geometry, [&](const Vec3& p) {
        const double skin = partAt(head.skin, p, voxel), bone = partAt(head.outerSkull, p, voxel);
        const double csf = partAt(head.innerSkull, p, voxel);
        const double brain =
            std::clamp(0.5 + (head.innerSkull.depthMm(p) - csfMm) / voxel, 0.0, 1.0);
        return 160 * (skin - bone) + 15 * (bone - csf) + 30 * (csf - brain) + 100 * brain;
    });
}

std::vector<float> headCt(const HeadShapes& head, const ImageGeometry& geometry) {
    const double voxel = voxelSide(geometry);
    return sampledAt<float>(geometry, [&](const Vec3& p) {
        const double skin = partAt(head.skin, p, voxel), bone = partAt(head.outerSkull, p, voxel);
        const double inner = partAt(head.innerSkull, p, voxel);
        return -1000 + 1040 * skin + 960 * (bone - inner);
    });
}

TriangleMesh surfaceOf(const FractionField& solid) {
    ExtractionOptions options;
    options.isovalue = kFractionIsovalue;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    return extractSurface(solid.view(), SpanSpaceIndex::build(solid.view(), {}), options).mesh;
}

SurfaceError surfaceError(const FractionField& solid, const Shape& shape) {
    const TriangleMesh mesh = surfaceOf(solid);
    expectSound(mesh);
    const TopologyReport topology = checkTopology(mesh);
    EXPECT_EQ(topology.components.size(), 1u);
    EXPECT_EQ(topology.genus(), 0);
    SurfaceError error;
    for (const Vec3& p : mesh.points) {
        const double outside = -shape.depthMm(p);
        error.largestMm = std::max(error.largestMm, std::abs(outside));
        error.meanMm += outside / static_cast<double>(mesh.points.size());
    }
    return error;
}

}  // namespace adaptiso::testing
