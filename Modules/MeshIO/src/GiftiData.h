#pragma once

#include <string_view>

#include "ByteSink.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso::meshio {

/// GIFTI files of values at points. decodePointData() checks what is read, and names the file.
PointData decodeGiftiData(std::string_view bytes);
void encodeGiftiData(const PointData& data, ByteSink& sink);

}  // namespace adaptiso::meshio
