// libFuzzer target: bytes that claim to be a mesh file with the ending fuzz::ending().
// Whatever they hold, they are refused with a FileError or give a sound mesh; its solids are
// checked.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "Ending.h"
#include "OneLine.h"
#include "Zip.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

/// What decodeMesh() promises of a mesh that it does not refuse.
void requireSound(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) std::abort();
    for (const Triangle& triangle : mesh.triangles) {
        for (const VertexId vertex : triangle) {
            if (vertex < 0 || vertex >= std::ssize(mesh.points)) std::abort();
        }
    }
    for (const Vec3& p : mesh.points) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
    }
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size()) std::abort();
}

/// What it promises of the values at points.
void requireSound(const MeshFile& file) {
    for (const PointArray& array : file.pointArrays) {
        if (array.points() != file.mesh.points.size()) std::abort();
        for (const char c : array.name) {
            if (static_cast<unsigned char>(c) < ' ') std::abort();
        }
    }
}

/// As adaptiso-check looks at a file of several solids.
void checkSolids(MeshFile&& file) {
    constexpr std::int64_t kMostTriangles = 300;  // what crosses is found in more than linear time
    if (file.solids.size() < 2 || std::ssize(file.mesh.triangles) > kMostTriangles) return;
    const std::size_t before = file.mesh.triangles.size();
    const std::vector<Solid> solids = separateSolids(file.mesh, file.solids);
    const SurfaceFacts facts = measureSurface(file.mesh, sizeLimitsOf(Profile::Print), 10, solids);
    const std::size_t count = std::max<std::size_t>(1, solids.size());
    if (facts.solids != count || file.mesh.triangles.size() != before) std::abort();
}

/// \param isKnown  the format is; else content tells
void decode(std::string_view bytes, const MeshReadOptions& options, bool isKnown = true) {
    static const MeshFormat format = findMeshFormat("fuzzed" + fuzz::ending());
    try {
        MeshFile file = isKnown ? decodeMesh(bytes, format, "fuzzed", options)
                                : decodeMesh(bytes, "fuzzed" + fuzz::ending(), options);
        if (!options.keepsFaults) requireSound(file.mesh);
        requireSound(file);
        checkSolids(std::move(file));
    } catch (const FileError& refusal) {
        fuzz::requireOneLine(refusal);
    }
}

/// A 3MF whose model the bytes are: no chance would give an archive its checksums.
std::string modelArchive(std::string_view bytes) {
    std::ostringstream stream;
    ByteSink sink(stream);
    meshio::writeZip({{"3D/3dmodel.model", std::string(bytes)}}, sink);
    sink.finish();
    return std::move(stream).str();
}

}  // namespace
}  // namespace adaptiso

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    adaptiso::decode(bytes, {});
    adaptiso::decode(bytes, {.keepsFaults = true});
    adaptiso::decode(bytes, {.keepsPointArrays = true});
    adaptiso::decode(bytes, {}, false);
    if (adaptiso::fuzz::ending() == ".3mf") {
        adaptiso::decode(adaptiso::modelArchive(bytes), {.keepsPointArrays = true});
    }
    return 0;
}
