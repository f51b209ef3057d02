#pragma once

#include <optional>

#include "Scene.h"
#include "adaptiso/Report/Pictures.h"

namespace adaptiso {

/// Areas and smallest angles of the triangles of every surface, side by side. None without any.
std::optional<Picture> trianglePicture(const Scene& scene);

/// The report's own histogram number `n`. None when it has no finite value.
std::optional<Picture> histogramPicture(const Report& report, std::size_t n);

/// Seconds by stage. None without stages.
std::optional<Picture> timesPicture(const Report& report);

}  // namespace adaptiso
