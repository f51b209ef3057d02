#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Text.h"

/// Shared by the text headers of NRRD and MetaImage.
namespace adaptiso::detail {

/// Cut at blanks.
std::vector<std::string_view> words(std::string_view text);

/// All of `text` as one number; nothing else, no NaN or infinity for integers.
std::optional<double> parseNumber(std::string_view text);
std::optional<std::int64_t> parseInteger(std::string_view text);
/// The same as T, any integer type of samples; empty if T can't hold it.
template <class T>
std::optional<T> parseNumberAs(std::string_view text);

/// The first bytes of a file, at most `most` of them.
std::string readHead(const std::filesystem::path& file, std::size_t most);

}  // namespace adaptiso::detail
