#pragma once

#include <string>
#include <vector>

#include "ImageSteps.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso::headmodel {

/// Room around the head on a working grid, mm: closing and gaps must not reach the border.
double marginMm(const BoundaryOptions& options);

/// Checks the numbers of the options. \throws InvalidInput
void checkOptions(const BoundaryOptions& options);

/// The raw solids of a head on one grid, inside out, as parts of voxels: one or three.
struct RawBoundaries {
    ImageGeometry grid;
    std::vector<std::vector<float>> parts;
    std::vector<std::vector<Vec3>> seenMm{};  ///< of the parts, as HeadBoundaries has it
    /// Those wanted within the first of them, from outside in: brain, white matter.
    std::vector<std::vector<float>> inner{};
    std::vector<std::vector<Vec3>> innerSeenMm{};
    std::vector<std::string> notes;
    std::vector<Warning> warnings;
    std::vector<Finding> doubts{};
    std::vector<HeadFigure> figures{};
};

/// One raw solid of what belongs to it: its largest piece, closed, with its holes filled (those too
/// that open at the image's border).
std::vector<float> solidOf(std::vector<float> part, const ImageGeometry& grid,
                           const std::vector<std::uint8_t>& faces, double closingMm);

/// The centres of the voxels of a mask beside others of the image that are not in it: where the
/// image shows its side.
std::vector<Vec3> sidesOf(const Mask& mask, const ImageGeometry& grid,
                          const std::vector<std::uint8_t>& faces);

/// Smooths each solid, grows it to hold the one inside it with the least gap, and makes it a ball,
/// from inside out; then brain and white
/// matter give way to the layer around them. Every change of topology is noted with its
/// size. \throws InvalidInput  a solid is empty, or reaches the grid's border
HeadBoundaries finished(RawBoundaries raw, const BoundaryOptions& options);

/// Limits the outer skull to maxSkullMm from the inner skull (bone beyond it is face or neck) and
/// to minScalpMm below the skin, but leaves minSkullMm around the inner skull.
void limitOuterSkull(RawBoundaries& raw, const BoundaryOptions& options);

/// part = max(part, what `depth` (mm, positive inside) says).
void growTo(std::vector<float>& part, const std::vector<float>& depth, double offsetMm,
            double step);

/// Tells `options.progress`, if anybody listens.
void tell(const BoundaryOptions& options, const char* stage, double fraction);

/// "12.5" of a number of cm3 and the like.
std::string shortNumber(double value);

}  // namespace adaptiso::headmodel
