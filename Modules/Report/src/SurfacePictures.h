#pragma once

#include "Scene.h"
#include "adaptiso/Report/Pictures.h"

namespace adaptiso {

/// Surface number `n` from six sides, with the spots that can be seen on it ringed; its values in
/// colour, with a colour bar.
Picture sixSidesPicture(const Scene& scene, std::size_t n);

/// All surfaces together, each in its colour, likewise.
Picture regionsPicture(const Scene& scene);

}  // namespace adaptiso
