#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Common/CliNames.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// Adds --input-coordinates, which states the frame of surfaces that are read: once for all of
/// them, or once for each, in their order. \param surfaces  the surfaces meant, for --help: "A and
/// B" \return          --input-coordinates
CLI::Option* declareInputCoordinates(CLI::App& app, std::vector<CoordinateFrame>& stated,
                                     const std::string& surfaces);

/// \throws UsageError  frames that are neither one for all surfaces nor one for each
void checkInputCoordinates(const std::vector<CoordinateFrame>& stated, std::size_t surfaces);

/// The frame stated for surface `n`; empty: as its file says.
std::optional<CoordinateFrame> statedFrame(const std::vector<CoordinateFrame>& stated,
                                           std::size_t n);

/// The frame of a report page where no file says one.
inline constexpr const char* kUnsaidFrame = "the file's own frame, which it does not say";
inline constexpr const char* kStateIt =
    "; state it by --input-coordinates ras, lps, tkras or voxel";

/// The frame that several surfaces have been brought to.
struct CommonFrame {
    /// Ras; or TkRas where nothing says where its volume lies in the scanner.
    CoordinateFrame frame = CoordinateFrame::Ras;
    bool isKnown = true;                  ///< else no file says one; points are as if it were Ras
    std::optional<ImageGeometry> volume;  ///< for TkRas, as lpsToFrame() needs it
    std::vector<Warning> warnings;        ///< what had to be assumed

    std::optional<CoordinateFrame> known() const {
        return isKnown ? std::optional(frame) : std::nullopt;
    }
};

/// A surface as read, and the name it goes by in messages.
struct NamedMesh {
    std::filesystem::path path;
    MeshFile file;
};

/// Files of one format that say no frame are taken to share it.
bool areOfOneFormat(const NamedMesh& a, const NamedMesh& b);

/// Brings surfaces to one frame: afterwards all meshes are in LPS mm, or, when the common frame is
/// TkRas, in the LPS of a stand-in volume, which differs by a rigid move.
///
/// Surfaces that do not say their frame are taken to share one, with a warning, where none does and
/// all are of one format. Surfaces in tkRAS that do not all say of which volume are taken for
/// surfaces of the same one.
/// \param image  the volume that voxel indices, and tkRAS without a volume of its own, refer to.
///               tkRAS is then that of the image if it is stored as FreeSurfer stores images, else
///               of the one FreeSurfer makes of it (as adaptiso-mesh writes it). With an image all
///               surfaces must say their frame.
/// \throws InvalidInput  a frame is not said and would be a guess; the frames differ and the files
///                       don't say how they relate; voxel indices without an image
CommonFrame bringToOneFrame(std::span<NamedMesh> meshes, const std::optional<ImageGeometry>& image);

}  // namespace adaptiso
