#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "ByteSink.h"

namespace adaptiso::meshio {

/// The bytes of a regular file, at most `most`. \throws FileError  "<file>: what is wrong; what to
/// do"
std::string readBytes(const std::filesystem::path& path,
                      std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Makes a file, or replaces what is in it, with what `write` hands to the sink.
/// \throws FileError  "<file>: what is wrong; what to do"
void writeBytes(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write);

}  // namespace adaptiso::meshio
