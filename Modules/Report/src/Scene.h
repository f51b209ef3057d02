#pragma once

#include <array>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// A surface as it can be drawn: RAS mm, every corner there and finite.
struct SceneSurface {
    std::string name;
    ReportColor color{};
    TriangleMesh mesh;
    std::vector<double> valuesMm;  ///< of the vertices, or empty
    double largestValueMm = 0;     ///< of all surfaces: one scale of colours
    std::int64_t triangles = 0;    ///< of the surface as given
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
    BoundingBox box;  ///< of all surfaces; of the image when there is none

    bool isEmpty() const { return surfaces.empty(); }
};

constexpr Vec3 lpsToRas(const Vec3& p) {
    return {-p.x, -p.y, p.z};
}

Scene makeScene(const Report& report);

/// The line, RAS mm, in which a triangle meets a plane.
using Segment = std::array<Vec3, 2>;

/// Where `mesh` meets the plane on which coordinate `axis` is `atMm`. Corners on the plane count as
/// above it, so that a closed surface gives closed curves.
/// \pre corners are there and finite
std::vector<Segment> cutByPlane(const TriangleMesh& mesh, int axis, double atMm);

}  // namespace adaptiso
