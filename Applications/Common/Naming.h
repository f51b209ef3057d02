#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <typeinfo>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

/// The last part of a path, never a folder above it; the folder's own name for ".".
std::string baseName(const std::filesystem::path& path);

/// `text` as a shell takes it for one word.
std::string shellQuoted(const std::string& text);

/// `text` with `by` wherever `place` stood. \pre place is not empty
std::string replaced(std::string text, std::string_view place, std::string_view by);

/// Length of an extension of two parts, as GIFTI's are: of ".surf.gii", ".shape.gii", ".func.gii",
/// ".label.gii"; 0 without one.
std::size_t twoPartExtension(const std::string& name);

/// "scans/lh-iso50.surf.gii" of "scans/lh.surf.gii".
std::filesystem::path insertBeforeExtension(const std::filesystem::path& path,
                                            const std::string& text);

/// The placeholder for bidsLabel() of an isovalue in a file's name.
inline constexpr std::string_view kIsoLabel = "{isolabel}";

/// A number's text in letters and digits, as a BIDS label must be: "411p5" for "411.5", "m300" for
/// "-300", "1em07" for "1e-07". Two numbers never share a label.
std::string bidsLabel(std::string_view number);

/// Calls `work`. Puts `subject` before the message of an InvalidInput that it throws: the option or
/// file concerned, which the library does not know. \return what `work` returns
template <class Work>
decltype(auto) naming(const std::string& subject, Work&& work) {
    try {
        return std::forward<Work>(work)();
    } catch (const InvalidInput& error) {
        if (typeid(error) != typeid(InvalidInput)) throw;
        throw InvalidInput(subject + ": " + error.what());
    }
}

}  // namespace adaptiso
