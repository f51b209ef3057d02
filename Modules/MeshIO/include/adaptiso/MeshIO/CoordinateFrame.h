#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace adaptiso {

/// The frame in which a file holds its points. Inside the library it is always Lps.
enum class CoordinateFrame {
    Ras,    ///< scanner right-anterior-superior, mm (NIfTI, nibabel, 3D Slicer's display)
    Lps,    ///< scanner left-posterior-superior, mm (DICOM, ITK)
    TkRas,  ///< FreeSurfer surface RAS ("tkRAS") of one volume's geometry, mm
    Voxel,  ///< continuous voxel indices (i, j, k) of one volume, from 0 at the first voxel's
            ///< centre
};

/// The name written into files: "RAS mm", "LPS mm", "tkRAS mm", "voxel indices".
std::string_view toString(CoordinateFrame frame);

/// What comments and header lines say: "CoordinateFrame: RAS mm".
std::string frameMarker(CoordinateFrame frame);

/// The frame that a text names with frameMarker()'s words, wherever they stand in it.
std::optional<CoordinateFrame> findFrameMarker(std::string_view text);

/// The frame of this name (as toString() gives it), if it is one.
std::optional<CoordinateFrame> parseCoordinateFrame(std::string_view name);

/// 3D Slicer's name of a frame, "RAS" or "LPS": the value of the field data array SPACE in its VTK
/// XML files. Empty for the other frames, which Slicer does not know.
std::string_view slicerName(CoordinateFrame frame);

/// 3D Slicer's mark in header lines and comments, "SPACE=RAS" or "SPACE=LPS"; empty for the other
/// frames. Slicer takes surfaces without a mark for LPS.
std::string slicerMarker(CoordinateFrame frame);

}  // namespace adaptiso
