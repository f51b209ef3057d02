#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

/// Files that the user did not name: they lie beside an input, in a dataset, or where a program
/// chose the name of an output. Whoever sent the folder may have put a link, a named pipe or a
/// device in their place.
namespace adaptiso {

/// True if `file` exists and, with all links followed, lies in `folder`, or in the git-annex of
/// `folder` or of a folder above it.
bool liesIn(const std::filesystem::path& file, const std::filesystem::path& folder);

/// The same for a file that belongs to `named`: it lies in the folder of `named` or, where `named`
/// is a link, in the folder of the file that the link points to.
bool liesBeside(const std::filesystem::path& file, const std::filesystem::path& named);

/// \throws FileError unless `file` is missing or liesIn() `folder`
void requireIn(const std::filesystem::path& file, const std::filesystem::path& folder);

/// \throws FileError unless `file` is missing or liesBeside() `named`
void requireBeside(const std::filesystem::path& file, const std::filesystem::path& named);

/// For an output below `folder` whose name the program chose: neither `file` nor a folder between
/// the two may be a link. \throws FileError
void requireNoLink(const std::filesystem::path& file, const std::filesystem::path& folder);

/// True if `path`, taken from a file, stays in the folder that it starts from: it is relative,
/// without "..", and not empty.
bool staysBelow(const std::filesystem::path& path);

inline constexpr std::uint64_t kMostTextBytes = std::uint64_t{64} << 20;

/// The whole of a small regular file; pipes and devices are not waited for.
/// \return empty if there is no such file
/// \throws FileError if it is no regular file, larger than `most` bytes, or can't be read
std::optional<std::string> readSmallFile(const std::filesystem::path& file,
                                         std::uint64_t most = kMostTextBytes);

/// readSmallFile() of a file that the user did not name. \throws FileError  also as requireIn()
std::optional<std::string> readFoundFile(const std::filesystem::path& file,
                                         const std::filesystem::path& folder,
                                         std::uint64_t most = kMostTextBytes);

}  // namespace adaptiso
