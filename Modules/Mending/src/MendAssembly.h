#pragma once

#include <cstdint>
#include <vector>

#include "MendInput.h"
#include "MendRegion.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// Where a triangle of the result comes from.
enum class MendSource : std::uint8_t {
    Kept,   ///< it is the input's
    Cut,    ///< of what the region leaves of one
    Moved,  ///< new, in a cell that the input passes
    Filled  ///< new, where there was no surface
};

/// The input without the region, and new surface within it.
struct MendAssembly {
    TriangleMesh mesh;
    std::vector<MendSource> source;    ///< of a triangle
    std::vector<std::uint64_t> cell;   ///< of a new one; 0 for others
    std::vector<std::int64_t> origin;  ///< the prepared input's triangle; -1 of a new one
    /// Of the prepared input, outside of the region and not in the result: parts of triangles, and
    /// whose they are.
    std::vector<Corners> inner;
    std::vector<std::uint32_t> innerOf;
    /// Cells to add to the region where the input could not be cut: the rest says nothing then.
    std::vector<std::uint64_t> trouble;
    double thinnedMm = 0;  ///< new surface was within this of what it became, both ways
};

void dropTriangles(MendAssembly& assembly, const std::vector<std::uint8_t>& isDropped);

MendAssembly assemble(const MendInput& input, const MendRegion& region, const WindingField& field,
                      const MendLattice& lattice);

}  // namespace adaptiso::detail
