#pragma once

// Files of several meshes (GLB, 3MF), read as one surface.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

/// A mesh of a file as it is placed there, and what it has of colours.
struct PlacedMesh {
    TriangleMesh mesh{};
    std::vector<Color> colors{};   ///< of its points; else empty
    std::optional<Color> color{};  ///< of all of it
};

/// Makes points with equal coordinates one, the first of them: programs split them where faces
/// have normals or texture coordinates of their own. Normals and colours that differ are dropped.
void mergeEqualPoints(PlacedMesh& placed);

/// Joins the meshes of a file, in their order.
class JoinedMeshes {
public:
    /// \param transform  from the mesh's own coordinates to those of the surface
    /// \throws FileError  it flattens the mesh, or is not finite
    void add(PlacedMesh&& placed, const AffineTransform& transform);

    /// Warns where there are several. Normals are kept where all have them, colours (with
    /// options.keepsPointArrays) where all have them.
    void moveTo(MeshFile& file, const MeshReadOptions& options) &&;

private:
    TriangleMesh mesh_;
    std::vector<Color> colors_;
    std::vector<std::int64_t> solids_;  ///< the first triangle of each
    bool haveNormals_ = true, haveColors_ = true;
};

/// Whether `transform` leaves points where they are, rounding aside; false with NaN.
bool isIdentity(const AffineTransform& transform);

}  // namespace adaptiso::meshio
