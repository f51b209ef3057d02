#pragma once

#include <string>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::benchmarks {

/// Samples first..last of each axis, both kept.
struct Crop {
    Index3 first{};
    Index3 last{};
};

/// Reads "i0:i1,j0:j1,k0:k1", whole numbers.
/// \throws InvalidInput when `text` is nothing of the kind
Crop parseCrop(const std::string& text);

/// A copy of the samples in `crop`, in the same place in space.
/// \pre 0 <= first <= last < size along every axis    \throws InvalidInput otherwise
Volume cropped(const VolumeView& volume, const Crop& crop);

}  // namespace adaptiso::benchmarks
