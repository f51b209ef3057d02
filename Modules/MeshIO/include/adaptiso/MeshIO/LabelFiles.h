#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// A number that stands for a region, as a label table lists it.
struct LabelKey {
    std::int32_t key = 0;
    std::string name;  ///< UTF-8 without control characters
    Color color{};
};

/// Writes the labels of a surface's points as a GIFTI file of their own, as Connectome Workbench,
/// FreeSurfer, nilearn and nibabel take them: the label table and one array of keys. The surface
/// goes into another file (writeMesh(), .gii), as those who read it expect no third array there.
///
/// \param labels  the key of each point of the surface, in its order
/// \param table   keys ascending; 0, "???", is put before them unless it is there
/// \throws InvalidInput  no label, or more than GIFTI can count
/// \throws FileError     the file can't be written
void writeGiftiLabels(std::span<const std::int32_t> labels, std::span<const LabelKey> table,
                      const std::filesystem::path& path);

/// A part of a multiblock file.
struct VtkBlock {
    std::string name;  ///< UTF-8 without control characters
    std::string file;  ///< a .vtp, relative to the multiblock file
};

/// Writes a VTK XML multiblock file (.vtm): ParaView, PyVista and VTK open the blocks as one.
/// \throws FileError  the file can't be written
void writeMultiBlock(std::span<const VtkBlock> blocks, const std::filesystem::path& path);

}  // namespace adaptiso
