#include "adaptiso/ImageIO/ImageNames.h"

#include <array>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace fs = std::filesystem;

namespace {

/// `name` without the first of the extensions that it ends with.
template <std::size_t N>
std::string without(const std::array<std::string_view, N>& extensions, const std::string& name,
                    std::string_view* found = nullptr) {
    const std::string lower = lowerCase(name);
    for (const std::string_view extension : extensions) {
        if (lower.size() <= extension.size() || !lower.ends_with(extension)) continue;
        if (found != nullptr) *found = extension;
        return name.substr(0, name.size() - extension.size());
    }
    return name;
}

constexpr std::array<std::string_view, 14> kImages{".nii.gz", ".nii",  ".hdr.gz", ".hdr", ".img.gz",
                                                   ".img",    ".nrrd", ".nhdr",   ".mha", ".mhd",
                                                   ".mgh",    ".mgz",  ".dcm",    ".ima"};
constexpr std::array<std::string_view, 2> kFolders{".ome.zarr", ".zarr"};

}  // namespace

std::string_view imageExtension(const fs::path& file) {
    std::string_view found;
    without(kImages, file.filename().string(), &found);
    return found;
}

std::string inputStem(const fs::path& input) {
    std::error_code error;
    if (!fs::is_directory(input, error)) return without(kImages, input.filename().string());
    const fs::path path = fs::canonical(input, error);  // what ".", ".." and "scan/" stand for
    if (error || path == path.root_path()) return "volume";
    return without(kFolders, path.filename().string());
}

}  // namespace adaptiso
