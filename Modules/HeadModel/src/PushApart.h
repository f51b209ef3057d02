#pragma once

#include <optional>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/Finding.h"

namespace adaptiso {

struct PushOptions {
    double minGapMm = 0;
    double maxMoveMm = 0;
    bool isOutward = true;  ///< `surface` is to lie around `fixed`; else inside it
};

/// Moves vertices of `surface` until it lies on the right side of `fixed`, at least minGapMm away
/// everywhere, and does not cross itself.
/// \return  none when that is so; else what stands in the way, and `surface` is of no use
std::optional<Finding> pushApart(TriangleMesh& surface, const TriangleMesh& fixed,
                                 const PushOptions& options);

}  // namespace adaptiso
