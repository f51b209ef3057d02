#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// A surface of which some triangles were to stay.
struct KeepingSimplified {
    static constexpr std::int64_t kNew = -1;

    TriangleMesh mesh;                     ///< with normals where the input has them
    std::vector<std::int64_t> inputPoint;  ///< of each point, the input's with its bits, or kNew
    std::vector<std::uint8_t> isKept;      ///< of each triangle: it is one that was to stay
    double errorBoundMm = 0;               ///< proved, both ways, as of simplify()
};

/// Simplifies a surface as simplify() does, but for triangles and borders, which stay.
/// \param isKept  of each triangle
/// \param within  no new vertex lies outside of it; null: anywhere
/// \param mends   as simplifyWithin()
/// \return  none where nothing could be proved, or the mesh is no manifold of triangles with areas
std::optional<KeepingSimplified> simplifyKeeping(const TriangleMesh& mesh,
                                                 const std::vector<std::uint8_t>& isKept,
                                                 double maxErrorMm, const BoundingBox* within,
                                                 bool mends = true);

}  // namespace adaptiso::detail
