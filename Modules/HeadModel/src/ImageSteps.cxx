#include "ImageSteps.h"

#include <itkImage.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace adaptiso::headmodel {
namespace {

using FloatItk = itk::Image<float, 3>;

/// The values as an ITK image of cubic voxels along x, y, z: all that a filter in mm needs to know.
/// Copies nothing; `values` must outlive the image.
FloatItk::Pointer asItk(const std::vector<float>& values, const ImageGeometry& grid) {
    auto image = FloatItk::New();
    FloatItk::RegionType region;
    for (int axis = 0; axis < 3; ++axis) region.SetSize(axis, grid.size[axis]);
    image->SetRegions(region);
    FloatItk::SpacingType spacing;
    spacing.Fill(stepMm(grid));
    image->SetSpacing(spacing);
    // the filter below does not write to its input
    image->GetPixelContainer()->SetImportPointer(const_cast<float*>(values.data()), values.size(),
                                                 false);
    return image;
}

std::int64_t voxelCount(const Index3& size) {
    return size[0] * size[1] * size[2];
}

/// Calls visit(neighbour) for the up to six voxels beside `voxel`.
template <class Visit>
void forEachNeighbour(std::int64_t voxel, const Index3& size, const Visit& visit) {
    const std::int64_t i = voxel % size[0], j = voxel / size[0] % size[1];
    const std::int64_t slice = size[0] * size[1], k = voxel / slice;
    if (i > 0) visit(voxel - 1);
    if (i + 1 < size[0]) visit(voxel + 1);
    if (j > 0) visit(voxel - size[0]);
    if (j + 1 < size[1]) visit(voxel + size[0]);
    if (k > 0) visit(voxel - slice);
    if (k + 1 < size[2]) visit(voxel + slice);
}

/// Takes the voxels of `mask` that hang together with those in `front` out of it.
/// \return them
std::vector<std::int64_t> takeComponent(Mask& mask, const Index3& size,
                                        std::vector<std::int64_t> front) {
    for (const std::int64_t voxel : front) mask[voxel] = 0;
    for (std::size_t n = 0; n < front.size(); ++n) {
        forEachNeighbour(front[n], size, [&](std::int64_t neighbour) {
            if (mask[neighbour] == 0) return;
            mask[neighbour] = 0;
            front.push_back(neighbour);
        });
    }
    return front;
}

/// The component with the largest size(component), of several the first.
template <class SizeOf>
Mask bestComponent(const Mask& mask, const Index3& size, const SizeOf& sizeOf) {
    Mask left = mask;
    std::vector<std::int64_t> best;
    std::int64_t bestSize = 0;
    for (std::int64_t voxel = 0; voxel < voxelCount(size); ++voxel) {
        if (left[voxel] == 0) continue;
        std::vector<std::int64_t> component = takeComponent(left, size, {voxel});
        const std::int64_t itsSize = sizeOf(component);
        if (itsSize <= bestSize) continue;
        bestSize = itsSize;
        best = std::move(component);
    }
    Mask result(mask.size(), 0);
    for (const std::int64_t voxel : best) result[voxel] = 1;
    return result;
}

}  // namespace

double stepMm(const ImageGeometry& grid) {
    return norm(grid.indexToPhysical.column[0]);
}

std::vector<float> smoothed(const std::vector<float>& values, const ImageGeometry& grid,
                            double sigmaMm) {
    if (sigmaMm < stepMm(grid) / 3) return values;
    const auto image = asItk(values, grid);
    auto filter = itk::SmoothingRecursiveGaussianImageFilter<FloatItk, FloatItk>::New();
    filter->SetInput(image);
    filter->SetSigma(sigmaMm);
    // ITK takes as many threads as the rest of the program
    filter->SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
    filter->Update();
    const float* const first = filter->GetOutput()->GetBufferPointer();
    return {first, first + values.size()};
}

Mask dilated(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    return radiusMm > 0 ? above(depthMm(mask, grid), -radiusMm) : mask;
}

