#pragma once

#include <cstddef>
#include <optional>

#include "Scene.h"
#include "adaptiso/Report/Page.h"

// Pictures of surfaces from six sides, with the spots that can be seen on them ringed.

namespace adaptiso {

/// Surface number `n` from six sides, with the spots that can be seen on it ringed; its values in
/// colour, with a colour bar.
Picture sixSidesPicture(const Scene& scene, std::size_t n);

/// Marks (SceneSurface::areMarks) with the last surface before them, likewise; what lies behind it
/// is seen through it. None without marks.
std::optional<Picture> alignmentPicture(const Scene& scene);

/// All surfaces together, each in its colour, likewise.
Picture regionsPicture(const Scene& scene);

}  // namespace adaptiso
