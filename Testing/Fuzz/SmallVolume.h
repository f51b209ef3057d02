#pragma once

#include "adaptiso/Core/Volume.h"

namespace adaptiso::fuzz {

inline constexpr unsigned kSmallVolumes = 10;

/// 7 x 6 x 5 samples of several values; one volume for each pixel type.
const Volume& smallVolume(unsigned choice);

}  // namespace adaptiso::fuzz
