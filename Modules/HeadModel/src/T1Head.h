#pragma once

#include <cstdint>
#include <vector>

#include "BiasField.h"
#include "SkullBand.h"
#include "WorkingGrid.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadModel/Plausibility.h"

namespace adaptiso::headmodel {

/// The head on its working grid.
struct Head {
    UsualHead usual;
    ImageGeometry grid;
    std::vector<float> t1;
    std::vector<std::uint8_t> faces;
    HeadLevels levels;
    double skinLevel = 0;
    Mask mask;                   ///< closed and filled
    double besideCm3 = 0;        ///< as bright as tissue, but no part of it
    double cutMm2 = 0;           ///< of its side, where tissue was taken out of the image
    BiasField bias;              ///< as it was taken out of t1
    bool isFramed = false;       ///< parts thinner than 12 mm do not belong to it
    double darkShare = 1;        ///< of what lies 6 to 16 mm below the skin: bone
    Mask lesion;                 ///< given as such; else empty
    bool isFluidBright = false;  ///< a T2
    bool isLesion(std::int64_t voxel) const { return !lesion.empty() && lesion[voxel] != 0; }
};

/// Finds the head in a T1 or T2.
/// \param isFramed  leave aside what is thinner than 12 mm
/// \throws InvalidInput  there is no head, or no skull around the brain
/// \throws SourceError  the lesion lies outside of the head
Head findHead(const VolumeView& t1, const BrainSources& sources, const BoundaryOptions& options,
              bool isFramed);

Mask ballAround(std::int64_t voxel, const ImageGeometry& grid, double radiusMm);
double cm3Of(const Mask& mask, const ImageGeometry& grid);

/// Depth inside of a mask that keeps clear of the grid's border: the border is nearer to its middle
/// than the band.
std::vector<float> depthInHeadMm(const Mask& mask, const ImageGeometry& grid);
std::int64_t deepestVoxel(const std::vector<float>& depth);

/// How deep every voxel lies below the skin, up to 16 mm; the image's border is no skin.
std::vector<float> belowSkinMm(const Head& head);

/// Least volume of objects beside the head (frames, headphones); ghosts and noise have less.
inline constexpr double kLeastBesideCm3 = 15;
inline constexpr double kMostBrainCm3 = 2500;
inline constexpr const char* kSkullStripped =
    "there is no skull or skin around the brain (a skull-stripped T1); give the whole T1, and this "
    "image as the brain mask";

}  // namespace adaptiso::headmodel
