#include "SelfTestPhantoms.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

namespace adaptiso::selftest {
namespace {

constexpr double kPi = std::numbers::pi;

/// The next of a stream of random numbers [Steele2014, SplitMix64]: the same on every machine.
std::uint64_t nextRandom(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
}

/// Normally distributed as near as matters here, mean 0, deviation 1: twelve uniform numbers less
/// six, so that no library's logarithm has a say.
double nextNoise(std::uint64_t& state) {
    double sum = -6;
    for (int n = 0; n < 12; ++n) {
        sum += static_cast<double>(nextRandom(state) >> 11) * 0x1.0p-53;
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
double shareInside(const Solid& solid, const ImageGeometry& geometry, const Vec3& index) {
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

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh = a;
    const auto shift = std::ssize(a.points);
    mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.triangles) {
        mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
    return mesh;
}

/// The mesh and its image by reflection in its first point, which both share.
TriangleMesh touchingItselfAtAPoint(const TriangleMesh& mesh) {
    TriangleMesh other = mesh;
    for (Vec3& p : other.points) p = 2 * mesh.points.front() - p;
    flipOrientation(other);
    TriangleMesh both = together(mesh, other);
    const VertexId repeated = std::ssize(mesh.points);
    for (Triangle& t : both.triangles) {
        for (VertexId& v : t) {
            if (v == repeated) v = 0;
            if (v > repeated) --v;
        }
    }
    both.points.erase(both.points.begin() + repeated);
    return both;
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

Solid sphere(const Vec3& centreMm, double radiusMm) {
    Solid solid;
    solid.depthMm = [=](const Vec3& p) { return radiusMm - norm(p - centreMm); };
    solid.centreMm = centreMm;
    solid.volumeMm3 = 4 * kPi / 3 * radiusMm * radiusMm * radiusMm;
    solid.areaMm2 = 4 * kPi * radiusMm * radiusMm;
    solid.smallestRadiusMm = radiusMm;
    return solid;
}

Solid torus(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm) {
    Solid solid;
    solid.depthMm = [=](const Vec3& p) {
        const Vec3 q = p - centreMm;
        return minorRadiusMm - std::hypot(std::hypot(q.x, q.y) - majorRadiusMm, q.z);
    };
    solid.centreMm = centreMm;
    solid.volumeMm3 = 2 * kPi * kPi * majorRadiusMm * minorRadiusMm * minorRadiusMm;
    solid.areaMm2 = 4 * kPi * kPi * majorRadiusMm * minorRadiusMm;
    solid.smallestRadiusMm = std::min(minorRadiusMm, majorRadiusMm - minorRadiusMm);
    solid.genus = 1;
    return solid;
}

ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm, const Vec3& centreMm) {
    // turned by 30 degrees about z, then by 20 degrees about x
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    const double d = std::cos(kPi / 9), r = std::sin(kPi / 9);
    ImageGeometry geometry;
    geometry.size = size;
    geometry.indexToPhysical.column = {spacingMm.x * Vec3{c, s * d, s * r},
                                       spacingMm.y * Vec3{-s, c * d, c * r},
                                       spacingMm.z * Vec3{0, -r, d}};
    const Vec3 middle{0.5 * static_cast<double>(size[0] - 1),
                      0.5 * static_cast<double>(size[1] - 1),
                      0.5 * static_cast<double>(size[2] - 1)};
    geometry.originMm = centreMm - geometry.indexToPhysical * middle;
    return geometry;
}

Phantom distancePhantom(const Solid& solid, const ImageGeometry& geometry) {
    return sampled(geometry, [&](const Vec3& index) {
        return kSurface + kPerMm * solid.depthMm(geometry.toPhysical(index));
    });
}

Phantom bearingBalls(double diameterMm) {
    constexpr double kAirHu = -1000, kSteelHu = 3000, kNoiseHu = 20;
    constexpr double kVoxelMm = 0.5, kGapMm = 3;
    // not on the lattice: a quarter of a voxel beside it along every axis
    const double shift = 0.5 * (diameterMm + kGapMm);
    const std::array<Solid, 2> balls = {sphere({-shift + 0.12, 0.13, 0.11}, diameterMm / 2),
                                        sphere({shift + 0.12, 0.13, 0.11}, diameterMm / 2)};
    ImageGeometry geometry;
    const auto voxels = [](double mm) { return static_cast<std::int64_t>(mm / kVoxelMm) + 9; };
    geometry.size = {voxels(2 * diameterMm + kGapMm), voxels(diameterMm), voxels(diameterMm)};
    geometry.indexToPhysical = Mat3::diagonal(kVoxelMm, kVoxelMm, kVoxelMm);
    for (int axis = 0; axis < 3; ++axis) {
        geometry.originMm[axis] =
            -0.5 * kVoxelMm *
            static_cast<double>(geometry.size[static_cast<std::size_t>(axis)] - 1);
    }
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

TriangleMesh translated(TriangleMesh mesh, const Vec3& byMm) {
    for (Vec3& p : mesh.points) p += byMm;
    return mesh;
}

std::vector<PlantedDefect> plantDefects(const TriangleMesh& ball, const TriangleMesh& ring) {
    std::vector<PlantedDefect> planted;
    const auto plant = [&](const char* name, std::string_view key, const auto& change) {
        TriangleMesh mesh = ball;
        mesh.normals = {};
        change(mesh);
        planted.push_back({name, key, std::move(mesh)});
    };
    plant("a coordinate that is no number", "finiteCoordinates", [](TriangleMesh& mesh) {
        mesh.points.front().x = std::numeric_limits<double>::quiet_NaN();
    });
    plant("a vertex number beyond the last", "indicesInRange",
          [](TriangleMesh& mesh) { mesh.triangles.front()[0] = std::ssize(mesh.points) + 5; });
    plant("a triangle missing", "closed", [](TriangleMesh& mesh) { mesh.triangles.pop_back(); });
    plant("a fin on an edge", "manifoldEdges", [](TriangleMesh& mesh) {
        const Triangle t = mesh.triangles.front();
        mesh.points.push_back(mesh.points[t[0]] + Vec3{100, 0, 0});
        mesh.triangles.push_back({t[0], t[1], std::ssize(mesh.points) - 1});
    });
    plant("two balls touching at a vertex", "manifoldVertices",
          [](TriangleMesh& mesh) { mesh = touchingItselfAtAPoint(mesh); });
    plant("a triangle turned round", "consistentOrientation", [](TriangleMesh& mesh) {
        std::swap(mesh.triangles.front()[0], mesh.triangles.front()[1]);
    });
    plant("inside out", "outward", [](TriangleMesh& mesh) { flipOrientation(mesh); });
    plant("a second piece", "oneComponent", [](TriangleMesh& mesh) {
        mesh = together(mesh, translated(mesh, {100, 0, 0}));
    });
    plant("a handle", "genusZero", [&](TriangleMesh& mesh) { mesh = ring; });
    plant("a triangle without area", "noDegenerateTriangles", [](TriangleMesh& mesh) {
        const Triangle t = mesh.triangles.front();
        mesh.triangles.push_back({t[0], t[0], t[1]});
    });
    plant("a triangle twice", "noDuplicateTriangles",
          [](TriangleMesh& mesh) { mesh.triangles.push_back(mesh.triangles.front()); });
    plant("two vertices at one place", "noDuplicateVertices", [](TriangleMesh& mesh) {
        mesh.points.push_back(mesh.points[mesh.triangles.front()[0]]);
        mesh.triangles.front()[0] = std::ssize(mesh.points) - 1;
    });
    plant("a vertex of no triangle", "noUnusedVertices", [](TriangleMesh& mesh) {
        mesh.points.push_back({0, 0, 0});
    });
    plant("two balls that cross", "noSelfIntersections", [](TriangleMesh& mesh) {
        mesh = together(mesh, translated(mesh, {10, 0, 0}));
    });
    plant("slivers", "minAngle", [](TriangleMesh& mesh) { mesh = withSlivers(mesh); });
    plant("metres taken for millimetres", "plausibleSize", [](TriangleMesh& mesh) {
        for (Vec3& p : mesh.points) p = 0.001 * p;
    });
    return planted;
}

}  // namespace adaptiso::selftest
