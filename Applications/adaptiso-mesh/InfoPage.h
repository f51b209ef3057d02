#pragma once

#include <functional>
#include <string>

#include "Info.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::mesher {

/// The page of --info: the histogram, a coarse surface for each isovalue worth a try, and how many
/// triangles bounds cost.
/// \param volume   must outlive the report
/// \param values   of it. \pre with a histogram
/// \param commandWith  the command to copy that has these words among its options
Report infoReport(const std::string& name, const std::string& format, const VolumeView& volume,
                  const ValueSummary& values,
                  const std::function<std::string(const std::string&)>& commandWith);

}  // namespace adaptiso::mesher
