#pragma once

#include <cstdint>
#include <optional>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

struct SimplifyOptions {
    std::optional<double> maxErrorMm;  ///< > 0
    std::optional<std::int64_t> maxTriangles;
    double minAngleDeg = 0;  ///< no smaller one is made
    ProgressCallback progress;
};

struct SimplifiedWalls {
    LabelComplex complex;
    double errorBoundMm = 0;
};

/// Walls of few triangles within a proved distance of the full ones, each wall of itself, that
/// cross nothing and leave every voxel centre in its region and the topology as it is.
///
/// Edges collapse, cheapest first [Garland1997], as far as quick tests let them. Then the distance
/// is proved and crossings are looked for, exactly; what breaks a promise is taken back. That is
/// done in cubes side by side, and again in cubes cut elsewhere; for a count in all at once.
SimplifiedWalls simplifyWalls(LabelComplex&& full, const ImageGeometry& geometry,
                              const SimplifyOptions& options);

}  // namespace adaptiso::detail
