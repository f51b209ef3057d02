#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Json/Json.h"
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
        addPart(words, std::string(name));
    }
    throw InvalidInput(std::string(argument) + " '" + word + "': must be one of " + words);
}

CoordinateFrame frameOf(const std::string& word);
std::optional<CoordinateFrame> frameOf(const std::optional<std::string>& word);

/// An entry of adaptiso-check's `surfaces`: verdict and facts.
/// \param solids  as separateSolids() gives them for `mesh`
Json surfaceVerdict(const TriangleMesh& mesh, const CheckRules& rules,
                    std::span<const Solid> solids = {});

/// adaptiso-check's report of nested surfaces: passed, surfaces, nesting.pairs.
/// \param gapsMm  required of each pair; empty: rules.minGapMm of all
Json nestedJson(std::span<const TriangleMesh* const> meshes, std::span<const std::string> names,
                std::span<const double> gapsMm, const CheckRules& rules);

std::string dumped(const Json& json);

}  // namespace adaptiso::python
