#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {

/// Text from outside made fit for a message: control characters as \xNN, at most 80 characters.
std::string printable(std::string_view text);

/// A path fit for a message: control characters as \xNN, never shortened.
std::string displayName(const std::filesystem::path& path);

/// "1.5", "0.0001", "1e-30"
std::string number(double value);

/// \throws FileError "<file>: <fault>; <remedy>"
[[noreturn]] void refuse(const std::filesystem::path& file, std::string_view fault,
                         std::string_view remedy);

/// \throws ChoiceNeeded  "<file>: <fault>; <remedy>"
[[noreturn]] void refuseChoice(const std::filesystem::path& file, std::string_view fault,
                               std::string_view remedy, ChoiceNeeded::Among among,
                               std::int64_t count);

/// The same for want of memory or processes. \throws Shortage
[[noreturn]] void refuseShort(const std::filesystem::path& file, std::string_view fault,
                              std::string_view remedy);

/// \throws FileError where findForeignContent() knows the content: a pointer of git-lfs, an
/// archive, ...
void refuseForeignContent(const std::filesystem::path& file);

/// \throws FileError unless `file` is a readable regular file or a link to one
/// \return its size in bytes
std::uint64_t requireRegularFile(const std::filesystem::path& file);

}  // namespace adaptiso::detail
