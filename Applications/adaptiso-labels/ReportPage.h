#pragma once

#include "LabelsRun.h"
#include "Regions.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What the page and the pictures show.
/// \param volume  behind the regions; must live as long as the report
Report makeReport(const LabelsRun& run, const RegionSurfaces& surfaces,
                  const std::string& volumeName, const VolumeView& volume);

}  // namespace adaptiso
