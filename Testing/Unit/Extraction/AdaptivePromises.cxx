#include "AdaptivePromises.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

/// Numbers drawn one after the other.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : state_(seed) {}

    std::int64_t below(std::int64_t limit) {
        return static_cast<std::int64_t>(nextRandom(state_) % static_cast<std::uint64_t>(limit));
    }
    double fraction() { return static_cast<double>(nextRandom(state_) >> 11) * 0x1p-53; }
    /// Evenly spread over the orders of magnitude.
    double between(double low, double high) { return low * std::pow(high / low, fraction()); }

private:
    std::uint64_t state_;
};

ImageGeometry drawGeometry(Dice& dice, int maximumSize) {
    ImageGeometry geometry;
    for (auto& extent : geometry.size) extent = 3 + dice.below(maximumSize - 2);
    Mat3& steps = geometry.indexToPhysical;
    switch (dice.below(8)) {
        case 0:
            steps = {{{{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 3}}}};  // slabs
            break;
        case 1:
            steps = {{{{-0.8, 0.1, 0}, {0.2, 1.1, 0.1}, {0.1, -0.2, 1.6}}}};  // sheared, mirrored
            break;
        case 2:
            steps = {{{{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 2e-3}}}};  // microns
            break;
        case 3:
            steps = {{{{1e3, 0, 0}, {0, 8e2, 0}, {0, 0, 1e3}}}};  // metres
            break;
        case 4:
            geometry.originMm = {-412.7, 310.1, 1893.3};
            steps = {{{{0, 0.9, 0.2}, {0.9, 0, 0}, {0, 0.2, -0.9}}}};
            break;
        default:
            break;
    }
    return geometry;
}

float drawNearZero(Dice& dice) {
    switch (dice.below(12)) {
        case 0:
            return 0;
        case 1:
            return std::nextafter(0.0f, dice.below(2) == 0 ? -1.0f : 1.0f);
        case 2:
            return dice.below(2) == 0 ? 1e-7f : -1e-7f;
        case 3:
            return dice.below(2) == 0 ? 1e30f : -1e30f;
        case 4:
            return dice.below(4) == 0 ? std::numeric_limits<float>::quiet_NaN() : -1;
        default:
            return static_cast<float>(2 * dice.fraction() - 1);
    }
}

Volume drawFloats(Dice& dice, const ImageGeometry& geometry) {
    const bool isSmooth = dice.below(2) == 0;
    const double turn[3] = {dice.between(0.3, 2), dice.between(0.3, 2), dice.between(0.3, 2)};
    std::vector<float> samples;
    for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
        for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
            for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                const double x = turn[0] * static_cast<double>(i),
                             y = turn[1] * static_cast<double>(j),
                             z = turn[2] * static_cast<double>(k);
                const double wave = std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) +
                                    std::sin(z) * std::cos(x);
                samples.push_back(isSmooth ? static_cast<float>(wave) : drawNearZero(dice));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

Volume withGeometry(const Volume& bytes, const ImageGeometry& geometry) {
    const auto view = bytes.view().as<std::uint8_t>();
    ImageGeometry placed = geometry;
    placed.size = view.geometry.size;
    return Volume::fromSamples(
        std::vector<std::uint8_t>(view.samples, view.samples + placed.voxelCount()), placed);
}

double narrowestSpacingMm(const ImageGeometry& geometry) {
    const Vec3 spacing = geometry.spacingMm();
    return std::min({spacing.x, spacing.y, spacing.z});
}

AdaptiveOptions drawOptions(Dice& dice, double voxelMm) {
    AdaptiveOptions options;
    if (dice.below(4) != 0) options.maxErrorMm = voxelMm * dice.between(0.003, 3);
    if (dice.below(4) == 0) options.maxTriangles = dice.below(400);
    if (dice.below(6) == 0) options.reduction = dice.fraction();
    if (dice.below(4) == 0) options.minAngleDeg = 40 * dice.fraction();
    return options;
}

double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 side = b - a;
    const double length2 = dot(side, side);
    const double along = length2 > 0 ? std::clamp(dot(p - a, side) / length2, 0.0, 1.0) : 0.0;
    return norm(p - (a + along * side));
}

