#pragma once

#include "MeshRun.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// The report of a run whose surfaces are to be shown; they are moved out of it.
/// \param volume  must outlive the report
Report makeReport(MeshRun& run, const VolumeView& volume);

}  // namespace adaptiso
