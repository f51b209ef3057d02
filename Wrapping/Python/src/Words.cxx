#include "Words.h"

#include <utility>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"

namespace adaptiso::python {

CoordinateFrame frameOf(const std::string& word) {
    using enum CoordinateFrame;
    std::vector<std::pair<const char*, CoordinateFrame>> words;
    for (const CoordinateFrame frame : {Ras, Lps, TkRas, Voxel}) {
        words.emplace_back(frameWord(frame).data(), frame);
    }
    return choose("frame", word, words);
}

std::optional<CoordinateFrame> frameOf(const std::optional<std::string>& word) {
    if (!word) return std::nullopt;
    return frameOf(*word);
}

Json surfaceVerdict(const TriangleMesh& mesh, const CheckRules& rules,
                    std::span<const Solid> solids) {
    SurfaceFacts facts =
        measureSurface(mesh, sizeLimitsOf(rules.profileInUse()), rules.maxPairs, solids);
    if (rules.measuresWalls) measureWallsOf(mesh, rules.wallLimitMm(), facts, solids);
    Json json = verdictJson(judgeSurface(facts, rules));
    json.update(factsJson(facts));
    return json;
}

Json nestedJson(std::span<const TriangleMesh* const> meshes, std::span<const std::string> names,
                std::span<const double> gapsMm, const CheckRules& rules) {
    Json surfaces = Json::array(), pairs = Json::array();
    bool hasPassed = true;
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        Json surface{{"name", names[n]}};
        surface.update(surfaceVerdict(*meshes[n], rules));
        hasPassed = hasPassed && surface["passed"].get<bool>();
        surfaces.push_back(std::move(surface));
    }
    for (std::size_t n = 0; n + 1 < meshes.size(); ++n) {
        CheckRules pairRules = rules;
        if (!gapsMm.empty()) pairRules.minGapMm = gapsMm[n];
        const NestingReport report =
            checkNesting(*meshes[n], *meshes[n + 1], {.maxPairs = rules.maxPairs});
        Json pair{{"inner", names[n]}, {"outer", names[n + 1]}};
        pair.update(
            nestingJson(report, judgeNesting(report, names[n], names[n + 1], {}, pairRules), {}));
        hasPassed = hasPassed && pair["passed"].get<bool>();
        pairs.push_back(std::move(pair));
    }
    return {{"passed", hasPassed},
            {"surfaces", std::move(surfaces)},
            {"nesting", {{"pairs", std::move(pairs)}}}};
}

std::string dumped(const Json& json) {
    return jsonText(json, -1);
}

}  // namespace adaptiso::python
