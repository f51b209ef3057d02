// libFuzzer target: bytes that claim to be a FIFF file of surfaces. They are refused with a
// FileError, or all triangles name points that are there and finite.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "OneLine.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"

namespace {

void requireSound(const adaptiso::TriangleMesh& mesh) {
    for (const adaptiso::Vec3& point : mesh.points) {
        if (!std::isfinite(squaredNorm(point))) std::abort();
    }
    for (const adaptiso::Triangle& triangle : mesh.triangles) {
        for (const adaptiso::VertexId vertex : triangle) {
            if (vertex < 0 || vertex >= std::ssize(mesh.points)) std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        for (const auto& surface : adaptiso::decodeFiffSurfaces(bytes, "input")) {
            requireSound(surface.mesh);
        }
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
