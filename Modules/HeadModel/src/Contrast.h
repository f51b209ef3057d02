#pragma once

#include <vector>

#include "ImageSteps.h"
#include "SkullBand.h"
#include "WorkingGrid.h"

namespace adaptiso::headmodel {

/// Makes a background of one value air: where most samples of the image's border have one and the
/// same value, all that have it become the darkest of the rest. Masked images may be brighter
/// outside than inside.
void backgroundToAir(FloatImage& image);

/// Whether fluid is brighter than brain, as on T2-weighted images. In blocks of 16 mm, 15 mm or
/// more below the skin, brain and CSF lie side by side: of a T1 the dark tail of a block's values
/// is the longer one (ch2, with noise of 15 %, bias of 40 %, contrast agent, lesions: in 72 % or
/// more of the blocks), of a T2 the bright one (in 76 % or more). No coil's sensitivity changes
/// that within a block.
/// \param belowSkinMm  depth of every voxel below the skin
bool isFluidBright(const std::vector<float>& t1, const std::vector<float>& belowSkinMm,
                   const ImageGeometry& grid, const HeadLevels& levels);

}  // namespace adaptiso::headmodel
