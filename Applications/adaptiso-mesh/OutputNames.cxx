#include "OutputNames.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "Common/InputNames.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
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
    constexpr std::string_view kTwoParts = ".surf.gii";
    const std::size_t kept = name.size() - std::min(name.size(), kTwoParts.size());
    const bool hasTwoParts = kept > 0 && lowerCase(name.substr(kept)) == kTwoParts;
    const std::string stem = hasTwoParts ? name.substr(0, kept) : path.stem().string();
    return path.parent_path() / (stem + text + name.substr(stem.size()));
}

}  // namespace

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
