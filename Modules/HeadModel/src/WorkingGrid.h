#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "ImageSteps.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::headmodel {

/// Samples of an image as floats, on its own grid.
struct FloatImage {
    ImageGeometry geometry;
    std::vector<float> values;
};

/// All samples as floats; NaN becomes `nan`.
FloatImage toFloat(const VolumeView& volume, float nan);

/// 1 where isInside(sample), else 0. Samples are handed over as doubles.
FloatImage indicator(const VolumeView& volume, const std::function<bool(double)>& isInside);

/// Smallest box of indices that holds all voxels with value >= threshold.
/// \return false when there is none
bool boundingIndices(const std::vector<float>& values, const Index3& size, double threshold,
                     Index3& first, Index3& last);

/// The isotropic grid that a head is worked on: along the image's axes (the nearest ones at right
/// angles when the image is sheared), around the voxels first...last of the image, with marginMm
/// of room on every side.
///
/// Voxels coincide with the image's own when these are cubes (to 1 %, at right angles to 1e-4) of
/// stepMm, or of 0.7 to 1.5 mm if stepMm is 0; otherwise their side is stepMm, or 1 mm.
/// \throws InvalidInput  stepMm < 0; more than 2^29 voxels
ImageGeometry workingGrid(const ImageGeometry& image, const Index3& first, const Index3& last,
                          double stepMm, double marginMm);

/// `image` on `grid`: trilinear; where the grid is coarser than the image the mean of several
/// points a voxel. The image reaches half a voxel beyond its samples; `outside` is what lies there.
std::vector<float> resampled(const FloatImage& image, const ImageGeometry& grid, float outside);

/// For every voxel of `grid` which faces of the image it lies at: bit 2 a for the low end of the
/// image's axis a, bit 2 a + 1 for the high end (within a voxel of the grid), kInside for all
/// voxels that lie in the image (voxels' own volume included); 0 outside.
inline constexpr std::uint8_t kInside = 64;
std::vector<std::uint8_t> imageFaces(const ImageGeometry& image, const ImageGeometry& grid);

/// `mask` with its cavities filled, those included that open only at the image's border: air that
/// reaches a single face of the image and there does not reach the face's edge (an airway where
/// the neck is cut). Nothing outside the image is filled.
Mask filledAtBorder(const Mask& mask, const std::vector<std::uint8_t>& faces, const Index3& size);

}  // namespace adaptiso::headmodel
