#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "Scene.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// gzip without a date, so that the same bytes give the same. \throws InternalError
std::string gzip(std::string_view bytes);

/// The image as a NIfTI-1 file of 8 bits a sample, black to white as greyWindow() gives: with at
/// most `maxVoxels` samples, means of blocks of the image's where that has more. RAS; the header
/// holds geometry alone. Black where `face` (if not null) hides the middle of a block.
std::string niftiOf(const VolumeView& volume, std::int64_t maxVoxels,
                    const FaceCut* face = nullptr);

/// A black image that holds `box` (RAS) and a little more.
std::string blankNifti(const BoundingBox& box);

/// The surface as an MZ3 file (as niivue and Surfice read it): the vertices that triangles use, and
/// colours where the surface has values. RAS.
std::string mz3Of(const SceneSurface& surface);

/// The surface with at most `maxTriangles`: see coarserMesh(). A vertex has the mean of the values
/// of those that it stands for.
SceneSurface coarser(const SceneSurface& surface, std::int64_t maxTriangles);

}  // namespace adaptiso
