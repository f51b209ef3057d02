#include "adaptiso/Json/Json.h"

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

std::string jsonText(const Json& json, int indent) {
    std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
    if (withoutControls(text, "\n") == text) return text;
    return json.dump(indent, ' ', true, Json::error_handler_t::replace);
}

std::string_view frameWord(CoordinateFrame frame) {
    constexpr const char* kWords[] = {"ras", "lps", "tkras", "voxel"};
    return kWords[static_cast<std::size_t>(frame)];
}

Json geometryJson(const ImageGeometry& geometry) {
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
