#pragma once

#include <cerrno>
#include <string>
#include <string_view>
#include <utility>

namespace adaptiso::fuzz {

/// The file ending that this program fuzzes, by its name: ".nii" of fuzz-nii. Links of other names
/// make one program serve several endings.
inline const std::string& ending() {
    static const std::string found = [] {
        const std::string_view name = std::string_view(program_invocation_short_name).substr(5);
        for (const auto& [other, kind] :
             {std::pair{"shape", ".gii"}, std::pair{"overlay", ".mgh"}, std::pair{"dig", ".fif"}}) {
            if (name == other) return std::string(kind);
        }
        return "." + std::string(name);
    }();
    return found;
}

}  // namespace adaptiso::fuzz
