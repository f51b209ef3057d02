#include "adaptiso/HeadPipeline/BemRules.h"

#include <algorithm>
#include <array>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/SourceError.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

constexpr double kMostGapMm = 20;

constexpr NumberRule lengthTo(double mostMm) {
    return {.least = 0, .most = mostMm, .unit = "mm"};
}

/// Options that need another.
constexpr std::array<std::pair<const char*, const char*>, 11> kNeeds{{
    {"brain-mask", "t1"},
    {"aseg", "t1"},
    {"lesion", "t1"},
    {"pial", "t1"},
    {"white", "t1"},
    {"volume", "surfaces"},
    {"head-mask", "labels"},
    {"preset", "labels"},
    {"tissue", "labels"},
    {"electrodes-in", "electrodes"},
    {"source-count", "sources"},
}};

using Fault = std::optional<std::string>;

Fault faultOfNumbers(const BemModelOptions& options) {
    const BoundaryOptions& head = options.boundaries;
    for (const auto& row : boundaryOptions()) {
        const double value = std::get<double>(row.valueOf(head));
        if (row.facts.rule.allows(value)) continue;
        return "{" + std::string(row.facts.name) + "} " + formatNumber(value) + ": must be " +
               toWords(row.facts.rule);
    }
    const auto [least, most] =
        std::minmax({head.minSkullMm, head.minScalpMm, head.minCsfMm, head.minGreyMm});
    if (!(least >= CheckRules::kLeastGapMm) || !(most <= kMostGapMm)) {
        return "{min-gap} must be " + formatNumber(CheckRules::kLeastGapMm) +
               " mm or more, as adaptiso-check wants it, and at most " + formatNumber(kMostGapMm);
    }
    if (const auto& edges = options.edgeLengthMm;
        edges && (!(edges->minimumMm > 0) || !(edges->minimumMm <= edges->maximumMm))) {
        return "{edge-length} must be 0 < MIN <= MAX";
    }
    for (const std::int64_t count : options.vertices) {
        if (count >= kLeastBemVertices && count <= kMostBemVertices) continue;
        return "{vertices} " + std::to_string(count) + ": must be a whole number from " +
               std::to_string(kLeastBemVertices) + " to " + std::to_string(kMostBemVertices);
    }
    try {
        checkConductivities(options.conductivities);
    } catch (const InvalidInput& error) {
        return std::string("{conductivity}: ") + error.what();
    }
    return std::nullopt;
}

/// All that a lead field lacks, in one line; empty: nothing.
std::string missingForLeadField(const BemModelOptions& options, const BemRequest& request) {
    const auto has = [&](std::string_view name) { return request.given.contains(name); };
    const std::pair<bool, std::string> needs[] = {
        {has("electrodes") || has("montage"), "{electrodes} or {montage}"},
        {has("sources") || has("source-grid"), "{sources} or {source-grid}"},
        {options.hasSkin(), "a skin (not with {meg})"},
        {request.missingSolver.empty(), request.missingSolver},
    };
    std::string missing;
    for (const auto& [isThere, need] : needs) {
        if (!isThere) addPart(missing, need, "; ");
    }
    return missing;
}

