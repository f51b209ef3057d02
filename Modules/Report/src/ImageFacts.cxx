#include "adaptiso/Report/ImageFacts.h"

#include "adaptiso/Core/Numbers.h"

namespace adaptiso {

std::vector<ReportFact> imageFacts(const std::string& name, const std::string& format,
                                   const ImageGeometry& geometry) {
    const Vec3 spacing = geometry.spacingMm();
    const auto mm = [](double value) { return formatNumber(std::stod(formatLength(value, 4))); };
    return {{"Image", name + " (" + format + ")"},
            {"Voxels", std::to_string(geometry.size[0]) + " × " + std::to_string(geometry.size[1]) +
                           " × " + std::to_string(geometry.size[2])},
            {"Voxel size", mm(spacing.x) + " × " + mm(spacing.y) + " × " + mm(spacing.z) + " mm"}};
}

}  // namespace adaptiso
