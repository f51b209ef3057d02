
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <type_traits>
#include <vector>

#include "RecursiveGaussian.h"
#include "SampleTypes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {
namespace {

void requireUsableSigma(const ImageGeometry& geometry, double sigmaMm) {
    const Vec3 spacing = geometry.spacingMm();
    double shortestMm = static_cast<double>(geometry.size[0]) * spacing[0];
    for (int axis = 1; axis < 3; ++axis) {
        shortestMm = std::min(shortestMm, static_cast<double>(geometry.size[axis]) * spacing[axis]);
    }
    if (sigmaMm > 0 && sigmaMm <= shortestMm / 4) return;
    std::ostringstream message;
    message << "a standard deviation of " << sigmaMm
            << " mm must be more than 0 and at most a quarter of the image's shortest side, "
            << shortestMm << " mm";
    throw InvalidInput(message.str());
}

std::int64_t clampedTo(std::int64_t size, std::int64_t index) {
    return std::clamp<std::int64_t>(index, 0, size - 1);
}

/// `from` convolved along the lines of one Gaussian; samples beyond the border are those at it.
template <class F>
void convolve(const F* from, F* to, const Index3& size, const detail::LatticeGaussian& gaussian) {
    const std::vector<double> weights = detail::discreteGaussian(gaussian.variance);
    const auto reach = static_cast<std::int64_t>(weights.size()) - 1;
    const Index3& step = gaussian.step;
    // products are added in the order of the samples in memory: a sum depends on its order
    const Index3 upwards{step[2], step[1], step[0]};
    const std::int64_t sign = upwards < Index3{0, 0, 0} ? -1 : 1;
    parallelForPieces(size[1] * size[2], 16, [&](std::int64_t begin, std::int64_t end) {
        std::vector<double> sums(static_cast<std::size_t>(size[0]));
        for (std::int64_t line = begin; line < end; ++line) {
            const std::int64_t j = line % size[1], k = line / size[1];
            std::fill(sums.begin(), sums.end(), 0.0);
            for (std::int64_t m = -reach; m <= reach; ++m) {
                const std::int64_t n = sign * m;
                const double weight = weights[static_cast<std::size_t>(std::abs(n))];
                const F* const row =
                    from + size[0] * (clampedTo(size[1], j + n * step[1]) +
                                      size[1] * clampedTo(size[2], k + n * step[2]));
                const std::int64_t shift = n * step[0];
                for (std::int64_t i = 0; i < size[0]; ++i) {
                    sums[i] += weight * static_cast<double>(row[clampedTo(size[0], i + shift)]);
                }
            }
            std::transform(sums.begin(), sums.end(), to + size[0] * line,
                           [](double sum) { return static_cast<F>(sum); });
        }
    });
}

template <class F>
Volume smoothAs(const VolumeView& volume, const std::vector<detail::LatticeGaussian>& gaussians) {
    const ImageGeometry& geometry = volume.geometry();
    std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
    for (const detail::LatticeGaussian& gaussian : gaussians) {
        const std::shared_ptr<F> smoothed(new F[static_cast<std::size_t>(geometry.voxelCount())],
                                          std::default_delete<F[]>());
        convolve(samples.get(), smoothed.get(), geometry.size, gaussian);
        samples = smoothed;
    }
    return Volume(VolumeView(samples.get(), geometry), samples);
}

void requireRightAngles(const ImageGeometry& geometry, double sigmaMm) {
    std::ostringstream message;
    if (!(sigmaMm > 0)) message << "a standard deviation of " << sigmaMm << " mm must be above 0";
    const auto& axes = geometry.indexToPhysical.column;
    for (int a = 0; a < 3; ++a) {
        const Vec3 &one = axes[a], &other = axes[(a + 1) % 3];
        if (std::abs(dot(one, other)) > 1e-3 * norm(one) * norm(other)) {
            message << "axes must be at right angles";
        }
        if (geometry.size[a] < 4) message << "4 voxels or more are needed along every axis";
    }
    if (!message.str().empty()) throw InvalidInput("smoothVolumeRecursively: " + message.str());
}

template <class F>
Volume smoothRecursivelyAs(const VolumeView& volume, double sigmaMm) {
    const ImageGeometry& geometry = volume.geometry();
    const std::shared_ptr<const F> samples = detail::samplesAs<F>(volume);
    const std::size_t count = static_cast<std::size_t>(geometry.voxelCount());
    const std::shared_ptr<float> smoothed(new float[count], std::default_delete<float[]>());
    detail::smoothLines(samples.get(), smoothed.get(), geometry, 2, sigmaMm);
    for (const int axis : {0, 1}) {
        detail::smoothLines(smoothed.get(), smoothed.get(), geometry, axis, sigmaMm);
    }
    if constexpr (std::is_same_v<F, float>) {
        return Volume(VolumeView(smoothed.get(), geometry), smoothed);
    } else {
        const std::shared_ptr<F> wide(new F[count], std::default_delete<F[]>());
        std::copy_n(smoothed.get(), count, wide.get());
        return Volume(VolumeView(wide.get(), geometry), wide);
    }
}

}  // namespace

Volume smoothVolume(const VolumeView& volume, double sigmaMm) {
    requireUsableSigma(volume.geometry(), sigmaMm);
    detail::requireFinite(volume);
    auto gaussians = detail::latticeGaussians(volume.geometry(), sigmaMm);
    if (gaussians.empty()) gaussians.push_back({{1, 0, 0}, 0});  // too narrow to show: a copy
    return detail::withBlendedType(volume.pixelType(),
                                   [&]<class F>(F) { return smoothAs<F>(volume, gaussians); });
}

Volume smoothVolumeRecursively(const VolumeView& volume, double sigmaMm) {
    requireRightAngles(volume.geometry(), sigmaMm);
    detail::requireFinite(volume);
    return detail::withBlendedType(
        volume.pixelType(), [&]<class F>(F) { return smoothRecursivelyAs<F>(volume, sigmaMm); });
}

}  // namespace adaptiso
