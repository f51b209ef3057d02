#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::giant {

/// A connected part of a piece's surface. Sums over pieces make those of a component.
struct PieceComponent {
    std::int64_t triangles = 0;
    std::int64_t innerVertices = 0;  ///< that no other piece has
    double areaMm2 = 0;
    double volumeMm3 = 0;  ///< of the cones from the image's middle to its triangles, signed
};

/// A vertex on the border of a piece: another piece may have it too, with the same bits.
struct BorderVertex {
    std::uint32_t vertex = 0, component = 0;
    Vec3 index;
};

/// The facts of a piece that its neighbours and the join need.
struct PieceSummary {
    std::string plan;    ///< SHA-256 of GiantPlan::identity()
    std::string stage;   ///< "tile" or "seam"
    std::string id;      ///< "3_0_12"
    std::string inputs;  ///< SHA-256 of what it was made of
    double errorBoundMm = 0;
    bool isUnchanged = false;  ///< could not be simplified within a proved bound
    std::int64_t points = 0, triangles = 0;
    std::vector<PieceComponent> components;
    std::vector<BorderVertex> border;
    std::vector<std::array<std::uint32_t, 2>> borderEdges;  ///< numbers in `border`
};

/// A piece of a surface, as a step leaves it: of a tile, or of a seam box.
struct Piece {
    PieceSummary summary;
    TriangleMesh mesh;  ///< continuous indices of the volume
};

/// Counts, measures and border of a mesh of continuous indices.
void summarize(const TriangleMesh& mesh, const ImageGeometry& geometry, PieceSummary& summary);

/// The file's bytes, little-endian: "ADAPTPC2", the length of a JSON header (uint64), the header,
/// components, border vertices and edges, and SHA-256 of all that; then points, normals, triangles,
/// and SHA-256 of those.
std::string encodePiece(const Piece& piece);

/// Bytes as a file has them, taken for hostile: all counts, indices and sums are checked.
/// \param name  for messages \throws FileError
Piece decodePiece(std::string_view bytes, const std::string& name);

Piece readPiece(const std::filesystem::path& file);
/// The first part of the file alone. \throws FileError
PieceSummary readPieceSummary(const std::filesystem::path& file);

}  // namespace adaptiso::giant
