#pragma once

#include <filesystem>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::fuzz {

/// Reads a volume, or is refused with a FileError; aborts when the volume is not what readVolume()
/// promises. Without the sandbox: a fork for each input would be slow and hide what is looked for.
void readFuzzed(const std::filesystem::path& input, ReadOptions options = {});

/// listSeries() with the same rule.
void listFuzzed(const std::filesystem::path& input);

}  // namespace adaptiso::fuzz
