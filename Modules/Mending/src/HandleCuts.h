#pragma once

#include <optional>

#include "MendAssembly.h"

namespace adaptiso::detail {

struct HandlesGone {
    double movedMm = 0;           ///< no point of the surface that was is farther from what is
    std::optional<Vec3> stuckMm;  ///< at a handle for which there is no disc
};

/// Makes every piece of a closed, oriented 2-manifold one of genus 0.
///
/// A handle goes by a plane section that does not part its piece, and whose flat disc meets the
/// surface nowhere else: a band along it goes, and two flat caps close the rims. Where the disc
/// lies in the solid this cuts it, elsewhere it fills a tunnel. Sections are looked for across and
/// along the shortest loops of a homology basis [Erickson2005]; the smallest disc is taken.
/// \param reachMm     what goes lies within this of what stays
/// \param statistics  gets `cutHandles` and `filledHandles`
HandlesGone removeHandles(MendAssembly& assembly, double reachMm, MendStatistics& statistics);

}  // namespace adaptiso::detail
