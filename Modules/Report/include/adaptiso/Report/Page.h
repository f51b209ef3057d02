#pragma once

#include <string>
#include <vector>

#include "adaptiso/Report/Pictures.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

struct PageOptions {
    /// Samples and triangles that the viewer gets at most; beyond, the image is averaged down and
    /// the surfaces are shown coarser (pictures and numbers are of the whole).
    std::int64_t maxVoxels = 8'000'000;
    std::int64_t maxTriangles = 600'000;
};

/// The report as one HTML file that needs nothing else: neither network nor other files, and no
/// script but for the viewer. A policy in its head forbids it to load anything.
///
/// \param pictures  as drawPictures() made them; those of an empty list are left out
/// \return UTF-8; bytes of texts that are not UTF-8 become U+FFFD
/// Cost: a few seconds for a head of 7 million voxels, most of it compressing.
std::string htmlPage(const Report& report, const std::vector<Picture>& pictures,
                     const PageOptions& options = {});

/// The surfaces and the image of a report in the viewer, as a part of another page: a notebook's.
///
/// The viewer is a page in a frame of its own, which can reach nothing else and loads nothing.
/// Where scripts or frames are off, as in a notebook that is not trusted, the picture is seen in
/// its place. Below stands the report's title, and that the viewer shows the surfaces coarser than
/// they are, where it does.
/// \return HTML, UTF-8; about 1.6 MB, and 25 bytes a triangle
std::string notebookHtml(const Report& report, const Picture& picture,
                         const PageOptions& options = {1'000'000, 40'000});

/// The viewer was built in; else pages say that it is missing.
bool hasViewer();

}  // namespace adaptiso
