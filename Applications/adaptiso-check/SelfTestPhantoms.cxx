#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "SelfTest.h"
#include "Support/Meshes.h"

namespace adaptiso::checker::selftest {
namespace {

/// Normally distributed as near as matters here, mean 0, deviation 1: twelve uniform numbers less
/// six, so that no library's logarithm has a say.
double nextNoise(std::uint64_t& state) {
    double sum = -6;
    for (int n = 0; n < 12; ++n) {
        sum += static_cast<double>(testing::nextRandom(state) >> 11) * 0x1.0p-53;
    }
    return sum;
}

std::int16_t rounded(double value) {
    using Limits = std::numeric_limits<std::int16_t>;
    return static_cast<std::int16_t>(
        std::clamp<double>(std::round(value), Limits::min(), Limits::max()));
}

template <class Value>
Phantom sampled(const ImageGeometry& geometry, Value&& value) {
    Phantom phantom{geometry, {}};
    phantom.samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                const Vec3 index{static_cast<double>(i), static_cast<double>(j),
                                 static_cast<double>(k)};
                phantom.samples.push_back(rounded(value(index)));
            }
        }
    }
    return phantom;
}

/// Share of the voxel at `index` that lies in the solid.
double shareInside(const testing::Shape& solid, const ImageGeometry& geometry, const Vec3& index) {
    constexpr int kSteps = 8;  // along each axis: steps of 0.06 mm
    const double halfDiagonalMm = 0.5 * norm(geometry.spacingMm());
    const double depthMm = solid.depthMm(geometry.toPhysical(index));
    if (std::abs(depthMm) > halfDiagonalMm) return depthMm > 0 ? 1 : 0;
    int inside = 0;
    for (int n = 0; n < kSteps * kSteps * kSteps; ++n) {
        const auto offset = [](int step) { return (step + 0.5) / kSteps - 0.5; };
        const Vec3 part{offset(n % kSteps), offset(n / kSteps % kSteps),
                        offset(n / (kSteps * kSteps))};
        if (solid.depthMm(geometry.toPhysical(index + part)) > 0) ++inside;
    }
    return static_cast<double>(inside) / (kSteps * kSteps * kSteps);
}

template <class T>
void put(std::string& header, std::size_t at, T value) {
    std::memcpy(header.data() + at, &value, sizeof value);
}

/// The first triangle cut in three from a point close to its first corner.
TriangleMesh withSlivers(TriangleMesh mesh) {
    const Triangle t = mesh.triangles.front();
    const Vec3 corner = mesh.points[t[0]];
    const VertexId added = std::ssize(mesh.points);
    mesh.points.push_back(corner +
                          0.001 * ((mesh.points[t[1]] - corner) + (mesh.points[t[2]] - corner)));
    mesh.triangles.front() = {added, t[1], t[2]};
    mesh.triangles.push_back({t[0], t[1], added});
    mesh.triangles.push_back({t[0], added, t[2]});
    return mesh;
}

}  // namespace

Solid ball(const Vec3& centreMm, double radiusMm) {
    return {testing::sphere(centreMm, radiusMm), centreMm, radiusMm};
}

Solid ring(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm) {
    return {testing::torus(centreMm, majorRadiusMm, minorRadiusMm), centreMm,
            std::min(minorRadiusMm, majorRadiusMm - minorRadiusMm)};
}

ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm, const Vec3& centreMm) {
    ImageGeometry geometry = testing::obliqueGeometry(size, spacingMm);
    geometry.originMm += centreMm;
    return geometry;
}

Phantom distancePhantom(const Solid& solid, const ImageGeometry& geometry) {
    return sampled(geometry, [&](const Vec3& index) {
        return kSurface + kPerMm * solid.shape.depthMm(geometry.toPhysical(index));
    });
}

Phantom bearingBalls(double diameterMm) {
    constexpr double kAirHu = -1000, kSteelHu = 3000, kNoiseHu = 20;
    constexpr double kVoxelMm = 0.5, kGapMm = 3;
    // not on the lattice: a quarter of a voxel beside it along every axis
    const double shift = 0.5 * (diameterMm + kGapMm);
    const std::array balls{testing::sphere({-shift + 0.12, 0.13, 0.11}, diameterMm / 2),
                           testing::sphere({shift + 0.12, 0.13, 0.11}, diameterMm / 2)};
    const auto voxels = [](double mm) { return static_cast<std::int64_t>(mm / kVoxelMm) + 9; };
    const ImageGeometry geometry = testing::centredGeometry(
        {voxels(2 * diameterMm + kGapMm), voxels(diameterMm), voxels(diameterMm)},
        {kVoxelMm, kVoxelMm, kVoxelMm});
    std::uint64_t state = 10;
    return sampled(geometry, [&](const Vec3& index) {
        const double share =
            shareInside(balls[0], geometry, index) + shareInside(balls[1], geometry, index);
        return kAirHu + (kSteelHu - kAirHu) * share + kNoiseHu * nextNoise(state);
    });
}

