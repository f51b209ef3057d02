#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/HeadModel/FractionField.h"

namespace adaptiso::headmodel {

/// 1 inside, 0 outside; x fastest, on a grid that goes with it.
using Mask = std::vector<std::uint8_t>;

/// Side of the cubic voxels of a working grid, mm.
double stepMm(const ImageGeometry& grid);

/// `values` convolved with a Gaussian of standard deviation sigmaMm (smoothVolumeRecursively: to
/// about 1 %), the border repeated. Below a third of a voxel nothing is done: the samples can't
/// hold it. What is more than 4.5 standard deviations from all that is not 0 stays 0. \pre values
/// >= 0; 4 voxels or more along every axis Cost: O(voxels of the box around what is not 0), in
/// parallel.
std::vector<float> smoothed(std::vector<float> values, const ImageGeometry& grid, double sigmaMm);

/// How far from a mask's surface depths are wanted, mm; what is beyond has the band's end.
struct DepthBand {
    double insideMm = std::numeric_limits<double>::infinity();
    double outsideMm = std::numeric_limits<double>::infinity();

    static DepthBand within(double mm) { return {mm, mm}; }
    static DepthBand inside() { return {std::numeric_limits<double>::infinity(), 0}; }
};

/// Depth below the mask's surface, mm: positive inside, negative outside. Exact Euclidean distance
/// to the nearest voxel of the other side, less half a voxel, as far as `band`: beyond it the depth
/// is band.insideMm or -band.outsideMm. An empty mask is that far, a full one that deep.
/// Cost: O(voxels * band in voxels) at most, in parallel.
std::vector<float> depthMm(const Mask& mask, const ImageGeometry& grid, const DepthBand& band = {});

/// Morphology with balls, radii in mm. An erosion is what the same dilation of the outside leaves,
/// so that closing and opening change no set that the ball has rolled over. The grid's border does
/// not count as outside: a mask should keep away from it by the radius.
Mask dilated(const Mask& mask, const ImageGeometry& grid, double radiusMm);
Mask eroded(const Mask& mask, const ImageGeometry& grid, double radiusMm);
Mask closed(const Mask& mask, const ImageGeometry& grid, double radiusMm);
Mask opened(const Mask& mask, const ImageGeometry& grid, double radiusMm);

/// Calls visit(voxel) for every voxel at the border of a grid, in order.
template <class Visit>
void forEachBorderVoxel(const Index3& size, const Visit& visit) {
    std::int64_t voxel = 0;
    for (std::int64_t k = 0; k < size[2]; ++k) {
        for (std::int64_t j = 0; j < size[1]; ++j) {
            const bool isWhole = j == 0 || k == 0 || j + 1 == size[1] || k + 1 == size[2];
            for (std::int64_t i = 0; i < size[0]; ++i, ++voxel) {
                if (isWhole || i == 0 || i + 1 == size[0]) visit(voxel);
            }
        }
    }
}

/// Calls visit(row's first voxel in the grid, in the box) for the rows along x of a box of a grid.
template <class Visit>
void forEachRow(const Index3& first, const Index3& boxSize, const Index3& size,
                const Visit& visit) {
    std::int64_t inBox = 0;
    for (std::int64_t k = 0; k < boxSize[2]; ++k) {
        for (std::int64_t j = 0; j < boxSize[1]; ++j, inBox += boxSize[0]) {
            visit(first[0] + size[0] * (first[1] + j + size[1] * (first[2] + k)), inBox);
        }
    }
}

/// Calls body(begin, end) for pieces of all voxels of a volume, in parallel.
template <class Values, class Body>
void forVoxels(const Values& volume, const Body& body) {
    parallelForPieces(std::ssize(volume), 1 << 18, body);
}

/// value >= threshold.
Mask above(const std::vector<float>& values, double threshold);

std::int64_t voxelsIn(const Mask& mask);

/// The component (6 neighbours) with the most voxels; the first of several.
Mask largestComponent(const Mask& mask, const Index3& size);

/// The component (6 neighbours) with the largest bounding box; the first of several.
Mask widestComponent(const Mask& mask, const Index3& size);

/// The components (6 neighbours) of `mask` that hold a voxel of `seeds`.
Mask componentsWith(const Mask& seeds, const Mask& mask, const Index3& size);

/// With all background that the grid's border can't reach (by 6 neighbours).
Mask filled(const Mask& mask, const Index3& size);

/// 0.5 at depth 0, 1 from half a voxel inside on, 0 from half a voxel outside on.
inline float partAtDepth(double depthMm, double stepMm) {
    return static_cast<float>(std::clamp(0.5 + depthMm / stepMm, 0.0, 1.0));
}

/// `mask` as parts of voxels, with its surface where the image says: within a voxel of the mask's
/// surface the part is 0.5 where value == level and falls to 0 at `low`, as far as that agrees with
/// the mask about which side a voxel is on; elsewhere it is 0 or 1. `level` may be less than `low`
/// (a dark solid). Voxels that `isImage` does not know hold nothing. \pre level != low
std::vector<float> partByLevel(const Mask& mask, const std::vector<float>& values, double level,
                               double low, const std::vector<std::uint8_t>& isImage,
                               const ImageGeometry& grid);

}  // namespace adaptiso::headmodel
