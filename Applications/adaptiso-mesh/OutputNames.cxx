#include <algorithm>
#include <string_view>

#include "Common/Bids.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::mesher {
namespace {

namespace fs = std::filesystem;

std::string replaced(std::string text, std::string_view place, const std::string& by) {
    for (std::size_t at = text.find(place); at != std::string::npos;
         at = text.find(place, at + by.size())) {
        text.replace(at, place.size(), by);
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
    const std::string named =
        replaced(replaced(name, "{iso}", isovalue), kIsoLabel, bidsLabel(isovalue));
    if (named != name) return options.output.parent_path() / named;
    if (options.isovalues.size() == 1) return options.output;
    return insertBeforeExtension(options.output, "-iso" + isovalue);
}

}  // namespace adaptiso::mesher
