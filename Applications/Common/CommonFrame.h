#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// Adds --input-coordinates, which states the frame of surfaces that are read: once for all of
/// them, or once for each, in their order.
/// \param surfaces  for --help: "A and B"
void declareInputCoordinates(const OptionGroup& group, std::vector<CoordinateFrame>& stated,
                             const std::string& surfaces);

/// Adds --coordinates, the frame of files to write.
/// \param words  the frames to choose from
void declareCoordinates(const OptionGroup& group, const std::function<void(CoordinateFrame)>& take,
                        const std::string& help, const std::vector<std::string>& words);

/// \param target  a CoordinateFrame, or an optional one
template <class Target>
void declareCoordinates(const OptionGroup& group, Target& target, const std::string& help,
                        const std::vector<std::string>& words = {"ras", "lps", "tkras", "voxel"}) {
    declareCoordinates(
        group,
        std::function<void(CoordinateFrame)>([&target](CoordinateFrame frame) { target = frame; }),
        help, words);
}

/// \throws UsageError  frames that are neither one for all surfaces nor one for each
void checkInputCoordinates(const std::vector<CoordinateFrame>& stated, std::size_t surfaces);

/// The frame stated for surface `n`; empty: as its file says.
std::optional<CoordinateFrame> statedFrame(const std::vector<CoordinateFrame>& stated,
                                           std::size_t n);

inline constexpr const char* kStateIt =
    "; state it by --input-coordinates ras, lps, tkras or voxel";

/// "RAS mm", "frame not said"
std::string frameText(const std::optional<CoordinateFrame>& frame);
/// "bone.stl (STL, RAS mm)"
std::string fileText(const std::filesystem::path& file, const MeshFormat& format,
                     const std::optional<CoordinateFrame>& frame);

/// The frame that several surfaces have been brought to.
struct CommonFrame {
    /// Ras; or TkRas where nothing says where its volume lies in the scanner.
    CoordinateFrame frame = CoordinateFrame::Ras;
    bool isKnown = true;                  ///< else no file says one; points are as if it were Ras
    std::optional<ImageGeometry> volume;  ///< for TkRas, as lpsToFrame() needs it
    std::vector<Warning> warnings;        ///< assumptions made

    std::optional<CoordinateFrame> known() const {
        return isKnown ? std::optional(frame) : std::nullopt;
    }
};

/// A surface as read, and the name it goes by in messages.
struct NamedMesh {
    std::filesystem::path path;
    MeshFile file;
};

/// Files of one format that say no frame are taken to share it, and so are the printers' formats,
/// STL and 3MF.
bool areOfOneFormat(const NamedMesh& a, const NamedMesh& b);

/// Brings surfaces to one frame: afterwards all meshes are in LPS mm, or, when the common frame is
/// TkRas, in the LPS of a stand-in volume, which differs by a rigid move.
///
/// Surfaces that do not say their frame are taken to share one, with a warning, where none does and
/// all areOfOneFormat(). Surfaces in tkRAS that do not all say of which volume are taken for
/// surfaces of the same one.
/// \param image  the volume that voxel indices, and tkRAS without a volume of its own, refer to.
///               tkRAS is then that of the image if it is stored as FreeSurfer stores images, else
///               of the one FreeSurfer makes of it (as adaptiso-mesh writes it). With an image all
///               surfaces must say their frame.
/// \param remedy  for messages: what relates frames that the files do not
/// \throws InvalidInput  a frame is not said and would be a guess; the frames differ and the files
///                       don't say how they relate; voxel indices without an image
CommonFrame bringToOneFrame(std::span<NamedMesh> meshes, const std::optional<ImageGeometry>& image,
                            const std::string& remedy = "give the image by --volume");

/// The format that the name of a file to write asks for. \throws UsageError  it names none
const MeshFormat& meshFormatOf(const std::filesystem::path& file);

/// The frame of a file to write: `wanted`, or the format's own.
/// \throws UsageError  the format cannot hold voxel indices
CoordinateFrame outputFrame(std::optional<CoordinateFrame> wanted, const MeshFormat& format);

/// It ends with a slash, or is a folder that is there and not named like a file of meshes.
bool isFolder(const std::filesystem::path& path);

/// Refuses a folder to make, the value of `option`, that is named like a file of meshes.
/// \param instead  what to give instead \throws UsageError
void requireFolderName(const std::string& option, const std::filesystem::path& folder,
                       const std::string& instead);

/// A hint for a file that cannot be read as an image: it is a surface, and which programs read
/// surfaces. Empty if it cannot be read as a surface either.
std::string surfaceHint(const std::filesystem::path& file);

}  // namespace adaptiso
