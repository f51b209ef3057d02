#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// The frame in which a file holds its points. Inside the library it is always Lps.
enum class CoordinateFrame {
    Ras,    ///< scanner right-anterior-superior, mm (NIfTI, nibabel, 3D Slicer's display)
    Lps,    ///< scanner left-posterior-superior, mm (DICOM, ITK)
    TkRas,  ///< FreeSurfer surface RAS ("tkRAS") of one volume's geometry, mm
    Voxel,  ///< continuous voxel indices (i, j, k) of one volume, from 0 at the first voxel's
            ///< centre
};

/// True for tkRAS and voxel indices, which are those of a volume.
constexpr bool needsVolume(CoordinateFrame frame) {
    return frame == CoordinateFrame::TkRas || frame == CoordinateFrame::Voxel;
}

/// The name written into files: "RAS mm", "LPS mm", "tkRAS mm", "voxel indices".
std::string_view toString(CoordinateFrame frame);

/// Mark in comments and header lines: "CoordinateFrame: RAS mm".
std::string frameMarker(CoordinateFrame frame);

/// The frame of the first frameMarker() in a text.
std::optional<CoordinateFrame> findFrameMarker(std::string_view text);

/// The frame of this name (as toString() gives it), if it is one.
std::optional<CoordinateFrame> parseCoordinateFrame(std::string_view name);

/// 3D Slicer's name of a frame, "RAS" or "LPS": the value of the field data array SPACE in its VTK
/// XML files. Empty for the other frames, which Slicer does not know.
std::string_view slicerName(CoordinateFrame frame);

/// 3D Slicer's mark in header lines and comments, "SPACE=RAS" or "SPACE=LPS"; empty for the other
/// frames. Slicer takes surfaces without a mark for LPS.
std::string slicerMarker(CoordinateFrame frame);

/// p -> linear * p + offset.
struct AffineTransform {
    Mat3 linear;
    Vec3 offset;

    constexpr Vec3 operator()(const Vec3& p) const { return linear * p + offset; }
    friend constexpr bool operator==(const AffineTransform&, const AffineTransform&) = default;
};

/// First `b`, then `a`.
constexpr AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
    return {a.linear * b.linear, a(b.offset)};
}
/// \pre determinant(a.linear) != 0
constexpr AffineTransform inverse(const AffineTransform& a) {
    const Mat3 linear = inverse(a.linear);
    return {linear, -(linear * a.offset)};
}

/// Whether the volume's axes are at right angles, to a cosine of 1e-4.
bool hasRightAngles(const ImageGeometry& volume);

/// Voxel index -> FreeSurfer surface RAS (mm) of a volume of this geometry: FreeSurfer's
/// vox2ras-tkr (nibabel: MGHHeader.get_vox2ras_tkr), which knows only the volume's size n and
/// spacing d, not where it lies: x = dx (nx/2 - i), y = dz (k - nz/2), z = dy (ny/2 - j).
///
/// Only images whose indices are mirrored in LPS (isMirrored(); FreeSurfer's own "LIA" volumes)
/// have a tkRAS that is a rigid move of the scanner frame. For the others, which includes most
/// DICOM images as they come, FreeSurfer's rule makes tkRAS a mirror image of the head. Where
/// that won't do (MNE's coregistration, FreeSurfer subjects), use conformedGeometry().
///
/// \throws InvalidInput  size < 1; not hasRightAngles(): the scaled box of tkRAS can't be sheared
AffineTransform indexToTkRas(const ImageGeometry& volume);

/// The geometry of the volume that FreeSurfer makes of this one (`mri_convert --conform`, a
/// subject's orig.mgz): 256^3 voxels of 1 mm along left, inferior and anterior, around the same
/// centre. Its tkRAS is scanner RAS less that centre (c_ras), whatever axes the volume has.
ImageGeometry conformedGeometry(const ImageGeometry& volume);

/// The conformed volume around the origin: its tkRAS is scanner RAS itself. For points in tkRAS of
/// a volume that is not known.
ImageGeometry standInVolume();

/// The volume by which programs write and read a frame of this image. It is the image, but for
/// tkRAS of an image that is not stored as FreeSurfer stores volumes: by its own axes tkRAS would
/// mirror the head, and MNE and FreeSurfer know the subject by the conformed volume.
ImageGeometry frameVolume(CoordinateFrame frame, const ImageGeometry& image);

/// Physical LPS mm -> `frame`.
/// \param volume  needed for TkRas and Voxel, not looked at for the others
/// \throws InvalidInput  no volume where one is needed, or as indexToTkRas()
AffineTransform lpsToFrame(CoordinateFrame frame, const std::optional<ImageGeometry>& volume);

/// `mesh` moved by `transform`: points by the matrix, normals by its inverse transpose (unit
/// length again). A mirroring transform turns the triangles round, so that they stay
/// counter-clockwise seen from outside; normals still point outside.
/// \pre determinant(transform.linear) != 0
TriangleMesh transformed(const TriangleMesh& mesh, const AffineTransform& transform);

/// `mesh` (LPS mm) in `frame`. \throws InvalidInput as lpsToFrame()
TriangleMesh toFrame(const TriangleMesh& mesh, CoordinateFrame frame,
                     const std::optional<ImageGeometry>& volume = std::nullopt);

/// `mesh` (in `frame`) in LPS mm. \throws InvalidInput as lpsToFrame()
TriangleMesh fromFrame(const TriangleMesh& mesh, CoordinateFrame frame,
                       const std::optional<ImageGeometry>& volume = std::nullopt);

}  // namespace adaptiso
