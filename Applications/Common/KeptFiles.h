#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "Common/Json.h"

namespace adaptiso {

/// What a record keeps of a file or, as of one, of several that belong together.
struct KeptFile {
    std::string file;  ///< its name, of an output its path from the record's folder
    std::uint64_t files = 1;
    std::uint64_t bytes = 0;
    /// Of several files: of a list of their names and checksums, as `sha256sum` prints it.
    std::string sha256;
    /// Of the latest of them, ns since 1970: while they and the size are the same so is the file.
    std::int64_t modifiedNs = 0, changedNs = 0;
};

enum class FileChange { None, Gone, Changed };

/// Reads the file. \throws FileError
KeptFile keptFile(const std::string& name, const std::filesystem::path& path);

/// The same for an input and all files that belong to it: of a folder all regular files in and
/// under it, of a header the files that hold its data, of a DICOMDIR all that lies beside it.
/// Hidden files are left out, but for those of Zarr (.zarray, .zattrs, .zgroup): nobody reads
/// others. So is what lies under `output`, the folder that is written to.
KeptFile keptInput(const std::filesystem::path& input, const std::filesystem::path& output);

/// The files that an input consists of, by name; the first is the one given unless it is a folder.
std::vector<std::filesystem::path> filesOfInput(const std::filesystem::path& input,
                                                const std::filesystem::path& output);

/// Whether an input has the size and times that were kept of it, without reading it.
bool hasTimesOf(const KeptFile& kept, const std::filesystem::path& input,
                const std::filesystem::path& output);

/// Whether `now` differs from what was kept.
FileChange changeOf(const KeptFile& kept, const KeptFile& now);

/// Whether the file at `path` differs from what was kept of it.
/// \param trustsTimes  a file of the same size and times is taken for the same without reading it
FileChange changeOf(const KeptFile& kept, const std::filesystem::path& path, bool trustsTimes);

Json toJson(const KeptFile& file);

/// \throws Json::exception
KeptFile keptFileOf(const Json& json);

}  // namespace adaptiso
