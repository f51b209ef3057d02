#pragma once

#include "Common/Json.h"
#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso {

/// An image's place, as the reports have it: sizeVoxels, spacingMm, originMm, direction (LPS mm).
inline Json geometryJson(const ImageGeometry& geometry) {
    Json directions = Json::array();  // rows, as ITK and NRRD users know them
    Mat3 direction;
    for (int axis = 0; axis < 3; ++axis) {
        direction.column[axis] = normalized(geometry.indexToPhysical.column[axis]);
    }
    for (const Vec3& row : transpose(direction).column) directions.push_back(vector(row));
    return {{"sizeVoxels", geometry.size},
            {"spacingMm", vector(geometry.spacingMm())},
            {"originMm", vector(geometry.originMm)},
            {"direction", directions}};
}

}  // namespace adaptiso
