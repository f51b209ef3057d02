#pragma once

#include <vector>

#include "BemRun.h"
#include "Common/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Reads the surfaces of --surfaces and mends what of them needs it:
///   what adaptiso-check finds no fault with (but for the gaps) stays as it came;
///   a closed ball with vertices, triangles or small pieces of no use loses them; one with needles
///   or flat triangles is to be remeshed; where one is open, crosses itself, has a handle or loose
///   pieces, all are made anew from the solids that they bound.
/// Fills the run's surfaces, inputs, warnings and notes; sizes that are no head's become findings.
/// \return  LPS mm, inside out; as they came when the run got findings
/// \throws FileError, InvalidInput
std::vector<TriangleMesh> readySurfaces(BemRun& run, ProgressLine& progress);

}  // namespace adaptiso
