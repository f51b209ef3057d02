#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// The layers between nested surfaces, from inside out, as meshers take them, and as regions with
/// SimNIBS's numbers.
/// \pre  surfaces are sound, nested, and do not touch
MesherInput headMesherInput(std::span<const TriangleMesh> surfaces);
std::vector<TetrahedraRegion> headRegions(std::span<const TriangleMesh> surfaces);

/// The tissues of a model of `count` surfaces: four or more, also those that it does not have, so
/// that a tissue's place is its number less the first one's; and the conductivity of each, S/m.
std::vector<TetrahedraRegion> allTissues(std::size_t count);
std::vector<double> tissueConductivities(const ConductivityModel& model, std::size_t count);

}  // namespace adaptiso
