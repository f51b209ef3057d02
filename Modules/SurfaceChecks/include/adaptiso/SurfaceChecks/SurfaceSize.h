#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshQuality/Topology.h"

// One of two compared surfaces, as adaptiso-compare and the Python package measure it.

namespace adaptiso {

struct SurfaceSize {
    std::int64_t triangles = 0;
    std::int64_t vertices = 0;
    double areaMm2 = 0;
    std::optional<double> volumeMm3;  ///< empty unless closed and oriented
    double diagonalMm = 0;            ///< of the bounding box
};

/// \throws InvalidInput, which begins with `name`, for a surface without area
inline SurfaceSize measureSize(const TriangleMesh& mesh, const std::string& name) {
    SurfaceSize size{std::ssize(mesh.triangles), std::ssize(mesh.points), surfaceArea(mesh), {}, 0};
    if (!(size.areaMm2 > 0)) {
        throw InvalidInput(name + ": its triangles have no area, so there is nothing to measure");
    }
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    if (topology.isClosed() && topology.isOriented()) size.volumeMm3 = enclosedVolume(mesh);
    size.diagonalMm = norm(boundingBox(mesh).size());
    return size;
}

/// `begin` with the measures.
inline Json sizeJson(const SurfaceSize& size, Json begin = Json::object()) {
    begin.update({{"triangles", size.triangles},
                  {"vertices", size.vertices},
                  {"areaMm2", number(size.areaMm2)},
                  {"volumeMm3", orNull(size.volumeMm3)},
                  {"boundingBoxDiagonalMm", number(size.diagonalMm)}});
    return begin;
}

}  // namespace adaptiso