Fault faultOfInputs(const BemModelOptions& options, const BemRequest& request,
                    const BemNaming& naming) {
    const auto has = [&](std::string_view name) { return request.given.contains(name); };
    const auto sources =
        std::ranges::count_if(std::array{"t1", "labels", "probabilities", "ct", "surfaces"}, has);
    if (sources != 1) {
        return "one of {t1}, {labels}, {probabilities}, {ct}, {surfaces} must be given, and one "
               "only";
    }
    for (const auto& [option, needed] : kNeeds) {
        if (has(option) && !has(needed)) {
            return "{" + std::string(option) + "} needs {" + needed + "}";
        }
    }
    const bool withBrain = options.boundaries.innerSurfaces > 0;
    const bool withWhite = options.boundaries.innerSurfaces > 1;
    const bool isOne = options.boundaries.innerSkullOnly;
    const std::string count = std::to_string(options.surfaceCount());
    const std::size_t sigmas = options.conductivitiesGiven;
    const TissueLabels& tissues = request.tissues;
    const bool hasLabels = has("labels");
    const std::string presetOr = naming("preset") == naming("tissue") ? "" : "{preset}, or ";
    const std::string& preset = request.preset;
    const std::string leadFieldNeeds =
        has("lead-field") ? missingForLeadField(options, request) : "";
    const std::pair<bool, std::string> faults[] = {
        {withBrain && isOne, "{layers} 4 or 5 and {meg} exclude each other"},
        {withBrain && has("ct"),
         "{layers} " + count +
             " does not go with {ct}: a CT does not show where the brain ends and CSF "
             "begins"},
        {sigmas == 4 && count != "4", "{conductivity}: four numbers need {layers} 4"},
        {(sigmas == 5) != withWhite && sigmas > 0,
         "{conductivity}: five numbers and {layers} 5 need each other"},
        {withWhite && has("t1") && !has("aseg") && !has("white"),
         "{layers} 5 needs {aseg} or {white}: a T1 alone does not show white matter"},
        {has("input-coordinates") && !has("surfaces") && !has("pial") && !has("white") &&
             !has("sources"),
         "{input-coordinates} needs {surfaces}, {pial}, {white} or {sources}"},
        {hasLabels && tissues.brain.empty() && !tissues.othersAreBrain,
         "{labels} needs " + presetOr + "{tissue} brain=..., skull=... and scalp=..."},
        {hasLabels && withBrain && tissues.csf.empty(),
         "{layers} " + count + " needs {tissue} csf=... as well"},
        {hasLabels && withWhite && tissues.white.empty(),
         "{layers} 5 needs {tissue} white=... as well"},
        {hasLabels && !isOne && !preset.empty() && !tissues.skull.empty() &&
             tissues.scalp.empty() && !has("head-mask"),
         preset + " has no scalp: give {head-mask} (or {meg})"},
        {hasLabels && !isOne &&
             (tissues.skull.empty() || (tissues.scalp.empty() && !has("head-mask"))),
         "{labels} needs {tissue} skull=... and scalp=... as well (or {head-mask}, or {meg})"},
        {isOne && !tissues.spongy.empty(), "{tissue} spongy=... needs a skull: not with {meg}"},
        {has("surfaces") && request.surfaces != options.surfaceCount(),
         "{surfaces} needs " + count + " files, inside out"},
        {has("sources") && (request.sources < 1 || request.sources > 2),
         "{sources} must be one or two surfaces"},
        {!leadFieldNeeds.empty(), "{lead-field} needs " + leadFieldNeeds},
        {options.vertices.size() > 1 && options.vertices.size() != options.surfaceCount(),
         "{vertices} must be one number, or " + count},
    };
    for (const auto& [isBroken, rule] : faults) {
        if (isBroken) return rule;
    }
    return std::nullopt;
}

Fault faultOfCombinations(const BemModelOptions& options, const BemRequest& request) {
    const auto has = [&](std::string_view name) { return request.given.contains(name); };
    const BoundaryOptions& head = options.boundaries;
    constexpr double kAirHu = -1000, kSoftTissueHu = 40;
    const bool areHuGood =
        head.skinHu > kAirHu && head.skinHu < head.skullHu && head.skullHu > kSoftTissueHu;
    const double skullMm =
        head.skullMm == 0 && !has("skull") ? UsualHead(head.ageYears).skullMm : head.skullMm;
    const bool isSkullGood = skullMm >= head.minSkullMm && skullMm <= head.maxSkullMm;
    if (!(head.maxSkullMm > head.minSkullMm)) return "{max-skull} must be more than {min-gap}";
    if (has("t1") && !isSkullGood && !has("skull") && has("age")) {
        return "the skull's usual thickness at {age} does not lie between {min-gap} and "
               "{max-skull}";
    }
    if (has("t1") && !isSkullGood) return "{skull} must lie between {min-gap} and {max-skull}";
    if (has("ct") && !areHuGood) {
        return "{skin-hu} must lie above air (-1000 HU) and below {skull-hu}, and that above soft "
               "tissue (40 HU)";
    }
    const bool hasMontage = has("montage");
    if (has("sources") && has("source-grid")) {
        return "{sources} and {source-grid} exclude each other";
    }
    if (has("electrodes") && hasMontage) return "{electrodes} and {montage} exclude each other";
    if ((has("electrodes") || hasMontage || has("nasion")) && !options.hasSkin()) {
        return "electrodes and landmarks need a skin: not with {meg}";
    }
    return std::nullopt;
}

}  // namespace

