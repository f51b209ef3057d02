#pragma once

#include <string_view>

#include "ByteSink.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso::meshio {

/// FreeSurfer's .mgh with values at points. decodePointData() checks what is read, and names the
/// file.
PointData decodeMghData(std::string_view bytes);
void encodeMghData(const PointData& data, ByteSink& sink);

}  // namespace adaptiso::meshio
