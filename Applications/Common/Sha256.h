#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace adaptiso {

/// SHA-256 as 64 hexadecimal digits, as `sha256sum` prints it.
std::string sha256Of(std::string_view bytes);

/// The same of a file's content. \throws FileError  it can't be read
std::string sha256OfFile(const std::filesystem::path& file);

}  // namespace adaptiso
