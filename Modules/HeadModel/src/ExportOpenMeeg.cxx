#include "adaptiso/HeadModel/ExportOpenMeeg.h"

#include <array>

#include "OpenMeegNames.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

constexpr std::array<const char*, kHeadSurfaceCount> kInterfaces{"WhiteMatter", "Cortex", "Inner",
                                                                 "Outer", "Scalp"};

const char* interfaceOf(std::size_t n, std::size_t count) {
    return kInterfaces[static_cast<std::size_t>(headSurface(n, count))];
}

/// Domain within surface n.
std::string domainOf(std::size_t n, std::size_t count) {
    return std::string(tissueWithin(headSurface(n, count), count).domain);
}

}  // namespace

std::string openMeegGeometry(std::span<const std::string> triangleFiles) {
    const std::size_t count = triangleFiles.size();
    headSurface(0, count);  // throws
    std::string geometry =
        std::string(openmeeg::kGeometryHeader) + "\n\nInterfaces " + std::to_string(count) + "\n\n";
    for (std::size_t n = 0; n < count; ++n) {
        geometry +=
            std::string("Interface ") + interfaceOf(n, count) + ": \"" + triangleFiles[n] + "\"\n";
    }
    geometry += "\nDomains " + std::to_string(count + 1) + "\n\n";
    for (std::size_t n = 0; n < count; ++n) {
        geometry += "Domain " + domainOf(n, count) + ":";
        if (n > 0) geometry += std::string(" +") + interfaceOf(n - 1, count);
        geometry += std::string(" -") + interfaceOf(n, count) + "\n";
    }
    return geometry + "Domain Air: +" + interfaceOf(count - 1, count) + "\n";
}

std::string openMeegConductivities(std::size_t surfaces, const ConductivityModel& model) {
    checkConductivities(model);
    std::string lines = std::string(openmeeg::kConductivityHeader) + "\n\n";
    for (std::size_t n = 0; n < surfaces; ++n) {
        lines += domainOf(n, surfaces) + " " +
                 shortestText(model.within(headSurface(n, surfaces), surfaces)) + "\n";
    }
    return lines + "Air 0\n";
}

void writeOpenMeegSurface(const TriangleMesh& surface, const std::filesystem::path& path,
                          CoordinateFrame frame, OpenMeegUnit unit,
                          const std::optional<ImageGeometry>& volume) {
    TriangleMesh scaled = toFrame(surface, frame, volume);
    if (unit == OpenMeegUnit::Metres) {
        for (Vec3& point : scaled.points) point = 0.001 * point;
    }
    // moved already: as it is now is as it is to be written
    writeMesh(fromFrame(scaled, CoordinateFrame::Ras), path, {CoordinateFrame::Ras, {}, "", {}});
}

}  // namespace adaptiso
