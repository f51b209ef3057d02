#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "Html.h"
#include "Scene.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Report/Page.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// The required checks that failed, for the banner: the first three by name.
std::string failuresHtml(const Report& report);
/// The warnings, for the banner: the first three; notesHtml() has the others.
std::string warningsHtml(const Report& report);
std::string factsHtml(const Report& report);
/// One line on what the page shows of a face. Empty where nothing is shown.
std::string faceHtml(const Report& report, const Scene& scene);
/// The colour bar of the viewer. Empty where no surface has values.
std::string scaleHtml(const Scene& scene);
/// The places to look at: buttons where there is a viewer to move, else text.
std::string spotsHtml(const Scene& scene, bool hasViewer);
std::string checksHtml(const Report& report);
std::string tablesHtml(const Report& report);
std::string picturesHtml(const std::vector<Picture>& pictures);
/// The warnings that the banner does not show, then `notes`. Empty where there is neither.
std::string notesHtml(const Report& report, const std::vector<std::string>& notes);

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
