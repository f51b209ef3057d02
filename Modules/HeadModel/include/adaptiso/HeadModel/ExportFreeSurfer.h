#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso {

/// "inner_skull.surf", "outer_skull.surf", "outer_skin.surf": what mne.make_bem_model looks for
/// in SUBJECTS_DIR/SUBJECT/bem.
std::string freeSurferName(HeadSurface surface);

/// Writes a surface of a head model as a FreeSurfer triangle file in surface RAS (tkRAS, mm), the
/// frame that MNE takes such files for, with the footer that leads back to scanner RAS.
///
/// \param surface  LPS mm, outward
/// \param volume   the volume whose tkRAS it is: the subject's own orig.mgz, or the image the
///                 model was made from (frameVolume() says which). Unset: scanner RAS itself, as
///                 the tkRAS of a neutral volume around the scanner's origin.
/// \param volumeName  for the footer, see MeshWriteOptions
/// \throws InvalidInput, FileError  as writeMesh()
void writeFreeSurferSurface(const TriangleMesh& surface, const std::filesystem::path& path,
                            const std::optional<ImageGeometry>& volume,
                            const std::string& volumeName = "");

}  // namespace adaptiso
