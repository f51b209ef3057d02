#include "OutputNames.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// `name` less the first of `extensions` that it ends in, whatever the case.
template <std::size_t N>
std::string withoutExtension(const std::string& name,
                             const std::array<std::string_view, N>& extensions) {
    const std::string lower = lowerCase(name);
    for (const std::string_view extension : extensions) {
        if (lower.size() > extension.size() && lower.ends_with(extension)) {
            return name.substr(0, name.size() - extension.size());
        }
    }
    return name;
}

std::string replaceIso(std::string text, const std::string& isovalue) {
    constexpr std::string_view kPlace = "{iso}";
    for (std::size_t at = text.find(kPlace); at != std::string::npos;
         at = text.find(kPlace, at + isovalue.size())) {
        text.replace(at, kPlace.size(), isovalue);
    }
    return text;
}

/// "lh-iso50.surf.gii" of "lh.surf.gii": GIFTI surfaces have an extension of two parts.
fs::path insertBeforeExtension(const fs::path& path, const std::string& text) {
    const std::string name = path.filename().string();
    std::string stem = withoutExtension(name, std::array<std::string_view, 1>{".surf.gii"});
    if (stem == name) stem = path.stem().string();
    return path.parent_path() / (stem + text + name.substr(stem.size()));
}

}  // namespace

std::string inputStem(const fs::path& input) {
    constexpr std::array<std::string_view, 14> kImageExtensions{
        ".nii.gz", ".nii", ".hdr.gz", ".hdr", ".img.gz", ".img", ".nrrd",
        ".nhdr",   ".mha", ".mhd",    ".mgh", ".mgz",    ".dcm", ".ima"};
    std::error_code error;
    fs::path path = input;
    if (fs::is_directory(input, error)) {
        path = fs::canonical(input, error);  // the name that ".", ".." and "scan/" stand for
        if (error || path == path.root_path()) return "volume";
        return path.filename().string();
    }
    return withoutExtension(path.filename().string(), kImageExtensions);
}

fs::path outputPath(const MeshOptions& options, const std::string& isovalue) {
    if (options.output.empty()) return inputStem(options.input) + "-iso" + isovalue + ".vtp";
    const std::string name = options.output.filename().string();
    if (name.find("{iso}") != std::string::npos) {
        return options.output.parent_path() / replaceIso(name, isovalue);
    }
    if (options.isovalues.size() == 1) return options.output;
    return insertBeforeExtension(options.output, "-iso" + isovalue);
}

}  // namespace adaptiso
