#include "SmoothShapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::testing {
namespace {

double uniform(std::uint64_t& state, double low, double high) {
    return low + (high - low) * static_cast<double>(nextRandom(state) >> 11) * 0x1p-53;
}

Vec3 randomDirection(std::uint64_t& state) {
    const double z = uniform(state, -1, 1), turn = uniform(state, 0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

Volume sampled(const Implicit& shape, double halfSizeMm, double voxelMm, bool isBinary) {
    const auto count = static_cast<std::int64_t>(2 * halfSizeMm / voxelMm) + 1;
    const ImageGeometry geometry =
        centredGeometry({count, count, count}, {voxelMm, voxelMm, voxelMm});
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t k = 0; k < count; ++k) {
        for (std::int64_t j = 0; j < count; ++j) {
            for (std::int64_t i = 0; i < count; ++i) {
                const double value = shape(geometry.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
                samples.push_back(isBinary ? (value >= 0 ? 0.5F : -0.5F)
                                           : static_cast<float>(value));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace

Implicit ellipsoid(const Vec3& c, const Vec3& r) {
    return [=](const Vec3& p) {
        const Vec3 d = p - c;
        const double k0 = norm({d.x / r.x, d.y / r.y, d.z / r.z});
        const double k1 = norm({d.x / (r.x * r.x), d.y / (r.y * r.y), d.z / (r.z * r.z)});
        return k1 > 0 ? k0 * (1 - k0) / k1 : std::min({r.x, r.y, r.z});
    };
}

Implicit blended(Implicit a, Implicit b, double blendMm) {
    return [=, a = std::move(a), b = std::move(b)](const Vec3& p) {
        const double x = a(p), y = b(p);
        const double h = std::max(blendMm - std::abs(x - y), 0.0) / blendMm;
        return std::max(x, y) + h * h * blendMm / 4;
    };
}

Implicit headWithEars() {
    Implicit head = ellipsoid({0, 0, 15}, {72, 92, 85});
    head = blended(head, ellipsoid({0, -50, -50}, {45, 45, 45}), 25);  // jaw
    head = blended(head, ellipsoid({0, -88, -80}, {18, 16, 14}), 10);  // chin
    head = blended(head, ellipsoid({0, 25, -110}, {52, 55, 90}), 20);  // neck, cut by the box
    head = blended(head, ellipsoid({0, -98, -15}, {11, 20, 22}), 8);   // nose
    for (const double side : {-1.0, 1.0}) {
        // A flap that leans backwards, away from the head.
        const Implicit flap = ellipsoid({0, 0, 0}, {2.5, 18, 30});
        head = blended(
            head,
            [=](const Vec3& p) {
                const Vec3 q = p - Vec3{side * 76, 12, 0};
                const double c = std::cos(0.5), s = side * std::sin(0.5);
                return flap({c * q.x - s * q.y, s * q.x + c * q.y, q.z});
            },
            4);
    }
    return head;
}

Implicit randomStar(std::uint64_t seed) {
    std::vector<std::pair<Vec3, double>> waves;
    for (int n = 0; n < 8; ++n) {
        const Vec3 direction = randomDirection(seed);
        waves.emplace_back(uniform(seed, 1, 3) * direction, uniform(seed, 0, 6));
    }
    return [=](const Vec3& p) {
        double radius = 60;
        const Vec3 u = normalized(p);
        for (const auto& [k, phase] : waves) radius += 2.5 * std::cos(2 * dot(k, u) + phase);
        return radius - norm(p);
    };
}

Implicit randomWorm(std::uint64_t seed) {
    struct Ball {
        Vec3 centre;
        double radius;
    };
    constexpr int kBalls = 40;
    const double turn = uniform(seed, 0.04, 0.09), rise = uniform(seed, 0.2, 0.6),
                 phase = uniform(seed, 0, 6);
    std::vector<Ball> balls;
    Vec3 at{0, 0, 0};
    for (int n = 0; n < kBalls; ++n) {
        balls.push_back({at, 8.5 + 1.5 * std::sin(0.5 * n + phase)});
        at += 3.75 * normalized({std::cos(turn * n), std::sin(turn * n), rise});
    }
    const Vec3 middle = balls[kBalls / 2].centre;
    return [=](const Vec3& p) {
        double best = -1e9;
        for (const Ball& ball : balls) {
            const double depth = ball.radius - norm(p + middle - ball.centre);
            const double h = std::max(4 - std::abs(best - depth), 0.0) / 4;
            best = std::max(best, depth) + h * h;
        }
        return best;
    };
}

TriangleMesh denseSurface(const VolumeView& volume, double isovalue) {
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    const TriangleMesh all =
        extractSurface(volume, SpanSpaceIndex::build(volume, {}), options).mesh;
    ComponentSelection selection;
    selection.largestOnly = true;
    selection.fillCavities = true;
    return selectComponents(all, selection);
}

TriangleMesh denseSurface(const Implicit& shape, double halfSizeMm, double voxelMm) {
    return denseSurface(sampled(shape, halfSizeMm, voxelMm, false), 0);
}

TriangleMesh binarySurface(const Implicit& shape, double halfSizeMm, double voxelMm) {
    return denseSurface(sampled(shape, halfSizeMm, voxelMm, true), 0);
}

}  // namespace adaptiso::testing
