#pragma once

#include <vector>

#include "BemRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// The report of a run; the run must outlive it.
/// \param surfaces  the model's, or, where there is none, those that it was tried from; LPS mm
Report makeReport(const BemRun& run, const std::vector<TriangleMesh>& surfaces);

}  // namespace adaptiso
