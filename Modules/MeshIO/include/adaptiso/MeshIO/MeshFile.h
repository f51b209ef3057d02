#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

/// An RGB colour.
using Color = std::array<std::uint8_t, 3>;

/// Values at the points of a mesh: numbers, colours, or whole numbers, which may be labels.
struct PointArray {
    std::string name;  ///< as ParaView and PyVista list it
    std::variant<std::vector<double>, std::vector<Color>, std::vector<std::int64_t>> values;
    int components = 1;  ///< numbers for each point, one after the other; 1 of colours

    /// Points that it has values for.
    std::size_t points() const {
        const auto size = [](const auto& each) { return each.size(); };
        return std::visit(size, values) / static_cast<std::size_t>(components);
    }
};

/// A whole number for every triangle of a mesh.
struct CellArray {
    std::string name;
    std::variant<std::vector<std::int32_t>, std::vector<std::int64_t>, std::vector<std::uint64_t>>
        values;

    std::size_t cells() const {
        return std::visit([](const auto& each) { return each.size(); }, values);
    }
};

struct MeshWriteOptions {
    CoordinateFrame frame = CoordinateFrame::Ras;
    /// The volume that the surface was made from. TkRas and Voxel need it; a FreeSurfer surface
    /// in TkRas keeps it in its footer.
    std::optional<ImageGeometry> volume;
    /// FreeSurfer footer only: the volume's file name, without folder and without anything that
    /// names a patient. Empty: "unknown". Printable ASCII without space, '/', '\\', '='.
    std::string volumeName;
    /// Where the format holds them (MeshFormat::holdsPointArrays): written with the mesh, in VTK's
    /// formats the first as the active scalars. PLY has no names with blanks and no arrays of
    /// several components: blanks become _, and components arrays of their own. OBJ and OFF hold
    /// one array of colours alone (MeshFormat::holdsColors).
    std::vector<PointArray> pointArrays{};
    /// Where the format holds them (MeshFormat::holdsCellArrays): written beside the mesh.
    std::vector<CellArray> cellArrays{};
    /// The mesh is in `frame` already, as readMesh() gives it, and is written as it is. TkRas and
    /// Voxel then do without `volume`.
    bool isInFrame = false;
    /// Names the frame in the file, where its format can.
    bool saysFrame = true;
};

/// Writes a surface in the format that the file's name asks for (findMeshFormat()).
///
/// The same mesh and options give the same bytes: no date, user or machine is written. The file
/// is written in place; a caller who wants whole files or none writes to a temporary name and
/// renames.
///
/// FreeSurfer surfaces are taken for TkRas by every reader. With frame TkRas the footer holds
/// `volume`. With Ras or Lps the footer describes a neutral volume (256^3, 1 mm) so placed that
/// its tkRAS is the very frame written: FreeSurfer, freeview and nibabel, which go from tkRAS to
/// scanner RAS through the footer, find the right place; MNE, which does not look at it, needs
/// TkRas. TkRas without a volume has a footer that says of itself that it is not valid. (The other
/// way to say it, tag 2 useRealRAS = 1, makes nibabel and MNE drop the footer.)
///
/// OpenMEEG's .tri holds normals always: area-weighted ones where the mesh has none. It says
/// neither frame nor unit. STL holds triangles only: vertices that no triangle uses are lost.
///
/// \param mesh  LPS mm
/// \throws InvalidInput  unknown extension; frame without its volume, or that the format can't
///         hold; a mesh without triangles, with a triangle's index out of range, a coordinate
///         that is not finite (or too large for float), normals that are not one per point,
///         more elements than the format can count; arrays that the format can't hold, or that are
///         not one value per point or triangle
/// \throws FileError     the file can't be written (no such folder, no permission, disk full)
void writeMesh(const TriangleMesh& mesh, const std::filesystem::path& path,
               const MeshWriteOptions& options = {});

struct MeshReadOptions {
    /// Reads what is wrong with the mesh too, for those who look for it: coordinates that are not
    /// finite, triangles and polygons that name points which aren't there. Normals that are not one
    /// a point, or not finite, are then left out.
    bool keepsFaults = false;
    bool keepsPointArrays = false;  ///< else they are passed over
    /// The frame of the points, overriding the file's own; empty: as the file says.
    std::optional<CoordinateFrame> inputCoordinates{};
    /// Where the data of a GIFTI file may lie that are in a file of their own; readMesh() takes the
    /// surface's folder. Empty: such files are refused.
    std::filesystem::path folder{};
    std::size_t storedBytes = 0;  ///< of the file that the bytes were unpacked from; 0: of none
    /// The surface of a FIFF file with several; empty: the one that the file's name has behind a
    /// colon.
    std::string part{};
};

