#pragma once

#include "LabelsRun.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// Moves single points of the walls to neighbouring coordinates, so that what is sound is so in
/// the files of the run as well, whose coordinates have fewer digits. All files have the same
/// points, so neighbours stay equal. all.surf.gii is left out, with a warning, where its digits do
/// not do.
/// \throws InvalidInput  those of the format that was asked for, or of the layers, do not
void fitToFiles(LabelComplex& complex, LabelsRun& run);

/// The walls with the digits of the regions' files; LPS mm.
LabelComplex asStored(const LabelComplex& complex, const LabelsRun& run);

}  // namespace adaptiso
