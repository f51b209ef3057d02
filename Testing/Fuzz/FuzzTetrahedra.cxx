// libFuzzer target: bytes that claim to be what a mesher wrote, by fuzz::ending(): .gmsh (a
// .msh of version 2.2), or .tetgen (.node, and after a byte 0 .ele). They are refused with a
// FileError, or all elements have corners that are there, at finite points.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "Ending.h"
#include "OneLine.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace {

void requireSound(const adaptiso::TetrahedralMesh& mesh) {
    if (mesh.labels.size() != mesh.tetrahedra.size()) std::abort();
    for (const auto& t : mesh.tetrahedra) {
        for (const adaptiso::VertexId v : t) {
            if (v < 0 || v >= std::ssize(mesh.points)) std::abort();
            if (!std::isfinite(squaredNorm(mesh.points[v]))) std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::string& ending = adaptiso::fuzz::ending();
    const std::size_t cut = std::min(bytes.find('\0'), size);
    try {
        adaptiso::TetrahedralMesh mesh =
            ending == ".gmsh"
                ? adaptiso::decodeGmsh(bytes, "input")
                : adaptiso::decodeTetgen(bytes.substr(0, cut),
                                         bytes.substr(std::min(cut + 1, size)), "input");
        requireSound(mesh);
        const std::vector<adaptiso::TetrahedraRegion> regions{{2, "a", 1, 1}, {3, "b", 1, 1}};
        takeRegions(mesh, regions);
        requireSound(mesh);
        static_cast<void>(judgeTetrahedra(checkTetrahedra(mesh, regions), regions));
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
