#pragma once

#include <filesystem>
#include <string_view>

namespace adaptiso::detail {

/// The file that a header names as its data: in the header's folder or below it.
///
/// \throws FileError when the name is absolute, leaves the folder, is a pattern or a list, is the
///         header itself, no regular file, or a link that requireOwnFolder() refuses
std::filesystem::path requireDataFile(const std::filesystem::path& headerFile,
                                      std::string_view name);

/// A header must not open a file that the user did not mean to give. The input itself may be any
/// link. A data file beside it is where it seems to be, or a link to a file in or below
///   - the folder that holds the header, or the header's name (a whole folder may be linked);
///   - the folder that holds the file that the header's name links to;
///   - .git/annex/objects of a folder above the header: git-annex and DataLad keep all content
///   there.
///
/// \throws FileError when `dataFile` lies elsewhere
void requireOwnFolder(const std::filesystem::path& headerFile,
                      const std::filesystem::path& dataFile);

/// The same for a file of a dataset that is a folder: it is there, or a link, or below a link, to a
/// file in the folder or in .git/annex/objects of a folder above it.
///
/// \throws FileError when `dataFile` lies elsewhere
void requireInFolder(const std::filesystem::path& folder, const std::filesystem::path& dataFile);

}  // namespace adaptiso::detail
