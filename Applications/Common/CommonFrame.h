#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// The frame that several surfaces have been brought to.
struct CommonFrame {
    /// Ras; or TkRas where nothing says where its volume lies in the scanner.
    CoordinateFrame frame = CoordinateFrame::Ras;
    std::optional<ImageGeometry> volume;  ///< for TkRas, as lpsToFrame() needs it
    std::vector<Warning> warnings;        ///< what had to be assumed
};

/// A surface as read, and the name it goes by in messages.
struct NamedMesh {
    std::filesystem::path path;
    MeshFile file;
};

/// Brings surfaces to one frame: afterwards all meshes are in LPS mm, or, when the common frame is
/// TkRas, in the LPS of a stand-in volume, which differs by a rigid move.
///
/// A surface that does not say its frame is taken for one in that of the first that does; if none
/// does, all are taken for RAS. Surfaces in tkRAS that do not all say of which volume are taken
/// for surfaces of the same one.
/// \param image  the volume that voxel indices, and tkRAS without a volume of its own, refer to.
///               tkRAS is then that of the image if it is stored as FreeSurfer stores images, else
///               of the one FreeSurfer makes of it (as adaptiso-mesh writes it).
/// \throws InvalidInput  the frames differ and the files don't say how they relate, or voxel
///                       indices without an image
CommonFrame bringToOneFrame(std::span<NamedMesh> meshes, const std::optional<ImageGeometry>& image);

}  // namespace adaptiso
