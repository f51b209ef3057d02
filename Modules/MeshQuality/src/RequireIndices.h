#pragma once

#include <string>
#include <string_view>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// \throws InvalidInput naming `function` when a triangle names a point that is not there
inline void requireIndices(const TriangleMesh& mesh, std::string_view function) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        for (const VertexId v : mesh.triangles[n]) {
            if (v >= 0 && v < count) continue;
            throw InvalidInput(std::string(function) + ": triangle " + std::to_string(n) +
                               " names vertex " + std::to_string(v) + " of a mesh with " +
                               std::to_string(count) + " points");
        }
    }
}

}  // namespace adaptiso