/// By projection; not the routine of Core, which the method uses.
double distanceToTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const bool isOver = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                        dot(cross(a - c, p - c), n) >= 0;
    if (isOver && norm(n) > 0) return std::abs(dot(p - a, n)) / norm(n);
    return std::min(
        {distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
}

/// Calls f(point) for a lattice of points on every triangle, no more than `stepMm` apart.
template <class F>
void forEachSample(const TriangleMesh& mesh, double stepMm, const F& f) {
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
        // even, so that the middles of edges are among them
        const int steps = 2 * std::clamp(static_cast<int>(std::ceil(longest / stepMm / 2)), 1, 12);
        for (int u = 0; u <= steps; ++u) {
            for (int v = 0; v <= steps - u; ++v) {
                f(a + (1.0 * u / steps) * (b - a) + (1.0 * v / steps) * (c - a));
            }
        }
    }
}

/// The triangles of a mesh, to ask how far a point is from the nearest: all are looked at.
class Triangles {
public:
    explicit Triangles(const TriangleMesh& mesh) {
        for (const Triangle& t : mesh.triangles) {
            const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
            const Vec3 middle = (1.0 / 3) * (a + b + c);
            triangles_.push_back(
                {a, b, c, middle,
                 std::max({norm(a - middle), norm(b - middle), norm(c - middle)})});
        }
    }

    /// The distance from `p` to the nearest triangle, or of any that is within `enough`.
    double distanceTo(const Vec3& p, double enough) {
        double least = distance(p, triangles_[last_]);
        for (std::size_t n = 0; n < triangles_.size() && !(least <= enough); ++n) {
            const Ball& ball = triangles_[n];
            const double reach = least + ball.radius;
            if (squaredNorm(p - ball.middle) > reach * reach) continue;
            const double d = distance(p, ball);
            if (d < least) {
                least = d;
                last_ = n;
            }
        }
        return least;
    }

private:
    struct Ball {
        Vec3 a, b, c, middle;
        double radius;
    };
    static double distance(const Vec3& p, const Ball& t) {
        return distanceToTriangle(p, t.a, t.b, t.c);
    }

    std::vector<Ball> triangles_;
    std::size_t last_ = 0;  // of the point before: mostly near this one too
};

/// The farthest sample of `from` that lies beyond `boundMm` of `to`, mm; 0 where none does.
double farthestBeyond(const TriangleMesh& from, const TriangleMesh& to, double boundMm,
                      double stepMm) {
    Triangles triangles(to);
    double farthest = 0;
    forEachSample(from, stepMm, [&](const Vec3& p) {
        const double distance = triangles.distanceTo(p, boundMm);
        if (!(distance <= boundMm)) farthest = std::max(farthest, distance);
    });
    return farthest;
}

::testing::AssertionResult hasTopologyOf(const TriangleMesh& ours, const TriangleMesh& full) {
    const TopologyReport a = checkTopology(ours), b = checkTopology(full);
    if (a.components.size() == b.components.size() &&
        a.eulerCharacteristic() == b.eulerCharacteristic()) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure()
           << "topology: " << a.components.size() << " components, Euler characteristic "
           << a.eulerCharacteristic() << "; mc " << b.components.size() << ", "
           << b.eulerCharacteristic();
}

::testing::AssertionResult isWithinItsBound(const Extraction& ours, const TriangleMesh& full,
                                            const AdaptiveCase& adaptive) {
    if (!ours.statistics.errorBoundMm) return ::testing::AssertionFailure() << "no bound reported";
    const double boundMm = *ours.statistics.errorBoundMm;
    if (adaptive.options.maxErrorMm && !(boundMm <= *adaptive.options.maxErrorMm)) {
        return ::testing::AssertionFailure() << "reports a bound of " << boundMm << " mm";
    }
    const ImageGeometry& geometry = adaptive.volume.view().geometry();
    const double voxelMm = narrowestSpacingMm(geometry);
    // rounding alone: points are doubles near the origin's size
    const double slackMm = 1e-6 * voxelMm + 1e-12 * norm(geometry.originMm);
    for (const bool isOurs : {true, false}) {
        const double beyond = farthestBeyond(isOurs ? ours.mesh : full, isOurs ? full : ours.mesh,
                                             boundMm + slackMm, voxelMm / 8);
        if (beyond > 0) {
            return ::testing::AssertionFailure()
                   << (isOurs ? "mesh to mc" : "mc to mesh") << ": a point lies " << beyond
                   << " mm off, the bound is " << boundMm << " mm";
        }
    }
    return ::testing::AssertionSuccess();
}

}  // namespace