const Options<SourceOptions>& sourceOptions() {
    static const Options<SourceOptions> kRows{
        option<&SourceOptions::count>(
            {.name = "source-count",
             .key = "sourceCount",
             .valueName = "N",
             .help = "Sources of each surface of the cortex, spread evenly",
             .standard = "4098",
             .rule = {.least = 1, .most = 1'000'000}}),
        option<&SourceOptions::gridMm>({.name = "source-grid",
                                        .key = "sourceGridMm",
                                        .valueName = "MM",
                                        .help = "Dipoles along x, y and z at the points of a grid "
                                                "instead of on a cortex, this far apart",
                                        .rule = {.least = 1, .most = 50, .unit = "mm"}}),
    };
    return kRows;
}

const Options<BoundaryOptions>& boundaryOptions() {
    static const Options<BoundaryOptions> kRows{
        option<&BoundaryOptions::sulciMm>(
            {.name = "sulci",
             .key = "sulciMm",
             .valueName = "MM",
             .help =
                 "Sulci of the brain's own surface narrower than twice this, and folds of white "
                 "matter narrower than four times this, are closed",
             .standard = "3",
             .rule = lengthTo(30)}),
        option<&BoundaryOptions::smoothingMm>(
            {.name = "smoothing",
             .key = "smoothingMm",
             .valueName = "MM",
             .help = "Standard deviation of the Gaussian that boundaries are smoothed with",
             .standard = "1.5",
             .rule = lengthTo(10)}),
        option<&BoundaryOptions::closingMm>(
            {.name = "closing",
             .key = "closingMm",
             .valueName = "MM",
             .help = "Gaps and canals narrower than twice this are closed",
             .standard = "10",
             .rule = lengthTo(30)}),
        option<&BoundaryOptions::cutNecksMm>(
            {.name = "cut-necks",
             .key = "cutNecksMm",
             .valueName = "MM",
             .help = "Cut off what of the inner skull a ball of this radius can't enter and that "
                     "reaches more than 10 mm, as leaks down a foramen do",
             .standard = "8; 0: cut nothing",
             .rule = lengthTo(20)}),
        option<&BoundaryOptions::stepMm>(
            {.name = "voxel",
             .key = "voxelMm",
             .valueName = "MM",
             .help = "Side of the voxels that the head is worked on",
             .standard = "the image's own if they are cubes of 0.7 to 1.5 mm, else 1",
             .rule = lengthTo(5)}),
        option<&BoundaryOptions::csfMm>({.name = "csf",
                                         .key = "csfMm",
                                         .valueName = "MM",
                                         .help = "T1: from the brain mask to the inner skull",
                                         .standard = "2",
                                         .rule = lengthTo(20)}),
        option<&BoundaryOptions::skullMm>(
            {.name = "skull",
             .key = "skullMm",
             .valueName = "MM",
             .help = "T1: thickness of the skull where the image does not show it",
             .standard = "6, below 18 years by --age: 2 of newborns, 4 at 5 years",
             .rule = lengthTo(200)}),
        option<&BoundaryOptions::maxSkullMm>(
            {.name = "max-skull",
             .key = "maxSkullMm",
             .valueName = "MM",
             .help = "Bone farther than this from the inner skull (face, neck) counts as scalp",
             .standard = "20",
             .rule = lengthTo(200)}),
        option<&BoundaryOptions::ageYears>({.name = "age",
                                            .key = "ageYears",
                                            .valueName = "YEARS",
                                            .help =
                                                "Age, 0.5 for six months: T1s of infants and "
                                                "children need it; what is unusual is judged by "
                                                "it",
                                            .standard = "18, adults",
                                            .rule = {.least = 0, .most = 120, .unit = "years"}}),
        option<&BoundaryOptions::skullHu>({.name = "skull-hu",
                                           .key = "skullHu",
                                           .valueName = "HU",
                                           .help = "CT: isovalue of bone",
                                           .standard = "300",
                                           .rule = {.unit = "HU"}}),
        option<&BoundaryOptions::skinHu>({.name = "skin-hu",
                                          .key = "skinHu",
                                          .valueName = "HU",
                                          .help = "CT: isovalue of skin",
                                          .standard = "-300",
                                          .rule = {.unit = "HU"}})};
    return kRows;
}

