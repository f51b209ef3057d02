#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "MendAssembly.h"

namespace adaptiso::detail {

/// Pieces that marked triangles make up, hanging together by points, the widest first; and their
/// triangles.
std::vector<std::pair<MendedPlace, std::vector<std::int64_t>>> connectedPlaces(
    const TriangleMesh& mesh, const std::vector<std::uint8_t>& isMarked);

/// Takes new surface and caps for moved where they lie within the bound of the input as a whole,
/// for filled where they do not.
void findBridges(const MendInput& input, const MendLattice& lattice, double boundMm,
                 MendAssembly& assembly);

/// Encloses both distances, and lists what of the input lies farther from the result than the
/// bound. Adds statistics.movedMm to both.
/// \param cellsWithSurface  that had new surface before it was thinned, ascending
void proveDistances(const MendInput& input, const AabbTree& tree, const WindingField& field,
                    const MendRegion& region, const MendLattice& lattice,
                    const std::vector<std::uint64_t>& cellsWithSurface,
                    const MendAssembly& assembly, double boundMm, MendStatistics& statistics);

}  // namespace adaptiso::detail
