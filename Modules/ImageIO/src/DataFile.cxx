#include "DataFile.h"

#include <fmt/core.h>

#include <algorithm>

#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// Both without links and dots.
bool isBelow(const fs::path& file, const fs::path& folder) {
    const auto [inFolder, inFile] =
        std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return inFolder == folder.end() && inFile != file.end();
}

/// Nothing where it can't be resolved.
fs::path resolved(const fs::path& path) {
    std::error_code error;
    fs::path real = fs::canonical(path, error);
    return error ? fs::path() : real;
}

bool isInAnnexAbove(const fs::path& file, const fs::path& folder) {
    for (fs::path above = folder; above.has_relative_path(); above = above.parent_path()) {
        const fs::path objects = resolved(above / ".git" / "annex" / "objects");
        if (!objects.empty() && isBelow(file, objects)) return true;
    }
    return false;
}

}  // namespace

fs::path requireDataFile(const fs::path& headerFile, std::string_view name) {
    const fs::path relative(name);
    const bool leaves =
        relative.is_absolute() || std::any_of(relative.begin(), relative.end(),
                                              [](const fs::path& part) { return part == ".."; });
    if (leaves) {
        refuse(headerFile,
               fmt::format("names a data file outside its own folder ('{}')", printable(name)),
               "put the data file beside the header and name it there");
    }
    if (name.empty() || name.find('%') != std::string_view::npos ||
        name.find('\0') != std::string_view::npos) {
        refuse(headerFile, fmt::format("its data file '{}' is no plain file name", printable(name)),
               "join the slices into one data file");
    }
    fs::path data = headerFile.parent_path() / relative;
    requireRegularFile(data);
    std::error_code error;
    if (fs::equivalent(data, headerFile, error)) {
        refuse(headerFile, "names itself as its data file", "repair the header");
    }
    requireOwnFolder(headerFile, data);
    return data;
}

void requireOwnFolder(const fs::path& headerFile, const fs::path& dataFile) {
    const fs::path seen = headerFile.has_parent_path() ? headerFile.parent_path() : fs::path(".");
    const fs::path data = resolved(dataFile), folder = resolved(seen);
    const fs::path header = resolved(headerFile);
    if (!data.empty() && !folder.empty() && !header.empty() &&
        (isBelow(data, folder) || isBelow(data, header.parent_path()) ||
         isInAnnexAbove(data, folder) || isInAnnexAbove(data, header.parent_path()))) {
        return;
    }
    refuse(headerFile,
           fmt::format("its data file '{}' is a link to outside the header's own folder",
                       printable(dataFile.filename().native())),
           "put the data file itself beside the header");
}

void requireInFolder(const fs::path& folder, const fs::path& dataFile) {
    const fs::path data = resolved(dataFile), real = resolved(folder);
    if (!data.empty() && !real.empty() && (isBelow(data, real) || isInAnnexAbove(data, real))) {
        return;
    }
    refuse(dataFile, "is, or lies behind, a link to outside of its dataset's folder",
           "put the file itself there");
}

}  // namespace adaptiso::detail