bool setLayers(BemModelOptions& options, std::int64_t layers) {
    if (layers != 1 && (layers < 3 || layers > 5)) return false;
    if (layers == 1) options.boundaries.innerSkullOnly = true;
    options.boundaries.innerSurfaces = layers > 3 ? static_cast<std::size_t>(layers - 3) : 0;
    options.conductivities = standardConductivities(static_cast<std::size_t>(layers));
    return true;
}

bool setMinGaps(BemModelOptions& options, std::span<const double> gapsMm) {
    if (gapsMm.empty() || gapsMm.size() > 4) return false;
    options.boundaries.minSkullMm = gapsMm.front();
    options.boundaries.minScalpMm = gapsMm.size() > 1 ? gapsMm[1] : gapsMm.front();
    if (gapsMm.size() > 2) options.boundaries.minCsfMm = gapsMm[2];
    if (gapsMm.size() > 3) options.boundaries.minGreyMm = gapsMm[3];
    return true;
}

bool setEdgeLengths(BemModelOptions& options, std::span<const double> lengthsMm) {
    if (lengthsMm.size() != 2) return false;
    options.edgeLengthMm = EdgeLengthRange{lengthsMm[0], lengthsMm[1]};
    return true;
}

bool setConductivities(BemModelOptions& options, std::span<const double> sigmas) {
    const std::size_t count = sigmas.size();
    if (count < 3 || count > 5) return false;
    options.conductivitiesGiven = count;
    for (std::size_t n = 0; n < count; ++n) {
        options.conductivities.*tissueWithin(headSurface(n, count), count).conductivity = sigmas[n];
    }
    return true;
}

std::string named(const std::string& text, const BemNaming& naming) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t begin = text.find('{', at), end = text.find('}', begin);
        result += text.substr(at, begin - at);
        if (end == std::string::npos) break;
        result += naming(text.substr(begin + 1, end - begin - 1));
        at = end + 1;
    }
    return result;
}

std::string bemFault(const BemModelOptions& options, const BemRequest& request,
                     const BemNaming& naming) {
    Fault fault = faultOfInputs(options, request, naming);
    if (!fault) fault = faultOfNumbers(options);
    if (!fault) fault = faultOfCombinations(options, request);
    return fault ? named(*fault, naming) : "";
}

HeadBoundaries findBoundaries(const BemModel& model, const BemImages& images, const BemHooks& hooks,
                              const BemNaming& naming) {
    HeadBoundaries found;
    BoundaryOptions options = model.options.boundaries;
    options.progress = hooks.progress;
    const auto find = [&]() -> HeadBoundaries {
        switch (model.source) {
            case BemSource::T1:
                return boundariesFromT1(images.main.front(), images.brain, options);
            case BemSource::Labels:
                return boundariesFromLabels(images.main.front(), images.tissues, options,
                                            images.headMask);
            case BemSource::Probabilities:
                return boundariesFromProbabilities(images.main, options);
            case BemSource::Ct:
                return boundariesFromCt(images.main.front(), options);
            case BemSource::Surfaces:
                break;
        }
        throw InternalError("findBoundaries: surfaces are no image");
    };
    try {
        hooks.stage("boundaries", [&] { found = find(); });
        return found;
    } catch (const SourceError& error) {
        const char* name = "pial";
        if (error.source() == BoundarySource::White) name = "white";
        if (error.source() == BoundarySource::Lesion) name = "lesion";
        if (error.source() == BoundarySource::HeadMask) name = "head-mask";
        if (error.source() == BoundarySource::BrainMask) {
            name = images.brain.mask ? "brain-mask" : "aseg";
        }
        throw InvalidInput(naming(name) + ": " + error.what());
    } catch (const InvalidInput& error) {
        throw InvalidInput(naming(toString(model.source)) + ": " + error.what());
    }
}

}  // namespace adaptiso
