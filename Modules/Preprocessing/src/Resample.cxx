#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <type_traits>
#include <vector>

#include "SampleTypes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {
namespace {

/// \throws InvalidInput when the result can't fit into memory, before anything is allocated
void requireMemory(const ImageGeometry& grid, std::size_t bytesPerSample, double stepMm) {
    double bytes = static_cast<double>(bytesPerSample);
    for (const std::int64_t extent : grid.size) bytes *= static_cast<double>(extent);
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes < memory) return;
    std::ostringstream message;
    message << "voxels of " << stepMm << " mm would be " << grid.size[0] << " x " << grid.size[1]
            << " x " << grid.size[2]
            << ", more than this machine's memory holds; take larger ones, or crop";
    throw InvalidInput(message.str());
}

/// The voxels of `grid` in lines along i, in parallel: a voxel's number, and where in the image it
/// lies. Along the axes of space in the order of ITK's images, whose numbers it gives to the bit.
/// \param  f  f(voxel, index in the image)
template <class F>
void forEachVoxel(const ImageGeometry& geometry, const ImageGeometry& grid, const F& f) {
    Mat3 directions;
    Vec3 perMm;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3& step = geometry.indexToPhysical.column[axis];
        const double length = norm(step);
        directions.column[axis] = {step.x / length, step.y / length, step.z / length};
        perMm[axis] = 1 / length;
    }
    const Mat3 toIndex = Mat3::diagonal(perMm.x, perMm.y, perMm.z) * inverse(directions);
    const std::int64_t length = grid.size[0];
    const auto placeOf = [&](std::int64_t i, std::int64_t line) {
        Vec3 point = grid.originMm;
        const Index3 index{i, line % grid.size[1], line / grid.size[1]};
        for (int axis = 0; axis < 3; ++axis) {
            point += static_cast<double>(index[axis]) * grid.indexToPhysical.column[axis];
        }
        return toIndex * (point - geometry.originMm);
    };
    parallelForPieces(grid.size[1] * grid.size[2], 16, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t line = begin; line < end; ++line) {
            const Vec3 first = placeOf(0, line), last = placeOf(length, line);
            for (std::int64_t i = 0; i < length; ++i) {
                const double part = static_cast<double>(i) / static_cast<double>(length);
                f(i + length * line, first + part * (last - first));
            }
        }
    });
}

/// Whether `place` lies in a voxel of the image, half a voxel around its outermost centres.
bool isInside(const Vec3& place, const Index3& size) {
    bool result = true;
    for (int axis = 0; axis < 3; ++axis) {
        result =
            result && place[axis] >= -0.5 && place[axis] < static_cast<double>(size[axis]) - 0.5;
    }
    return result;
}

/// Value around the image: its smallest; 0 for one of NaN alone.
template <class T>
T smallest(const T* samples, std::int64_t count) {
    T result = std::numeric_limits<T>::max();
    bool found = false;
    for (std::int64_t n = 0; n < count; ++n) {
        if (!(samples[n] <= result)) continue;
        result = samples[n];
        found = true;
    }
    return found ? result : T{};
}

template <class Word>
Volume nearest(const VolumeView& volume, const ImageGeometry& grid, Word outside) {
    const TypedVolumeView<Word> view{static_cast<const Word*>(volume.samples()), volume.geometry()};
    const auto samples = std::make_shared_for_overwrite<Word[]>(grid.voxelCount());
    forEachVoxel(view.geometry, grid, [&](std::int64_t voxel, const Vec3& place) {
        if (!isInside(place, view.geometry.size)) {
            samples[voxel] = outside;
            return;
        }
        Index3 index;
        for (int axis = 0; axis < 3; ++axis) {
            index[axis] = static_cast<std::int64_t>(place[axis]);
            if (place[axis] - static_cast<double>(index[axis]) >= 0.5) ++index[axis];
        }
        samples[voxel] = view.at(index[0], index[1], index[2]);
    });
    return Volume(VolumeView(samples.get(), volume.pixelType(), grid), samples);
}

/// Interpolates between the eight voxels around `place`. Beyond the border its values go on.
/// \pre isInside(place)
template <class F>
double linearAt(const F* samples, const Index3& size, const Vec3& place) {
    std::array<std::int64_t, 3> step{};  // from the lower voxel to the upper; 0 where one decides
    Vec3 part;
    std::int64_t lowest = 0, stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto below = static_cast<std::int64_t>(place[axis]);  // 0 before the first
        part[axis] = place[axis] - static_cast<double>(below);
        if (part[axis] > 0 && below + 1 < size[axis]) step[axis] = stride;
        lowest += below * stride;
        stride *= size[axis];
    }
    const auto along = [&](const auto& self, std::int64_t from, int axis) -> double {
        if (axis < 0) return static_cast<double>(samples[from]);
        const double a = self(self, from, axis - 1);
        if (step[axis] == 0) return a;
        return a + (self(self, from + step[axis], axis - 1) - a) * part[axis];
    };
    return along(along, lowest, 2);
}