AdaptiveCase adaptiveCase(std::uint64_t seed, int maximumSize) {
    Dice dice(seed);
    const ImageGeometry geometry = drawGeometry(dice, maximumSize);
    const bool isBytes = dice.below(2) == 0;
    const HardVolume hard = hardVolume(seed, maximumSize);
    return {isBytes ? withGeometry(hard.volume, geometry) : drawFloats(dice, geometry),
            isBytes ? hard.isovalue : 0.0, 2 << dice.below(4),
            dice.below(2) == 0 ? Border::Closed : Border::Open,
            drawOptions(dice, narrowestSpacingMm(geometry))};
}

std::string describe(std::uint64_t seed, const AdaptiveCase& adaptive) {
    const VolumeView& volume = adaptive.volume;
    const Index3& size = volume.geometry().size;
    std::ostringstream text;
    text.precision(17);
    text << "seed " << seed << ": " << size[0] << " x " << size[1] << " x " << size[2] << ' '
         << toString(volume.pixelType()) << ", isovalue " << adaptive.isovalue
         << ", N = " << adaptive.blockSize
         << (adaptive.border == Border::Closed ? ", closed" : ", open");
    const AdaptiveOptions& options = adaptive.options;
    if (options.maxErrorMm) text << ", maxErrorMm " << *options.maxErrorMm;
    if (options.maxTriangles) text << ", maxTriangles " << *options.maxTriangles;
    if (options.reduction) text << ", reduction " << *options.reduction;
    if (options.minAngleDeg > 0) text << ", minAngleDeg " << options.minAngleDeg;
    return text.str();
}

::testing::AssertionResult keepsAdaptivePromises(const AdaptiveCase& adaptive,
                                                 const CrossingReferee& referee) {
    const VolumeView& volume = adaptive.volume;
    const SpanSpaceIndex index =
        SpanSpaceIndex::build(volume, {adaptive.blockSize, adaptive.border});
    ExtractionOptions options;
    options.isovalue = adaptive.isovalue;
    options.method = Method::MarchingCubes;
    const Extraction full = extractSurface(volume, index, options);
    options.method = Method::Adaptive;
    options.adaptive = adaptive.options;
    Extraction ours;
    try {
        ours = extractSurface(volume, index, options);
    } catch (const InternalError& error) {
        return ::testing::AssertionFailure() << error.what();
    }
    if (full.mesh.triangles.empty() || ours.mesh.triangles.empty()) {
        if (full.mesh.triangles.empty() == ours.mesh.triangles.empty()) {
            return ::testing::AssertionSuccess();
        }
        return ::testing::AssertionFailure() << "only one of ours and mc has triangles";
    }
    SoundnessOptions soundness;
    if (adaptive.border == Border::Open) soundness = openOnlyAtBorder(volume.geometry());
    soundness.nesting = nestingOf(full.mesh);
    if (const auto sound = isSound(ours.mesh, soundness); !sound) return sound;
    if (const auto same = hasTopologyOf(ours.mesh, full.mesh); !same) return same;
    if (const auto pairs = findSelfIntersections(ours.mesh).pairCount; pairs != 0) {
        return ::testing::AssertionFailure() << pairs << " pairs of triangles cross";
    }
    if (referee && referee(ours.mesh)) {
        return ::testing::AssertionFailure() << "the referee finds triangles that cross";
    }
    return isWithinItsBound(ours, full.mesh, adaptive);
}

}  // namespace adaptiso::testing
