#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// A PNG file.
struct Picture {
    std::string name;     ///< "contours-axial.png"
    std::string title;    ///< for people
    std::string altText;  ///< the picture in words, for screen readers
    std::string png;      ///< the file's bytes
    int width = 0, height = 0;
};

/// Every picture that the report has the data for, in the order of the page:
///   histogram                            of the image's values
///   contours-axial, -coronal, -sagittal  where the surfaces cut slices of the image, as MNE's
///                                        plot_bem shows them
///   spots                                three slices through each of the first spots
///   alignment                            marks and the last surface before them from six sides:
///                                        electrodes on the skin, sources seen through it
///   surface-N                            each surface from six sides, what faces away from the
///                                        viewer in red; values in colour, with a colour bar
///   regions                              in their stead, of regions: all together
///
/// Everything is drawn in memory: no display, no OpenGL. Left is left of the picture, and every
/// picture names the sides. Triangles with a corner that is not there or not finite are
/// left out. The same report gives the same bytes, whatever the number of threads.
/// \pre spots are finite  \throws InternalError  Cairo refuses
std::vector<Picture> drawPictures(const Report& report);

enum class Shading {
    Smooth,  ///< by the vertices' normals, which are the image's gradient where the mesh has them
    Flat,    ///< each triangle by its own normal
    Edges    ///< flat, with the edges of the triangles
};

/// How drawViews() draws.
struct ViewOptions {
    /// Where the viewer stands, in degrees: 0 in front, 90 on the patient's left, 180 behind.
    double azimuthDeg = 0;
    double elevationDeg = 0;             ///< from -90 (below) to 90 (above)
    int width = 2400, height = 1800;     ///< pixels
    std::optional<ReportColor> color{};  ///< default: that of surfaces or values, else ivory
    std::optional<ReportColor> background = ReportColor{255, 255, 255};  ///< empty: transparent
    Shading shading = Shading::Smooth;
};

/// Each surface but marks by itself (regions: all together) from one side and without words, as
/// large as the picture allows: "view-1.png", ... There is no perspective. As drawPictures()
/// otherwise.
std::vector<Picture> drawViews(const Report& report, const ViewOptions& options);

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
/// Where scripts or frames are off, as in an untrusted notebook, the picture is shown in
/// its place. Below stands the report's title, and that the viewer shows the surfaces coarser than
/// they are, where it does.
/// \return HTML, UTF-8; about 1.6 MB, and 25 bytes a triangle
std::string notebookHtml(const Report& report, const Picture& picture,
                         const PageOptions& options = {1'000'000, 40'000});

/// The viewer was built in; else pages say that it is missing.
bool hasViewer();

/// A coarser surface, to be looked at: `mesh` itself where it has no more than `maxTriangles`, else
/// vertices that lie in one cell of a grid become one [Lindstrom2000]. No vertex moves out of its
/// cell; thin parts may join. Triangles with a corner that is not there or not finite are left out.
///
/// \param mesh  LPS mm; may be broken in any way
/// \return at most `maxTriangles`, without normals; the same for any number of threads
/// Cost: some passes over the mesh; 20 bytes for each of its vertices and 250 for each of the
/// result's.
TriangleMesh coarserMesh(const TriangleMesh& mesh, std::int64_t maxTriangles);

/// Share of `maxTriangles` for each surface: equal, but never more than it has; what
/// small ones leave goes to the others.
std::vector<std::int64_t> shareTriangles(const std::vector<std::int64_t>& counts,
                                         std::int64_t maxTriangles);

}  // namespace adaptiso
