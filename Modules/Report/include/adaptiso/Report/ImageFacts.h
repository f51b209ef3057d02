#pragma once

#include <string>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// Size, voxel and format of an image, in words.
std::vector<ReportFact> imageFacts(const std::string& name, const std::string& format,
                                   const ImageGeometry& geometry);

}  // namespace adaptiso
