#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "ByteSink.h"

namespace adaptiso::meshio {

/// Why the last call of the system failed.
std::string systemReason();

/// The bytes of a regular file. \throws FileError
std::string readBytes(const std::filesystem::path& path);

/// Makes the file, or overwrites it. \throws FileError
void writeFile(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write);

}  // namespace adaptiso::meshio
