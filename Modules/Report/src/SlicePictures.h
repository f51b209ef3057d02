#pragma once

#include <optional>

#include "Scene.h"
#include "adaptiso/Report/Pictures.h"

namespace adaptiso {

/// Twelve slices across the axis through all surfaces, with their contours.
Picture contourPicture(const Report& report, const Scene& scene, int axis);

/// Three slices through each of the first spots, with the spot ringed. None without spots.
std::optional<Picture> spotPicture(const Report& report, const Scene& scene);

}  // namespace adaptiso
