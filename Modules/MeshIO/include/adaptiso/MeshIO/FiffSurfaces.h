#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

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

/// Reads all surfaces of such a file.
/// \throws FileError  "<file>: what is wrong; what to do"; also where there is no surface, or one
///                    is not in MRI coordinates, or a triangle names a point that is not there
std::vector<FiffSurface> readFiffSurfaces(const std::filesystem::path& path);

/// The same from bytes in memory.
std::vector<FiffSurface> decodeFiffSurfaces(std::string_view bytes, std::string_view name);

}  // namespace adaptiso
