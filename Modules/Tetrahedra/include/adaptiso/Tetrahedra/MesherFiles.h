#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// How spaces between walls are filled with tetrahedra.
struct MesherOptions {
    std::string mesher;    ///< "tetgen" or "gmsh"; empty: they are not
    double elementMm = 5;  ///< longest edge of an equilateral tetrahedron

    bool isRequested() const { return !mesher.empty(); }
};
/// --element-size
const Options<MesherOptions>& elementOptions();

/// A space to fill: all of a region that hangs together.
struct MesherVolume {
    std::int32_t region = 1;          ///< number of the region, from 1
    std::vector<std::int32_t> walls;  ///< that bound it
    Vec3 insideMm;                    ///< a point in it
};

/// Input of a mesher: walls, each once, that do not cross (a piecewise linear complex), and the
/// spaces between them.
struct MesherInput {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> walls;  ///< of each triangle: the number of its wall, from 1
    std::vector<MesherVolume> volumes;
};

/// A point beside one of `triangles`, to which no triangle of `walls` is nearer: what is inside of
/// the one that they bound, or (`outward`) outside. \param triangles  of `walls`, not empty
/// \throws InvalidInput  none has area, or all are touched by others
Vec3 pointBeside(const TriangleMesh& walls, const AabbTree& tree,
                 std::span<const std::int64_t> triangles, bool outward);

/// A run of a mesher, in a folder of its own.
struct MesherRun {
    std::string program;
    std::vector<std::string> arguments;
    std::vector<std::pair<std::string, std::string>> inputs;  ///< names of files, and their text
    std::vector<std::string> results;                         ///< names of files, as read
    std::vector<std::string> others{};                        ///< that it writes besides
};
MesherRun mesherRun(const MesherInput& input, const MesherOptions& options);

/// The mesh in the results of a run, given as bytes in their order; labels are numbers of regions.
/// \param reason  how the program ended, unless well
/// \throws FileError  it failed, or wrote what can't be read
TetrahedralMesh mesherResult(const std::string& mesher, std::span<const std::string> results,
                             const std::optional<std::string>& reason);

/// tetgen's .poly: the walls as facets, and for each space its point, region and largest element.
/// \param elementMm  longest edge of an equilateral element
std::string tetgenInput(const MesherInput& input, double elementMm);

/// The same for gmsh: the walls (.msh 2.2), and a script that reads them and fills the spaces.
std::string gmshWalls(const MesherInput& input);
std::string gmshScript(const MesherInput& input, std::string_view wallsFile, double elementMm);

/// Reads the output of tetgen (.node, .ele with attributes) or gmsh (.msh 2.2); labels are the
/// numbers of regions. Elements of negative volume are turned. \throws FileError  "<name>: what is
/// wrong"
TetrahedralMesh decodeTetgen(std::string_view nodes, std::string_view elements,
                             std::string_view name);
TetrahedralMesh decodeGmsh(std::string_view bytes, std::string_view name);

}  // namespace adaptiso
