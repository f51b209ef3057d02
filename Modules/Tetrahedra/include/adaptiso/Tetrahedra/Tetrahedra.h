#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// A volume in tetrahedra, each of one region.
struct TetrahedralMesh {
    std::vector<Vec3> points;
    std::vector<std::array<VertexId, 4>> tetrahedra;  ///< of positive volume
    std::vector<std::int32_t> labels;                 ///< one a tetrahedron: a region's number
};

/// A region to fill: a tissue of a head, a region of a label map.
struct TetrahedraRegion {
    std::int32_t label = 0;
    std::string name;
    double mm3 = 0;       ///< within its walls
    double wallsMm2 = 0;  ///< their area
};

/// Measures of tetrahedra.
struct TetrahedraReport {
    std::int64_t unlabelled = 0;                     ///< of none of the regions
    std::int64_t flat = 0;                           ///< of volume 0 or less
    std::vector<std::int64_t> counts;                ///< by region
    std::vector<double> volumesMm3;                  ///< the same
    std::vector<double> expectedMm3;                 ///< the same: within the walls
    double leastDihedralDeg = 0, p5DihedralDeg = 0;  ///< of each element's least
    double mostRadiusEdge = 0,
           p95RadiusEdge = 0;  ///< circumscribed radius by shortest edge; 0.61 at best
};
/// Cost: O(T log T)
TetrahedraReport checkTetrahedra(const TetrahedralMesh& mesh,
                                 std::span<const TetrahedraRegion> regions);

/// A check of tetrahedra.
struct TetrahedraCheck {
    std::string name;  ///< "none flat or inverted"
    bool isPassed = false;
    std::string detail;
};
/// Conditions for useful tetrahedra: each belongs to a region, none is flat or inverted, and
/// each region has the volume within its walls: to 0.01 %, and to a thousandth of a mm of the
/// walls, as tetgen takes facets that meet at less than 0.1 degrees for one.
std::vector<TetrahedraCheck> judgeTetrahedra(const TetrahedraReport& report,
                                             std::span<const TetrahedraRegion> regions);

/// "12,345 of 2,345 points by tetgen; least dihedral angle 5.2 deg ..."
std::string describeTetrahedra(const TetrahedralMesh& mesh, const TetrahedraReport& report,
                               const std::string& mesher);

/// The mesh in another frame, each point times `linear` and `translation` more; elements are turned
/// where that mirrors them.
TetrahedralMesh transformed(TetrahedralMesh mesh, const Mat3& linear, const Vec3& translation);

/// Keeps the elements whose number is that of a region in the list, from 1, and gives them its
/// label; points that no element needs any more go. What a mesher fills besides is a space that
/// regions enclose.
void takeRegions(TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions);

/// Writes tetrahedra with their regions. Numbers have nine digits; the same mesh gives the same
/// bytes. \throws FileError  a file can't be written
///
/// Gmsh's .msh 2.2 (SimNIBS, DUNEuro) and 4.1, text; regions are physical volumes with names.
/// \param withWalls  2.2: triangles too, as SimNIBS has them: of region n the faces towards regions
///                   of larger numbers and the outside, outward, with the number 1000 + n
void writeMsh22(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path, bool withWalls = false);
void writeMsh41(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path);
/// VTK's .vtu, text, with the array "tissue" of labels.
void writeVtu(const TetrahedralMesh& mesh, const std::filesystem::path& path);
/// DUNE's .dgf. Its one parameter is the place of the region in `regions`, from 0: DUNEuro takes it
/// for a place in a list of conductivities.
void writeDgf(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
              const std::filesystem::path& path);

/// Reads back what these write, recognised by its content. Labels of a .dgf are places of regions;
/// triangles are left out. \throws FileError  "<name>: what is wrong"
TetrahedralMesh decodeTetrahedra(std::string_view bytes, std::string_view name);

/// Positive where d lies on the side of a, b, c from which these are seen clockwise.
inline double volumeOf(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    const Vec3& a = mesh.points[t[0]];
    return dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a) / 6;
}

}  // namespace adaptiso
