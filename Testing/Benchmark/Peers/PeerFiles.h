#pragma once

#include <filesystem>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso::benchmarks {

// Volumes and meshes between the programs of one benchmark run: plain bytes of this machine, so
// that no reader's time or memory is in the measurement. Not an exchange format.

/// \throws FileError when the file can't be written
void writeVolumeFile(const std::filesystem::path& path, const VolumeView& volume);
/// \throws FileError when the file can't be read or is not one of writeVolumeFile's
Volume readVolumeFile(const std::filesystem::path& path);

/// Points and triangles; normals are left out. \throws FileError when it can't be written
void writeMeshFile(const std::filesystem::path& path, const TriangleMesh& mesh);
/// \throws FileError when the file can't be read or is not one of writeMeshFile's
TriangleMesh readMeshFile(const std::filesystem::path& path);

}  // namespace adaptiso::benchmarks
