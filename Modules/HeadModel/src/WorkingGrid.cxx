#include "WorkingGrid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "FinishBoundaries.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {
namespace {

constexpr double kLeastOwnStepMm = 0.7;
constexpr double kMostOwnStepMm = 1.5;
constexpr double kUsualStepMm = 1;

template <class Convert>
FloatImage converted(const VolumeView& volume, const Convert& convert) {
    FloatImage image{volume.geometry(), {}};
    image.values.resize(static_cast<std::size_t>(volume.geometry().voxelCount()));
    dispatchPixelType(volume, [&](const auto& view) {
        parallelForPieces(view.geometry.voxelCount(), 1 << 18,
                          [&](std::int64_t begin, std::int64_t end) {
                              for (std::int64_t n = begin; n < end; ++n) {
                                  image.values[n] = convert(static_cast<double>(view.samples[n]));
                              }
                          });
    });
    return image;
}

Vec3 toVec(const Index3& index) {
    return {static_cast<double>(index[0]), static_cast<double>(index[1]),
            static_cast<double>(index[2])};
}

/// The image's axes made orthonormal, the first kept.
Mat3 rightAngled(const Mat3& axes) {
    const Vec3 x = normalized(axes.column[0]);
    const Vec3 y = normalized(axes.column[1] - dot(axes.column[1], x) * x);
    Vec3 z = cross(x, y);
    if (dot(z, axes.column[2]) < 0) z = -z;
    return {{{x, y, z}}};
}

bool hasCubicVoxels(const ImageGeometry& image, double stepMm) {
    const Vec3 spacing = image.spacingMm();
    const auto& axes = image.indexToPhysical.column;
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3;
        if (std::abs(spacing[a] / spacing[b] - 1) > 0.01) return false;
        if (std::abs(dot(axes[a], axes[b])) > 1e-4 * spacing[a] * spacing[b]) return false;
    }
    if (stepMm > 0) return std::abs(spacing.x / stepMm - 1) <= 0.01;
    return spacing.x >= kLeastOwnStepMm && spacing.x <= kMostOwnStepMm;
}

/// The trilinear value at a continuous index, which is taken to the nearest sample's plane beyond
/// the samples.
double valueAt(const FloatImage& image, const Vec3& index) {
    const Index3& size = image.geometry.size;
    std::array<std::int64_t, 3> low, high;
    std::array<double, 3> weight;
    for (int a = 0; a < 3; ++a) {
        const double at = std::clamp(index[a], 0.0, static_cast<double>(size[a] - 1));
        low[a] = static_cast<std::int64_t>(at);
        high[a] = std::min(low[a] + 1, size[a] - 1);
        weight[a] = at - static_cast<double>(low[a]);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double w = 1;
        std::array<std::int64_t, 3> at;
        for (int a = 0; a < 3; ++a) {
            const bool isHigh = (corner >> a & 1) != 0;
            w *= isHigh ? weight[a] : 1 - weight[a];
            at[a] = isHigh ? high[a] : low[a];
        }
        if (w > 0) sum += w * image.values[at[0] + size[0] * (at[1] + size[1] * at[2])];
    }
    return sum;
}

/// Half a voxel beyond the samples and no more; rounding of oblique axes forgiven.
bool reaches(const Vec3& index, const Index3& size) {
    constexpr double kRounding = 1e-6;
    for (int a = 0; a < 3; ++a) {
        if (index[a] < -0.5 - kRounding) return false;
        if (index[a] > static_cast<double>(size[a]) - 0.5 + kRounding) return false;
    }
    return true;
}

}  // namespace

FloatImage toFloat(const VolumeView& volume, float nan) {
    return converted(
        volume, [=](double value) { return std::isnan(value) ? nan : static_cast<float>(value); });
}

FloatImage indicator(const VolumeView& volume, const std::function<bool(double)>& isInside) {
    return converted(volume, [&](double value) { return isInside(value) ? 1.0f : 0.0f; });
}

bool boundingIndices(const std::vector<float>& values, const Index3& size, double threshold,
                     Index3& first, Index3& last) {
    first = size;
    last = {-1, -1, -1};
    std::size_t n = 0;
    for (std::int64_t k = 0; k < size[2]; ++k) {
        for (std::int64_t j = 0; j < size[1]; ++j) {
            for (std::int64_t i = 0; i < size[0]; ++i) {
                if (!(values[n++] >= threshold)) continue;
                const Index3 at{i, j, k};
                for (int a = 0; a < 3; ++a) {
                    first[a] = std::min(first[a], at[a]);
                    last[a] = std::max(last[a], at[a]);
                }
            }
        }
    }
    return last[0] >= 0;
}

