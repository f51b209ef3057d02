#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ZarrStore.h"

namespace adaptiso::detail {

using ZarrJson = nlohmann::json;

/// A JSON object in a file of the store; none: there is no such file.
/// \throws FileError  it is none
std::optional<ZarrJson> readZarrJson(const ZarrStore& store, const std::string& key);

/// The member `key` of an object, or null.
const ZarrJson& memberOf(const ZarrJson& object, const char* key);

/// A value of the metadata for a message: one line, and of lists and objects their kind alone,
/// since they may be as deep as a hostile file likes.
std::string shownJson(const ZarrJson& value);

/// A text that must be there. \throws FileError
std::string textOf(const std::filesystem::path& file, const ZarrJson& object, const char* key);

/// A list of whole numbers from `least` on, one at least. \throws FileError
std::vector<std::uint64_t> numbersOf(const std::filesystem::path& file, const ZarrJson& object,
                                     const char* key, std::uint64_t least);

}  // namespace adaptiso::detail
