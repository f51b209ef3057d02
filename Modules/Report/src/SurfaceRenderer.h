#pragma once

#include <optional>
#include <span>
#include <vector>

#include "Canvas.h"
#include "Scene.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {

/// A side from which a surface is looked at, without perspective; RAS.
struct View {
    const char* name;                  ///< "from the front"
    Vec3 toViewer;                     ///< unit
    Vec3 up;                           ///< unit
    const char *leftSide, *rightSide;  ///< sides of the picture: "R", "L"

    Vec3 right() const { return cross(up, toViewer); }
};

/// Front, back, left, right, top, bottom.
const std::array<View, 6>& sixViews();

/// Picture of a view, or rows of one.
struct Rendering {
    int width = 0, height = 0;
    Vec3 middle;  ///< of the picture
    double mmPerPixel = 1;
    std::vector<ReportColor> colors;
    std::vector<std::uint8_t> opacity;  ///< 255 where surfaces cover the whole pixel
    std::vector<double> depthMm;        ///< of the nearest surface, towards the viewer; -inf: none

    Pixel toPixel(const Vec3& p, const View& view) const;
    /// True if nothing lies more than `toleranceMm` before `p`, and something close behind it.
    bool isSeen(const Vec3& p, const View& view, double toleranceMm) const;
};

/// Unit normals of the vertices, each the mean of the triangles around by their areas; zero where
/// there are none. 12 bytes a vertex, made once for all views.
using VertexNormals = std::vector<Normal>;
VertexNormals vertexNormals(const SceneMesh& mesh);

/// Draws the surfaces with a depth buffer; light comes from the viewer's upper left. Triangles seen
/// from their back are red. Edges are drawn where triangles are large enough to tell them apart.
/// \param normals  of each surface
/// \param box      what fills the picture, whatever the view
/// \param drawsEdges  default: where triangles are large enough
Rendering render(std::span<const SceneSurface> surfaces, std::span<const VertexNormals> normals,
                 const BoundingBox& box, const View& view, int size,
                 std::optional<bool> drawsEdges = {});

/// The surfaces in one picture, for drawViews().
Picture viewPicture(std::vector<SceneSurface> surfaces, const std::string& name,
                    const ViewOptions& options);

}  // namespace adaptiso
