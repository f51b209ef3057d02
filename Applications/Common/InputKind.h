#pragma once

#include <filesystem>
#include <string>

#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

/// Of a file that can't be read as a surface: what it is where it is an image, by its name or by
/// its first bytes, and which program takes it. Empty: it is not there, or something else.
std::string imageHint(const std::filesystem::path& file);

/// The format that the name of a surface's file asks for. \throws UsageError  none, with
/// imageHint()
const MeshFormat& meshFormatOf(const std::filesystem::path& file);

/// Of a file that can't be read as an image: that it is a surface, and which program takes it.
/// Empty: no program reads it as one.
std::string surfaceHint(const std::filesystem::path& file);

}  // namespace adaptiso
