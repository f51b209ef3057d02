#pragma once

#include <filesystem>
#include <string>

namespace adaptiso::simplifier {

/// It ends with a slash, or is a folder that is there.
bool isFolder(const std::filesystem::path& path);

/// The name that stands for {name}: "bone" of "bone.stl", "lh" of "lh.surf.gii"; "lh.pial" of
/// itself, as FreeSurfer's surfaces are told apart by what stands in an extension's place.
std::string surfaceName(const std::filesystem::path& input);

/// Where the simplified surface goes: `output`, or the file of the input's name in the folder that
/// it names.
std::filesystem::path surfaceFile(const std::filesystem::path& output,
                                  const std::filesystem::path& input);

/// Where values go: beside the surface, under their own name; where that is the file they are from,
/// with "simplified" in its name ("lh.simplified.thickness", "a.simplified.shape.gii").
std::filesystem::path dataFile(const std::filesystem::path& data,
                               const std::filesystem::path& surface);

/// "sub-01_hemi-L_desc-simplified_pial.surf.gii", BIDS's way to name what was made of a file.
std::string bidsName(const std::filesystem::path& input);

}  // namespace adaptiso::simplifier