/// A file's content as stored: nothing is moved to another frame, but by GIFTI's matrix to
/// scanner space where the frame that it leads from has no name.
struct MeshFile {
    /// At least 1 triangle; indices in range and all finite unless options.keepsFaults.
    TriangleMesh mesh;
    std::optional<CoordinateFrame> frame;  ///< if the file says so
    /// For frame TkRas from a FreeSurfer surface's footer, or FreeSurfer's VolGeom in GIFTI; for
    /// frame Voxel by GIFTI's matrix to scanner space (without a size).
    std::optional<ImageGeometry> volume;
    /// One value a point each; names hold no control characters. PLY's red, green and blue are one
    /// array of colours, "RGB", and so are those of OBJ and OFF.
    std::vector<PointArray> pointArrays{};
    /// With options.keepsPointArrays: names of arrays that were passed over, of triangles, of text
    /// and of more than nine components, and GIFTI's beside the surface.
    std::vector<std::string> arraysLeftOut{};
    /// Number of the first triangle of each solid, mesh or object of the file, ascending; empty:
    /// the file holds one.
    std::vector<std::int64_t> solids{};
    const MeshFormat* format = nullptr;  ///< as its content says; never null after reading
    std::vector<Warning> warnings{};     ///< of reading; without the file's name
};

/// Reads a triangle surface, gzipped or not, in the format that its content says, whatever the
/// file's name; the extension decides where content does not (recognizeMeshFormat()).
///
/// Files are taken for hostile: only regular files are opened, no other file is opened on their
/// word but for GIFTI's external data, plain files in the surface's own folder, and no count in
/// them is believed beyond what the file's size can hold. Polygons and triangle strips are cut into
/// triangles, with a warning (polygons-cut). STL corners with equal coordinates become one vertex,
/// numbered by first use. OBJ normals are kept if no vertex has two. GIFTI and FreeSurfer files
/// hold no normals.
///
/// A frame is read from our own marks and from 3D Slicer's; a file whose marks contradict each
/// other is refused unless options.inputCoordinates states its frame. GIFTI: points are in RAS
/// where DataSpace is one of NIfTI's spaces; else in tkRAS where there is FreeSurfer's VolGeom, but
/// for files that Connectome Workbench has changed, which may keep a VolGeom that no longer holds.
///
/// \throws FileError  "<file>: what is wrong; what to do"; images, archives, pointers of git-lfs
///                    and formats that are not read are named
MeshFile readMesh(const std::filesystem::path& path, const MeshReadOptions& options = {});

/// The same from bytes in memory (pipes, archives, fuzzers).
MeshFile decodeMesh(std::string_view bytes, std::string_view name,
                    const MeshReadOptions& options = {});

/// The same in a format that is known.
/// \throws FileError  "<name>: what is wrong; what to do"
MeshFile decodeMesh(std::string_view bytes, const MeshFormat& format, std::string_view name,
                    const MeshReadOptions& options = {});

/// A PLY file that is written piece by piece, for surfaces that memory does not hold: first all
/// points, then all triangles. What comes out is what writeMesh() writes of the whole.
class PlyStream {
public:
    /// \param options  frame alone counts: the mesh is in it already
    /// \throws InvalidInput  more points or triangles than PLY's 32 bits can number
    /// \throws FileError     the file can't be written
    PlyStream(const std::filesystem::path& path, const MeshWriteOptions& options,
              std::int64_t points, std::int64_t triangles, bool hasNormals);
    ~PlyStream();
    PlyStream(const PlyStream&) = delete;
    PlyStream& operator=(const PlyStream&) = delete;

    /// \param normal  passed over where there are none
    void addPoint(const Vec3& point, const Normal& normal);
    void addTriangle(const Triangle& triangle);

    /// \pre all that was announced was added \throws InternalError otherwise, FileError
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// For every point the sum of the area vectors of the triangles around it, of unit length: for
/// formats that hold normals always. A point that no triangle uses has (0, 0, 0).
/// \pre triangles name points that are there
std::vector<Normal> areaWeightedNormals(const TriangleMesh& mesh);

}  // namespace adaptiso
