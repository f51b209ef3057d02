#pragma once

#include "LabelsRun.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// \throws InvalidInput  a region's label is below 1, which the files of tetrahedra have no place
/// for
void requireTetrahedraLabels(const LabelsRun& run);

/// Fills the regions with tetrahedra by the mesher asked for, and checks them: run.tetrahedra and
/// run.checks. \throws FileError  the mesher fails, or writes what can't be read
void makeTetrahedra(const LabelComplex& complex, LabelsRun& run);

}  // namespace adaptiso
