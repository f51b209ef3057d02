#include <array>

#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {
constexpr std::array<std::string_view, 3> kProfiles{"bem", "print", "view"};
}  // namespace

std::string_view toString(Profile profile) {
    return kProfiles[static_cast<std::size_t>(profile)];
}

CheckRules CheckRules::inUse() const {
    CheckRules rules = *this;
    rules.profile = profileInUse();
    rules.minGapMm = minGapMm.value_or(kLeastGapMm);
    rules.minAngleDeg = minAngleDeg.value_or(kLeastAngleDeg);
    if (measuresWalls) rules.minWallMm = wallLimitMm();
    return rules;
}

const Options<CheckRules>& ruleOptions() {
    static const Options<CheckRules> kRows{
        option<&CheckRules::profile>(
            {.name = "profile",
             .key = "profile",
             .label = "Profile",
             .help = "bem: a boundary of a head model (default with --nested); print: a solid "
                     "(default); view: to look at. See below",
             .words = kProfiles}),
        option<&CheckRules::minGapMm>(
            {.name = "min-gap",
             .key = "minGapMm",
             .label = "Smallest gap",
             .valueName = "MM",
             .help = "With --nested: smallest gap between neighbours that passes, in any profile",
             .standard = "0.5, in bem only",
             .rule = {.least = 0, .unit = "mm"}}),
        option<&CheckRules::minAngleDeg>(
            {.name = "min-angle",
             .key = "minAngleDeg",
             .label = "Smallest angle",
             .valueName = "DEG",
             .help = "Smallest angle of a triangle that passes, in any profile",
             .standard = "1, in bem only",
             .rule = {.least = 0, .most = 60, .unit = "degrees"}}),
        option<&CheckRules::minWallMm>(
            {.name = "min-wall",
             .key = "minWallMm",
             .label = "Thinnest wall",
             .valueName = "MM",
             .help = "Thinnest wall that passes, in any profile",
             .standard = "with --profile print as given a warning below 0.8",
             .rule = {.least = 0, .isAbove = true, .unit = "mm"}}),
        option<&CheckRules::maxOffMm>(
            {.name = "max-off",
             .key = "maxOffMm",
             .label = "Farthest from the isosurface",
             .valueName = "MM",
             .help = "With --iso: largest distance from the isosurface that passes",
             .standard = "the mean within half a voxel",
             .rule = {.least = 0, .unit = "mm"}})};
    return kRows;
}

const Options<CheckRules>& pairOptions() {
    static const Options<CheckRules> kRows{option<&CheckRules::maxPairs>(
        {.name = "max-pairs",
         .key = "maxPairs",
         .valueName = "N",
         .help = "List up to so many pairs of triangles that cross in the report; all are "
                 "counted",
         .standard = "1000",
         .rule = {.most = 1e9}})};
    return kRows;
}

SizeLimits sizeLimitsOf(Profile profile) {
    // MNE refuses heads with a side under 50 mm; no head with its neck is larger than 500 mm
    if (profile == Profile::Bem) return {50, 50, 500};
    return {0, 1, 2000};  // from a tooth to a whole body
}

}  // namespace adaptiso
