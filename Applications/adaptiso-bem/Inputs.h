#pragma once

#include <vector>

#include "BemRun.h"
#include "Common/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// Reads the images asked for and finds the head's boundaries in them. Fills the model's inputs,
/// warnings of reading, and image.
/// \throws FileError, InvalidInput
HeadBoundaries boundariesFromImages(BemRun& run, ProgressLine& progress);

/// Reads the surfaces asked for, in LPS mm (bringToOneFrame()), inside out.
/// \throws FileError, InvalidInput
std::vector<TriangleMesh> readSurfaces(BemRun& run);

/// Which volume's tkRAS the FreeSurfer files will be in: the subject's own mri/orig.mgz where there
/// is one, else the image's (frameVolume()), else that of the surfaces read, else none.
/// \throws FileError
void chooseTkRas(BemRun& run);

}  // namespace adaptiso
