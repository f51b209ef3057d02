#include "SampleTypes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <type_traits>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {

namespace {

constexpr std::int64_t kPiece = std::int64_t{1} << 18;

}  // namespace

PixelType blendedType(PixelType stored) {
    const bool fits = bytesPerPixel(stored) <= 2 || stored == PixelType::Float32;
    return fits ? PixelType::Float32 : PixelType::Float64;
}

template <class F>
std::shared_ptr<const F> samplesAs(const VolumeView& volume) {
    return dispatchPixelType(
        volume, []<class T>(const TypedVolumeView<T>& view) -> std::shared_ptr<const F> {
            if constexpr (std::is_same_v<T, F>) {
                return {view.samples, [](const F*) {}};  // the caller's
            } else {
                const std::int64_t count = view.geometry.voxelCount();
                const std::shared_ptr<F> copy(new F[static_cast<std::size_t>(count)],
                                              std::default_delete<F[]>());
                parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
                    std::transform(view.samples + begin, view.samples + end, copy.get() + begin,
                                   [](T sample) { return static_cast<F>(sample); });
                });
                return copy;
            }
        });
}

template std::shared_ptr<const float> samplesAs(const VolumeView&);
template std::shared_ptr<const double> samplesAs(const VolumeView&);

void requireFinite(const VolumeView& volume) {
    dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        if constexpr (std::is_floating_point_v<T>) {
            std::atomic<std::int64_t> odd{0};
            parallelForPieces(
                view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
                    odd += std::count_if(view.samples + begin, view.samples + end,
                                         [](T sample) { return !std::isfinite(sample); });
                });
            if (odd == 0) return;
            throw InvalidInput(std::to_string(odd) +
                               " voxels hold no finite number (NaN or infinity), which blending "
                               "would spread; give them a value first");
        }
    });
}

namespace {

using Superbase = std::array<Index3, 4>;  // any three are a base of the lattice, the sum is zero

Vec3 toVec3(const Index3& step) {
    return {static_cast<double>(step[0]), static_cast<double>(step[1]),
            static_cast<double>(step[2])};
}

Index3 sum(const Index3& a, const Index3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Index3 crossProduct(const Index3& a, const Index3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The two of 0 ... 3 that are neither a nor b.
std::array<int, 2> others(int a, int b) {
    std::array<int, 2> rest{};
    int n = 0;
    for (int c = 0; c < 4; ++c) {
        if (c != a && c != b) rest[n++] = c;
    }
    return rest;
}

/// One step of Selling's algorithm: takes a pair with a positive product apart.
/// \return whether there was one
template <class Product>
bool reduce(Superbase& base, const Product& product, double tolerance) {
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            if (product(base[a], base[b]) <= tolerance) continue;
            const auto [c, d] = others(a, b);
            base[c] = sum(base[c], base[a]);
            base[d] = sum(base[d], base[a]);
            for (std::int64_t& component : base[a]) component = -component;
            return true;
        }
    }
    return false;
}

}  // namespace

std::vector<LatticeGaussian> latticeGaussians(const ImageGeometry& geometry, double sigmaMm) {
    constexpr double kNothing = 1e-6;
    // the product of a and b by C = sigma^2 M^-1 M^-T is that of sigma M^-T a and sigma M^-T b
    const Mat3 toMm = geometry.gradientToPhysical();
    const auto product = [&](const Index3& a, const Index3& b) {
        return sigmaMm * sigmaMm * dot(toMm * toVec3(a), toMm * toVec3(b));
    };
    Superbase base{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, -1, -1}}};
    double trace = 0;
    for (int axis = 0; axis < 3; ++axis) trace += product(base[axis], base[axis]);
    while (reduce(base, product, 1e-12 * trace)) continue;

    std::vector<LatticeGaussian> gaussians;
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            const double variance = -product(base[a], base[b]);
            if (variance < kNothing) continue;
            const auto [c, d] = others(a, b);
            gaussians.push_back({crossProduct(base[c], base[d]), variance});
        }
    }
    return gaussians;
}

std::vector<double> discreteGaussian(double variance) {
    constexpr double kVarianceBeyond = 1e-5;
    // e^-t I_n(t) is the mean of e^(t (cos x - 1)) cos(n x) around the circle. At N points the mean
    // adds the weights at n + N, n + 2 N, ...: nothing, 16 standard deviations away
    const int points = 32 + static_cast<int>(std::ceil(16 * std::sqrt(variance)));
    const auto weightAt = [&](int n) {
        double mean = 0;
        for (int point = 0; point < points; ++point) {
            const double x = 2 * std::numbers::pi * point / points;
            mean += portable::exp(variance * (portable::cos(x) - 1)) * portable::cos(n * x);
        }
        return mean / points;
    };
    std::vector<double> weights{weightAt(0)};
    double total = weights[0], left = variance;
    for (int n = 1; n < points / 2 && left > kVarianceBeyond * variance; ++n) {
        weights.push_back(weightAt(n));
        total += 2 * weights.back();
        left -= 2.0 * n * n * weights.back();
    }
    for (double& weight : weights) weight /= total;
    return weights;
}

}  // namespace adaptiso::detail
