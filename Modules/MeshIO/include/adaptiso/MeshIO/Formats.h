#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

namespace meshio {
struct Codec;
}

/// Precision of a format's coordinates.
enum class CoordinatePrecision {
    Float64,     ///< the very double
    Float32,     ///< rounded to single precision: 24 bits, 8 nm at 100 mm
    NineDigits,  ///< text of nine significant digits: 0.1 nm at 100 mm
};

/// Capabilities of a file format.
struct MeshFormat {
    std::string_view name;                         ///< for people: "STL"
    std::span<const std::string_view> extensions;  ///< lower case, with the dot
    const meshio::Codec* codec;                    ///< recognises, reads and writes it
    CoordinatePrecision precision;
    CoordinateFrame defaultFrame;  ///< that its users expect
    bool holdsNormals;             ///< normals given to writeMesh() come back from readMesh()
    bool holdsFrame;               ///< the file names its coordinate frame
    bool holdsVoxelFrame;          ///< its points may be voxel indices rather than mm
    bool holdsVolumeGeometry;  ///< the geometry of the volume comes back (CoordinateFrame::TkRas)
    bool holdsPointArrays;     ///< values at points come back (MeshReadOptions::keepsPointArrays)
    bool holdsColors;          ///< so does a colour for each point
    bool holdsCellArrays;      ///< MeshWriteOptions::cellArrays are written
    bool sharesVertices;       ///< vertices no triangle uses, and their order, come back
    std::int64_t maxElements;  ///< largest number of points, and of triangles
};

/// The formats that are both read and written, in the order in which help texts list them.
std::span<const MeshFormat> meshFormats();

/// Their extensions: ".vtp .vtk ...".
std::string meshExtensions();

/// The format to write, by a file's name alone: the extension, whatever its case ("lh.pial" has the
/// extension ".pial").
/// \throws InvalidInput  no format has this extension; the message lists those that are known
const MeshFormat& findMeshFormat(const std::filesystem::path& path);

/// Number of first bytes that recognizeMeshFormat() looks at.
inline constexpr std::size_t kMeshHeadBytes = std::size_t{1} << 16;

/// The format of a surface by its content, whatever the file's name; FIFF, which is read alone,
/// too.
///
/// \param head       the file's first kMeshHeadBytes bytes, all of a shorter file; unpacked
/// \param byteCount  of the whole file
/// \return           null if unrecognisable: STL that is cut off, OFF without its word
const MeshFormat* recognizeMeshFormat(std::string_view head, std::uint64_t byteCount);

}  // namespace adaptiso
