#pragma once

#include <vector>

#include "RemeshTarget.h"
#include "adaptiso/HeadModel/Remesh.h"

namespace adaptiso {

/// A length wanted at a vertex of the target's surface.
struct SizeSeed {
    VertexId vertex;
    double sizeMm;
};

/// The largest field that no seed exceeds and that grows by at most 0.2 mm a mm along edges: one
/// length per vertex of the surface.
std::vector<double> spreadSizes(const RemeshTarget& target, const std::vector<SizeSeed>& seeds);

/// Lengths by bending (half a radian over an edge) and by the distance to neighbours, within
/// `range`: one length per vertex of the target's surface.
std::vector<double> adaptiveSizes(const RemeshTarget& target, const EdgeLengthRange& range,
                                  const std::vector<const TriangleMesh*>& neighbours);

}  // namespace adaptiso
