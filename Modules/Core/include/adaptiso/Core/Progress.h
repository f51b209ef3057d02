#pragma once

#include <functional>
#include <string_view>

namespace adaptiso {

/// Reports the progress of a long call: the stage's name and the part of it done, 0 to 1. Called
/// from the calling thread only. May be empty (no progress reporting).
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

}  // namespace adaptiso
