#pragma once

#include "SimplifyRun.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::simplifier {

/// What the page tells and shows.
/// \param input  as read
/// \param shown  the result, in the input's frame; empty: the surface was refused
Report makeReport(const SimplifyRun& run, const MeshFile& input, TriangleMesh shown);

}  // namespace adaptiso::simplifier