std::string niftiFile(const Phantom& phantom) {
    constexpr std::size_t kHeaderBytes = 352;
    const ImageGeometry& geometry = phantom.geometry;
    std::string file(kHeaderBytes, '\0');
    put(file, 0, std::int32_t{348});
    put(file, 40, std::int16_t{3});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(file, 42 + 2 * axis, static_cast<std::int16_t>(geometry.size[axis]));
        put(file, 80 + 4 * axis, static_cast<float>(geometry.spacingMm()[static_cast<int>(axis)]));
    }
    for (std::size_t n = 48; n < 56; n += 2) put(file, n, std::int16_t{1});
    put(file, 70, std::int16_t{4});  // signed 16 bits
    put(file, 72, std::int16_t{16});
    put(file, 76, 1.0F);
    put(file, 108, static_cast<float>(kHeaderBytes));
    put(file, 123, std::int8_t{2});   // mm
    put(file, 254, std::int16_t{1});  // the sform says where scanner space is
    for (int row = 0; row < 3; ++row) {
        const double turn = row < 2 ? -1 : 1;  // LPS -> RAS
        const auto at = static_cast<std::size_t>(280 + 16 * row);
        for (int column = 0; column < 3; ++column) {
            const Vec3& step = geometry.indexToPhysical.column[static_cast<std::size_t>(column)];
            put(file, at + 4 * static_cast<std::size_t>(column),
                static_cast<float>(turn * step[row]));
        }
        put(file, at + 12, static_cast<float>(turn * geometry.originMm[row]));
    }
    file.replace(344, 4, std::string("n+1\0", 4));
    file.append(reinterpret_cast<const char*>(phantom.samples.data()),
                phantom.samples.size() * sizeof(std::int16_t));
    return file;
}

std::vector<PlantedDefect> plantDefects(const TriangleMesh& ball, const TriangleMesh& ring) {
    std::vector<PlantedDefect> planted;
    TriangleMesh sound = ball;
    sound.normals = {};
    const auto plant = [&](const char* name, std::string_view key, const auto& make) {
        planted.push_back({name, key, make(sound)});
    };
    plant("a coordinate that is no number", "finiteCoordinates", testing::withNanCoordinate);
    plant("a vertex number beyond the last", "indicesInRange", testing::withIndexOutOfRange);
    plant("a triangle missing", "closed", testing::withHole);
    plant("a fin on an edge", "manifoldEdges", [](TriangleMesh mesh) {
        const Triangle t = mesh.triangles.front();
        mesh.points.push_back(mesh.points[t[0]] + Vec3{100, 0, 0});
        mesh.triangles.push_back({t[0], t[1], std::ssize(mesh.points) - 1});
        return mesh;
    });
    plant("two balls touching at a vertex", "manifoldVertices",
          [](const TriangleMesh&) { return testing::twoSpheresTouchingAtAVertex(); });
    plant("a triangle turned round", "consistentOrientation", testing::withFlippedTriangle);
    plant("inside out", "outward", [](TriangleMesh mesh) {
        flipOrientation(mesh);
        return mesh;
    });
    plant("a second piece", "oneComponent", [](const TriangleMesh& mesh) {
        return testing::merged({mesh, testing::translated(mesh, {100, 0, 0})});
    });
    plant("a handle", "genusZero", [&](const TriangleMesh&) { return ring; });
    plant("a triangle without area", "noDegenerateTriangles", testing::withRepeatedIndex);
    plant("a triangle twice", "noDuplicateTriangles", testing::withDuplicateTriangle);
    plant("two vertices at one place", "noDuplicateVertices", [](TriangleMesh mesh) {
        mesh.points.push_back(mesh.points[mesh.triangles.front()[0]]);
        mesh.triangles.front()[0] = std::ssize(mesh.points) - 1;
        return mesh;
    });
    plant("a vertex of no triangle", "noUnusedVertices", testing::withUnusedVertex);
    plant("two balls that cross", "noSelfIntersections",
          [](const TriangleMesh&) { return testing::crossingSpheres(2); });
    plant("slivers", "minAngle", withSlivers);
    plant("metres taken for millimetres", "plausibleSize", [](TriangleMesh mesh) {
        for (Vec3& p : mesh.points) p = 0.001 * p;
        return mesh;
    });
    return planted;
}

}  // namespace adaptiso::checker::selftest
