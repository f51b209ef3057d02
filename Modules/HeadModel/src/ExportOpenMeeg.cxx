#include "adaptiso/HeadModel/ExportOpenMeeg.h"

#include <array>
#include <charconv>

#include "OpenMeegNames.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

constexpr std::array<const char*, kHeadSurfaceCount> kInterfaces{"Inner", "Outer", "Scalp"};
constexpr std::array<const char*, kHeadSurfaceCount> kDomains{"Brain", "Skull", "Skin"};

void requireCount(std::size_t surfaces, const char* function) {
    if (surfaces == 1 || surfaces == kHeadSurfaceCount) return;
    throw InvalidInput(std::string(function) + ": " + std::to_string(surfaces) +
                       " surfaces, must be 1 or 3");
}

std::string text(double value) {
    std::array<char, 64> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace

std::string openMeegGeometry(std::span<const std::string> triangleFiles) {
    const std::size_t count = triangleFiles.size();
    requireCount(count, "openMeegGeometry");
    std::string geometry =
        std::string(openmeeg::kGeometryHeader) + "\n\nInterfaces " + std::to_string(count) + "\n\n";
    for (std::size_t n = 0; n < count; ++n) {
        geometry += std::string("Interface ") + kInterfaces[n] + ": \"" + triangleFiles[n] + "\"\n";
    }
    geometry += "\nDomains " + std::to_string(count + 1) + "\n\n";
    for (std::size_t n = 0; n < count; ++n) {
        geometry += std::string("Domain ") + kDomains[n] + ":";
        if (n > 0) geometry += std::string(" +") + kInterfaces[n - 1];
        geometry += std::string(" -") + kInterfaces[n] + "\n";
    }
    return geometry + "Domain Air: +" + kInterfaces[count - 1] + "\n";
}

std::string openMeegConductivities(std::size_t surfaces, const ConductivityModel& model) {
    requireCount(surfaces, "openMeegConductivities");
    checkConductivities(model);
    std::string lines = std::string(openmeeg::kConductivityHeader) + "\n\n";
    for (std::size_t n = 0; n < surfaces; ++n) {
        lines +=
            std::string(kDomains[n]) + " " + text(model.within(static_cast<HeadSurface>(n))) + "\n";
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