/// First coefficient of `count` > 1 samples for the recursion by the pole z, mirrored at both ends.
template <class At>
double firstCoefficient(const At& at, std::int64_t count, double z) {
    constexpr std::int64_t kHorizon = 18;  // |z|^18 < 1e-10
    double sum = at(0), power = z;
    if (count > kHorizon) {
        for (std::int64_t n = 1; n < kHorizon; ++n, power *= z) sum += power * at(n);
        return sum;
    }
    long double product = 1;  // rounded once, so that every machine has the same power
    for (std::int64_t n = 1; n < count; ++n) product *= z;
    auto back = static_cast<double>(product);
    sum += back * at(count - 1);
    back *= back * (1 / z);
    for (std::int64_t n = 1; n < count - 1; ++n, power *= z, back *= 1 / z) {
        sum += (power + back) * at(n);
    }
    return sum / (1 - power * power);
}

/// Coefficients of the cubic B-splines through the samples, mirrored at the border [Unser1999].
template <class F>
std::vector<double> splineCoefficients(const F* samples, const Index3& size) {
    const double z = std::sqrt(3.0) - 2, gain = (1 - z) * (1 - 1 / z);
    std::vector<double> result(samples, samples + size[0] * size[1] * size[2]);
    std::int64_t stride = 1;
    for (const std::int64_t count : size) {
        const std::int64_t lines = count > 1 ? std::ssize(result) / count : 0;
        parallelForPieces(lines, 64, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t line = begin; line < end; ++line) {
                double* const first = &result[line / stride * stride * count + line % stride];
                const auto at = [&](std::int64_t n) -> double& { return first[n * stride]; };
                for (std::int64_t n = 0; n < count; ++n) at(n) *= gain;
                at(0) = firstCoefficient(at, count, z);
                for (std::int64_t n = 1; n < count; ++n) at(n) += z * at(n - 1);
                at(count - 1) = z / (z * z - 1) * (z * at(count - 2) + at(count - 1));
                for (std::int64_t n = count - 2; n >= 0; --n) at(n) = z * (at(n + 1) - at(n));
            }
        });
        stride *= count;
    }
    return result;
}

double splineAt(const std::vector<double>& coefficients, const Index3& size, const Vec3& place) {
    std::array<std::array<double, 4>, 3> weights;
    std::array<std::array<std::int64_t, 4>, 3> offsets;
    std::int64_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
        // in single precision, as ITK has it; a spline goes on smoothly beyond its piece
        const auto single = static_cast<float>(place[axis]);
        const std::int64_t below = static_cast<std::int64_t>(single) - (single < 0 ? 1 : 0);
        const double w = place[axis] - static_cast<double>(below);
        auto& weight = weights[axis];
        weight[3] = 1.0 / 6 * w * w * w;
        weight[0] = 1.0 / 6 + 0.5 * w * (w - 1) - weight[3];
        weight[2] = w + weight[0] - 2 * weight[3];
        weight[1] = 1 - weight[0] - weight[2] - weight[3];
        const std::int64_t last = size[axis] - 1;
        for (int n = 0; n < 4; ++n) {
            std::int64_t voxel = std::abs(below - 1 + n);
            if (voxel > last) voxel = last == 0 ? 0 : std::abs(2 * last - voxel);
            offsets[axis][n] = voxel * stride;
        }
        stride *= size[axis];
    }
    double result = 0;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 4; ++i) {
                result += weights[0][i] * weights[1][j] * weights[2][k] *
                          coefficients[offsets[0][i] + offsets[1][j] + offsets[2][k]];
            }
        }
    }
    return result;
}

template <class F>
Volume blend(const VolumeView& volume, const ImageGeometry& grid, Interpolation interpolation) {
    const ImageGeometry& geometry = volume.geometry();
    const std::shared_ptr<const F> stored = detail::samplesAs<F>(volume);
    std::vector<double> coefficients;
    if (interpolation == Interpolation::BSpline) {
        coefficients = splineCoefficients(stored.get(), geometry.size);
    }
    constexpr double kLeast = std::numeric_limits<F>::lowest();
    const F outside = smallest(stored.get(), geometry.voxelCount());
    const auto samples = std::make_shared_for_overwrite<F[]>(grid.voxelCount());
    forEachVoxel(geometry, grid, [&](std::int64_t voxel, const Vec3& place) {
        if (!isInside(place, geometry.size)) {
            samples[voxel] = outside;
            return;
        }
        const double value = interpolation == Interpolation::Linear
                                 ? linearAt(stored.get(), geometry.size, place)
                                 : splineAt(coefficients, geometry.size, place);
        samples[voxel] = static_cast<F>(std::clamp(value, kLeast, -kLeast));
    });
    return Volume(VolumeView(samples.get(), grid), samples);
}

}  // namespace

Volume resampleVolume(const VolumeView& volume, double stepMm, Interpolation interpolation) {
    const ImageGeometry grid = isotropicGrid(volume.geometry(), stepMm);
    if (interpolation == Interpolation::Nearest) {
        requireMemory(grid, bytesPerPixel(volume.pixelType()), stepMm);
        return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
            // samples are moved, not looked at: any type of their size will do
            using Word = std::conditional_t<
                sizeof(T) == 1, std::uint8_t,
                std::conditional_t<
                    sizeof(T) == 2, std::uint16_t,
                    std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
            return nearest(volume, grid,
                           std::bit_cast<Word>(smallest(view.samples, view.geometry.voxelCount())));
        });
    }
    detail::requireFinite(volume);
    requireMemory(grid, bytesPerPixel(detail::blendedType(volume.pixelType())), stepMm);
    return detail::withBlendedType(
        volume.pixelType(), [&]<class F>(F) { return blend<F>(volume, grid, interpolation); });
}

}  // namespace adaptiso
