#include "adaptiso/Mending/Mend.h"

namespace adaptiso {

const Options<MendOptions>& mendOptions() {
    static const Options<MendOptions> kRows{
        option<&MendOptions::maxErrorMm>(
            {.name = "max-error",
             .key = "maxErrorMm",
             .label = "Largest error",
             .valueName = "MM",
             .help =
                 "Largest distance, both ways, between the given surface and the result, but for "
                 "holes that are closed and parts that are dropped, in the unit of its coordinates",
             .standard = "0.2 % of the diagonal of the surface's box",
             .rule = {.least = 0, .isAbove = true, .unit = "mm"}}),
        option<&MendOptions::maxHoleMm>({.name = "max-hole",
                                         .key = "maxHoleMm",
                                         .label = "Widest hole to close",
                                         .valueName = "MM",
                                         .help = "Refuse (exit code 1) holes wider than this",
                                         .standard = "5 % of the diagonal",
                                         .rule = {.least = 0, .unit = "mm"}}),
        option<&MendOptions::leavesHolesOpen>({.name = "open",
                                               .key = "leavesHolesOpen",
                                               .label = "Wider holes left open",
                                               .help = "Leave wider holes open instead"}),
        option<&MendOptions::removesHandles>(
            {.name = "ball",
             .key = "removesHandles",
             .label = "Genus 0",
             .help =
                 "Cut or fill every handle, by the smallest flat disc found, so that each piece "
                 "is of genus 0"})};
    return kRows;
}

}  // namespace adaptiso
