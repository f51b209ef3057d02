#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// SimNIBS's number of what lies within a surface of a model of `count`: 2 brain, 3 CSF, 4 skull, 5
/// scalp.
std::int32_t tissueNumber(HeadSurface surface, std::size_t count);
/// "brain", "csf", "skull", "scalp"
std::string_view tissueName(std::int32_t number);

/// The layers between nested surfaces, from inside out, as meshers take them, and as regions.
/// \pre  surfaces are sound, nested, and do not touch
MesherInput headMesherInput(std::span<const TriangleMesh> surfaces);
std::vector<TetrahedraRegion> headRegions(std::span<const TriangleMesh> surfaces);

/// All four tissues, also those that a model does not have, so that a tissue's place is its number
/// less 2; and the conductivity of each, S/m.
std::vector<TetrahedraRegion> allTissues();
std::vector<double> tissueConductivities(const ConductivityModel& model);

}  // namespace adaptiso
