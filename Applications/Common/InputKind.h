#pragma once

#include <filesystem>
#include <string>

#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

/// The format that the name of a file to write asks for. \throws UsageError  it names none
const MeshFormat& meshFormatOf(const std::filesystem::path& file);

/// Of a file that can't be read as an image: that it is a surface, and which program takes it.
/// Empty: no program reads it as one.
std::string surfaceHint(const std::filesystem::path& file);

}  // namespace adaptiso
