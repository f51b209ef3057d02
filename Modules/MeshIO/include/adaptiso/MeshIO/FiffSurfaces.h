#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// A surface of a boundary element model as MNE's files have it. Points are in metres, in "MRI
/// coordinates": FreeSurfer's surface RAS (tkRAS) of the subject's T1.
struct FiffSurface {
    /// FIFF's number of the surface: 1 brain, the inner skull of head models; 3 skull; 4 head.
    std::int32_t id = 0;
    double conductivity = 0;  ///< of the compartment within, S/m
    TriangleMesh mesh;
};

/// Writes surfaces in one file, as mne.write_bem_surfaces does; mne.read_bem_surfaces reads it.
/// Normals are written where a mesh has them. The same surfaces give the same bytes.
/// \throws InvalidInput  no surface, or more points or triangles than FIFF can count
/// \throws FileError     the file can't be written
void writeFiffSurfaces(std::span<const FiffSurface> surfaces, const std::filesystem::path& path);

/// Places of dipoles as MNE's source spaces (-src.fif) have them, in metres and MRI coordinates.
struct FiffSources {
    static constexpr std::int32_t kLeftHemisphere = 101, kRightHemisphere = 102;
    std::int32_t id = kLeftHemisphere;  ///< not of a grid
    TriangleMesh mesh;                  ///< with normals; of a grid its points alone, x fastest
    std::vector<std::int64_t> used;     ///< numbers of the points that are sources

    /// Size and place of a grid of points, and those of the image.
    struct Grid {
        std::array<std::int32_t, 3> size, imageSize;
        AffineTransform toMri, imageToMri, mriToRas;  ///< offsets in metres
    };
    std::optional<Grid> grid{};
};

/// Writes a file that mne.read_source_spaces() reads. \throws as writeFiffSurfaces()
void writeFiffSources(std::span<const FiffSources> sources, const std::filesystem::path& path);

/// Writes a -trans.fif, which mne.read_trans() reads: head coordinates to MRI coordinates.
/// \param metres  its offset is in metres \throws FileError  the file can't be written
void writeFiffHeadToMri(const AffineTransform& metres, const std::filesystem::path& path);

/// Reads back files of these two. Of grids the normals, which mean nothing, too.
/// \throws FileError  "<file>: what is wrong; what to do"
std::vector<FiffSources> readFiffSources(const std::filesystem::path& path);
AffineTransform readFiffHeadToMri(const std::filesystem::path& path);

/// Reads all surfaces of a file.
/// \throws FileError  "<file>: what is wrong; what to do"; also where there is no surface, or one
///                    is not in MRI coordinates, or a triangle names a point that is not there
std::vector<FiffSurface> readFiffSurfaces(const std::filesystem::path& path);

/// `path` or, where it is a FIFF file of several surfaces, a path that readMesh() takes for each,
/// inside out: "model-bem.fif:inner_skull", "model-bem.fif:outer_skull",
/// "model-bem.fif:outer_skin".
std::vector<std::filesystem::path> surfacePaths(const std::filesystem::path& path);

/// The same from bytes in memory.
std::vector<FiffSurface> decodeFiffSurfaces(std::string_view bytes, std::string_view name);

}  // namespace adaptiso