ImageGeometry workingGrid(const ImageGeometry& image, const Index3& first, const Index3& last,
                          double stepMm, double marginMm) {
    if (!(stepMm >= 0)) throw InvalidInput("the step is negative, must be >= 0 mm");
    const bool isOwn = hasCubicVoxels(image, stepMm);
    const double step = isOwn ? image.spacingMm().x : stepMm > 0 ? stepMm : kUsualStepMm;
    ImageGeometry grid;
    Mat3 axes = rightAngled(image.indexToPhysical);
    for (Vec3& axis : axes.column) axis = step * axis;
    grid.indexToPhysical = isOwn ? image.indexToPhysical : axes;

    // the corners of the box, in steps of the grid from the first corner
    const Mat3 toGrid = inverse(grid.indexToPhysical);
    const Vec3 corner = image.toPhysical(toVec(first));
    Vec3 low{}, high{};
    for (int n = 0; n < 8; ++n) {
        Index3 at;
        for (int a = 0; a < 3; ++a) at[a] = (n >> a & 1) != 0 ? last[a] : first[a];
        const Vec3 index = toGrid * (image.toPhysical(toVec(at)) - corner);
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], index[a]);
            high[a] = std::max(high[a], index[a]);
        }
    }
    // what the last samples stand for reaches half a voxel of the image further
    constexpr double kRounding = 1e-6;
    const Vec3 spacing = image.spacingMm();
    const double room = (marginMm + std::max({spacing.x, spacing.y, spacing.z}) / 2) / step;
    Vec3 start;
    double voxels = 1;
    for (int a = 0; a < 3; ++a) {
        start[a] = std::floor(low[a] - room + kRounding);
        grid.size[a] =
            static_cast<std::int64_t>(std::ceil(high[a] + room - kRounding) - start[a]) + 1;
        voxels *= static_cast<double>(grid.size[a]);
    }
    if (voxels > static_cast<double>(1 << 29)) {
        throw InvalidInput("voxels of " + shortNumber(step) + " mm: the head would take " +
                           std::to_string(std::llround(voxels / 1e6)) +
                           " million of them, at most 536 million can be; they must be larger");
    }
    grid.originMm = corner + grid.indexToPhysical * start;
    return grid;
}

std::vector<float> resampled(const FloatImage& image, const ImageGeometry& grid, float outside) {
    const Vec3 spacing = image.geometry.spacingMm();
    const double finest = std::min({spacing.x, spacing.y, spacing.z});
    const int points = std::clamp(static_cast<int>(std::ceil(stepMm(grid) / finest - 0.01)), 1, 4);
    const Mat3 toImage = inverse(image.geometry.indexToPhysical);
    const Mat3 perStep = toImage * grid.indexToPhysical;
    const Vec3 origin = toImage * (grid.originMm - image.geometry.originMm);

    std::vector<float> result(static_cast<std::size_t>(grid.voxelCount()));
    const auto meanAround = [&](const Vec3& voxel) {
        double sum = 0;
        for (int n = 0; n < points * points * points; ++n) {
            const Vec3 offset{(n % points + 0.5) / points - 0.5,
                              (n / points % points + 0.5) / points - 0.5,
                              (n / (points * points) + 0.5) / points - 0.5};
            const Vec3 index = origin + perStep * (voxel + offset);
            sum += reaches(index, image.geometry.size) ? valueAt(image, index) : outside;
        }
        return static_cast<float>(sum / (points * points * points));
    };
    parallelForPieces(grid.size[1] * grid.size[2], 16, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t row = begin; row < end; ++row) {
            Vec3 voxel{0, static_cast<double>(row % grid.size[1]),
                       static_cast<double>(row / grid.size[1])};
            for (std::int64_t i = 0; i < grid.size[0]; ++i) {
                voxel.x = static_cast<double>(i);
                result[row * grid.size[0] + i] = meanAround(voxel);
            }
        }
    });
    return result;
}

std::vector<std::uint8_t> imageFaces(const ImageGeometry& image, const ImageGeometry& grid) {
    const Mat3 toImage = inverse(image.indexToPhysical);
    const Mat3 perStep = toImage * grid.indexToPhysical;
    const Vec3 origin = toImage * (grid.originMm - image.originMm);
    Vec3 reach;  // of a step of the grid, in the image's indices
    for (int a = 0; a < 3; ++a) {
        reach[a] = std::abs(perStep.column[0][a]) + std::abs(perStep.column[1][a]) +
                   std::abs(perStep.column[2][a]);
    }
    std::vector<std::uint8_t> faces(static_cast<std::size_t>(grid.voxelCount()), 0);
    parallelForPieces(grid.size[2], 1, [&](std::int64_t k, std::int64_t) {
        std::int64_t n = k * grid.size[0] * grid.size[1];
        for (std::int64_t j = 0; j < grid.size[1]; ++j) {
            for (std::int64_t i = 0; i < grid.size[0]; ++i, ++n) {
                const Vec3 index = origin + perStep * toVec({i, j, k});
                if (!reaches(index, image.size)) continue;
                faces[n] = kInside;
                for (int a = 0; a < 3; ++a) {
                    const double last = static_cast<double>(image.size[a]) - 0.5;
                    if (index[a] < -0.5 + reach[a]) faces[n] |= 1 << (2 * a);
                    if (index[a] > last - reach[a]) faces[n] |= 2 << (2 * a);
                }
            }
        }
    });
    return faces;
}

Mask filledAtBorder(const Mask& mask, const std::vector<std::uint8_t>& faces, const Index3& size) {
    Mask air(mask.size()), around;
    {
        Mask airAtFaces(mask.size()), open(mask.size());
        for (std::size_t n = 0; n < mask.size(); ++n) {
            const unsigned face = faces[n] & ~unsigned{kInside};
            air[n] = mask[n] == 0 && faces[n] != 0 ? 1 : 0;
            airAtFaces[n] = air[n] != 0 && face != 0 ? 1 : 0;
            open[n] = std::popcount(face) >= 2 ? 1 : 0;
        }
        around = componentsWith(open, airAtFaces, size);
    }
    // where the image goes on beyond the grid, the grid's border is around the head as well
    forEachBorderVoxel(size, [&](std::int64_t voxel) { around[voxel] |= air[voxel]; });
    const Mask outsideAir = componentsWith(around, air, size);
    freeMemory(around);
    for (std::size_t n = 0; n < mask.size(); ++n) {
        // from here on the result: the mask, and air that the outside can't reach
        air[n] = mask[n] != 0 || (air[n] != 0 && outsideAir[n] == 0) ? 1 : 0;
    }
    return filled(air, size);
}

}  // namespace adaptiso::headmodel
