#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso::python {

/// The value of a word that Python gives. \throws InvalidInput  "<argument> 'x': must be one of
/// ..."
template <class Value>
Value choose(const char* argument, const std::string& word,
             const std::vector<std::pair<const char*, Value>>& choices) {
    std::string words;
    for (const auto& [name, value] : choices) {
        if (word == name) return value;
        words += (words.empty() ? "" : ", ") + std::string(name);
    }
    throw InvalidInput(std::string(argument) + " '" + word + "': must be one of " + words);
}

Method methodOf(const std::string& word);
Border borderOf(const std::string& word);
CoordinateFrame frameOf(const std::string& word);
std::optional<CoordinateFrame> frameOf(const std::optional<std::string>& word);
Profile profileOf(const std::string& word);

}  // namespace adaptiso::python