Mask eroded(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    if (!(radiusMm > 0)) return mask;
    // what a dilation of the outside leaves: a depth of the very radius goes
    const auto radius = static_cast<float>(radiusMm);
    return above(depthMm(mask, grid), std::nextafter(radius, 2 * radius));
}

Mask closed(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    Mask result = eroded(dilated(mask, grid, radiusMm), grid, radiusMm);
    // closing only adds; discrete distances may say otherwise at single voxels
    for (std::size_t n = 0; n < mask.size(); ++n) result[n] |= mask[n];
    return result;
}

Mask opened(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    Mask result = dilated(eroded(mask, grid, radiusMm), grid, radiusMm);
    for (std::size_t n = 0; n < mask.size(); ++n) result[n] &= mask[n];
    return result;
}

Mask above(const std::vector<float>& values, double threshold) {
    Mask mask(values.size());
    for (std::size_t n = 0; n < values.size(); ++n) mask[n] = values[n] >= threshold ? 1 : 0;
    return mask;
}

std::int64_t voxelsIn(const Mask& mask) {
    return std::count(mask.begin(), mask.end(), std::uint8_t{1});
}

Mask largestComponent(const Mask& mask, const Index3& size) {
    return bestComponent(mask, size, [](const std::vector<std::int64_t>& component) {
        return static_cast<std::int64_t>(component.size());
    });
}

Mask widestComponent(const Mask& mask, const Index3& size) {
    return bestComponent(mask, size, [&](const std::vector<std::int64_t>& component) {
        Index3 low = size, high{0, 0, 0};
        for (const std::int64_t voxel : component) {
            const Index3 at{voxel % size[0], voxel / size[0] % size[1],
                            voxel / (size[0] * size[1])};
            for (int a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], at[a]);
                high[a] = std::max(high[a], at[a]);
            }
        }
        return (high[0] - low[0] + 1) * (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
    });
}

Mask componentsWith(const Mask& seeds, const Mask& mask, const Index3& size) {
    Mask left = mask;
    std::vector<std::int64_t> front;
    for (std::int64_t voxel = 0; voxel < voxelCount(size); ++voxel) {
        if (seeds[voxel] != 0 && mask[voxel] != 0) front.push_back(voxel);
    }
    Mask result(mask.size(), 0);
    for (const std::int64_t voxel : takeComponent(left, size, std::move(front))) result[voxel] = 1;
    return result;
}

Mask filled(const Mask& mask, const Index3& size) {
    Mask background(mask.size());
    for (std::size_t n = 0; n < mask.size(); ++n) background[n] = mask[n] == 0 ? 1 : 0;
    std::vector<std::int64_t> border;
    forEachBorderVoxel(size, [&](std::int64_t voxel) {
        if (background[voxel] != 0) border.push_back(voxel);
    });
    Mask result(mask.size(), 1);
    for (const std::int64_t voxel : takeComponent(background, size, std::move(border))) {
        result[voxel] = 0;
    }
    return result;
}

float partAtDepth(double depth, double step) {
    return static_cast<float>(std::clamp(0.5 + depth / step, 0.0, 1.0));
}

std::vector<float> partByLevel(const Mask& mask, const std::vector<float>& values, double level,
                               double low, const std::vector<std::uint8_t>& isImage,
                               const ImageGeometry& grid) {
    const double step = stepMm(grid), slope = 0.5 / (level - low);
    constexpr float kJustOutside = 0.49f;
    const std::vector<float> depth = depthMm(mask, grid);
    std::vector<float> part(mask.size());
    for (std::size_t n = 0; n < part.size(); ++n) {
        const auto own =
            static_cast<float>(std::clamp(0.5 + slope * (values[n] - level), 0.0, 1.0));
        if (mask[n] != 0) {
            part[n] = depth[n] < step && own >= kFractionIsovalue ? own : 1;
        } else {
            const bool isNear = depth[n] > -1.5 * step && isImage[n] != 0;
            part[n] = isNear ? std::min(own, kJustOutside) : 0;
        }
    }
    return part;
}

}  // namespace adaptiso::headmodel
