#pragma once

#include <functional>
#include <string_view>

namespace adaptiso {

/// Told how far a long call has come: the stage's name and the part of it done, 0 to 1. Called
/// from the calling thread only. Empty: nobody listens.
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

}  // namespace adaptiso
