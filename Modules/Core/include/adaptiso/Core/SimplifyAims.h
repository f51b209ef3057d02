#pragma once

#include <cstdint>
#include <optional>

#include "adaptiso/Core/Options.h"

namespace adaptiso {

/// How far a surface is simplified. With a bound and a count, triangles are dropped until either
/// stops it.
struct SimplifyAims {
    /// Two-sided: no point of the given surface is farther from the result, no point of the result
    /// farther from that surface, mm.
    std::optional<double> maxErrorMm{};
    std::optional<std::int64_t> maxTriangles{};  ///< to simplify to. \pre >= 0
    /// Share of the triangles to drop, 0 to 1: a count by another name.
    std::optional<double> reduction{};
    /// Angles below this are not made where there was none, and where there was, none smaller
    /// still; but where single places are mended in the end. Takes more triangles. \pre 0 to 40,
    /// degrees
    double minAngleDeg = 0;

    friend bool operator==(const SimplifyAims&, const SimplifyAims&) = default;
};

/// \param mayBeZero  a bound of 0
/// \throws InvalidInput  one is out of range: "`function`: minAngleDeg must lie between 0 and 40"
void requireInRange(const SimplifyAims& aims, const char* function, bool mayBeZero = false);

enum class AimedSurface {
    OfScan,  ///< an isosurface: --max-error has a default
    Mesh,    ///< any mesh, in any unit
    Walls    ///< between the regions of a label map: a bound of 0 keeps them whole
};

/// A row for each.
const Options<SimplifyAims>& aimOptions(AimedSurface surface);

}  // namespace adaptiso
