#pragma once

#include "BemRun.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Fills the model's layers with tetrahedra by the mesher asked for, run as a program (stage
/// "tetrahedra"), and checks them; what does not hold becomes a finding. \pre run.model.hasModel()
/// \throws FileError  the mesher is not installed, fails, or writes what can't be read
void makeTetrahedra(BemRun& run, const BemHooks& hooks);

}  // namespace adaptiso
