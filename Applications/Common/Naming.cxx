#include "Common/Naming.h"

#include <array>
#include <string_view>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace fs = std::filesystem;

std::string baseName(const fs::path& path) {
    std::error_code error;
    if (path.has_filename() && path != "." && path != "..") return path.filename().string();
    return fs::canonical(path, error).filename().string();
}

std::string replaced(std::string text, std::string_view place, std::string_view by) {
    for (std::size_t at = text.find(place); at != std::string::npos;
         at = text.find(place, at + by.size())) {
        text.replace(at, place.size(), by);
    }
    return text;
}

std::size_t twoPartExtension(const std::string& name) {
    constexpr std::array<std::string_view, 4> kExtensions{".surf.gii", ".shape.gii", ".func.gii",
                                                          ".label.gii"};
    const std::string lower = lowerCase(name);
    for (const std::string_view extension : kExtensions) {
        if (lower.size() > extension.size() && lower.ends_with(extension)) return extension.size();
    }
    return 0;
}

fs::path insertBeforeExtension(const fs::path& path, const std::string& text) {
    std::string name = path.filename().string();
    const std::size_t two = twoPartExtension(name);
    name.insert(two > 0 ? name.size() - two : path.stem().string().size(), text);
    return path.parent_path() / name;
}

std::string shellQuoted(const std::string& text) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+,:@%=";
    const bool isPlain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos;
    if (isPlain && text.front() != '=') return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
}

std::string bidsLabel(std::string_view number) {
    std::string label;
    for (const char c : number) {
        if (c == '+') continue;  // of an exponent, which has a sign in any case
        label += c == '.' ? 'p' : c == '-' ? 'm' : c;
    }
    return label;
}

}  // namespace adaptiso
