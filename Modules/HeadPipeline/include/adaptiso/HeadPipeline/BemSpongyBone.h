#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// At least from inner and outer skull.
inline constexpr double kSpongyGapMm = 0.5;

/// Makes the surface of spongy bone, where the segmentation tells it apart, and checks it: closed,
/// no crossings, kSpongyGapMm or more from both surfaces of the skull. Pieces of less than 50 mm3
/// are left out, with a note; where nothing is left a warning says so. \pre the model's surfaces
/// are checked
void addSpongyBone(BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
