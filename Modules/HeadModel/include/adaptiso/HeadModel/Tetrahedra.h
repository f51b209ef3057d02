#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// The volume of a head in tetrahedra, each of one tissue.
struct TetrahedralMesh {
    std::vector<Vec3> points;
    std::vector<std::array<VertexId, 4>> tetrahedra;  ///< of positive volume
    std::vector<std::int32_t> tissues;                ///< one a tetrahedron: tissueNumber()
};

/// SimNIBS's number of what lies within a surface of a model of `count`: 2 brain, 3 CSF, 4 skull, 5
/// scalp.
std::int32_t tissueNumber(HeadSurface surface, std::size_t count);
/// "brain", "csf", "skull", "scalp"
std::string_view tissueName(std::int32_t number);

/// What tetgen is given: the surfaces as facets, and a point of each layer with its tissue and the
/// largest volume of an element. \param surfaces  nested, sound, from inside out, mm; the least gap
/// between them is above 0.2 mm \param elementMm  longest edge of an equilateral element
std::string tetgenInput(std::span<const TriangleMesh> surfaces, double elementMm);

/// The same for gmsh: a script that merges surface files (STL, from inside out) and fills the
/// layers.
std::string gmshInput(std::span<const std::string> surfaceFiles, double elementMm);

/// What tetgen wrote (.node, .ele with attributes) or gmsh (.msh 2.2). Elements of negative volume
/// are turned. \throws FileError  "<name>: what is wrong"
TetrahedralMesh decodeTetgen(std::string_view nodes, std::string_view elements,
                             std::string_view name);
TetrahedralMesh decodeGmsh(std::string_view bytes, std::string_view name);

/// What is known of tetrahedra.
struct TetrahedraReport {
    std::int64_t unlabelled = 0;                     ///< of no tissue of the model
    std::int64_t flat = 0;                           ///< of volume 0 or less
    std::vector<std::int64_t> counts;                ///< by layer, from inside out
    std::vector<double> volumesMm3;                  ///< the same
    std::vector<double> expectedMm3;                 ///< between the surfaces
    double leastDihedralDeg = 0, p5DihedralDeg = 0;  ///< of each element's least
    double mostRadiusEdge = 0,
           p95RadiusEdge = 0;  ///< circumscribed radius by shortest edge; 0.61 at best
};
/// \param surfaces  those that the mesh was made from
TetrahedraReport checkTetrahedra(const TetrahedralMesh& mesh,
                                 std::span<const TriangleMesh> surfaces);

/// Writes tetrahedra with their tissues: Gmsh's .msh 2.2 (as SimNIBS takes it) and 4.1, text, names
/// of tissues as physical names; .vtu with the array "tissue"; .dgf, as DUNE and DUNEuro take it.
/// \throws FileError
void writeMsh22(const TetrahedralMesh& mesh, const std::filesystem::path& path);
void writeMsh41(const TetrahedralMesh& mesh, const std::filesystem::path& path);
void writeVtu(const TetrahedralMesh& mesh, const std::filesystem::path& path);
void writeDgf(const TetrahedralMesh& mesh, const std::filesystem::path& path);

}  // namespace adaptiso
