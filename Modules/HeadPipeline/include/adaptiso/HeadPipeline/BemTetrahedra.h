#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {

/// Takes the tetrahedra that a mesher made of headMesherInput(model.meshes), LPS mm: keeps those of
/// the layers, checks them (a failed check becomes a finding), and gives those in holes of the
/// segmentation's skull to the scalp. Fills the model's tetrahedra, checks and notes.
/// \pre model.hasModel()
void takeTetrahedra(TetrahedralMesh mesh, const MesherOptions& options, BemModel& model);

}  // namespace adaptiso
