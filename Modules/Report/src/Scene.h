#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "Face.h"
#include "SceneMesh.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// A surface as it can be drawn.
struct SceneSurface {
    std::string name;
    ReportColor color{};
    SceneMesh mesh;
    std::span<const double> valuesMm;  ///< of the vertices, or empty
    double largestValueMm = 0;         ///< of all surfaces: one scale of colours
    std::int64_t triangles = 0;        ///< of the surface as given
    /// Where valuesMm lie when not in the report.
    std::shared_ptr<const std::vector<double>> ownValues{};
};

struct SceneSpot {
    std::string what;
    Vec3 pointMm;  ///< RAS
    bool isFailure = true;
};

/// What there is to see, in RAS mm.
struct Scene {
    std::vector<SceneSurface> surfaces;
    std::vector<SceneSpot> spots;
    BoundingBox box;                        ///< of all surfaces; of the image when there is none
    std::shared_ptr<const FaceCut> face{};  ///< what is left out; none: nothing

    bool isEmpty() const { return surfaces.empty(); }
    bool hasTriangles() const;
};

/// Looks at the report's surfaces, so the report must outlive the scene.
Scene makeScene(const Report& report);
Scene makeScene(Report&&) = delete;

/// The line, RAS mm, in which a triangle meets a plane.
using Segment = std::array<Vec3, 2>;

/// Where `mesh` meets the plane on which coordinate `axis` is `atMm`. Corners on the plane count as
/// above it, so that a closed surface gives closed curves.
std::vector<Segment> cutByPlane(const SceneMesh& mesh, int axis, double atMm);

}  // namespace adaptiso
