#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

constexpr Vec3 lpsToRas(const Vec3& p) {
    return {-p.x, -p.y, p.z};
}

/// A mesh as it can be drawn: RAS mm, every corner there and finite.
///
/// It looks at a mesh in LPS mm and turns points as they are asked for: a copy of a surface of five
/// million triangles would take 180 MB. Copies of it look at the same mesh.
class SceneMesh {
public:
    SceneMesh() : SceneMesh(TriangleMesh{}) {}
    /// Looks at `lps`, which must live as long as this and its copies.
    static SceneMesh of(const TriangleMesh& lps);
    /// Keeps `lps`.
    explicit SceneMesh(TriangleMesh lps);

    std::int64_t pointCount() const { return std::ssize(lps_->points); }
    Vec3 point(VertexId v) const { return lpsToRas(lps_->points[v]); }

    /// The mesh looked at, LPS mm, with what is not drawn.
    const TriangleMesh& lps() const { return *lps_; }

    /// Triangles that are drawn.
    std::int64_t triangleCount() const { return count_; }
    bool isEmpty() const { return count_ == 0; }

    /// Calls body(triangle) for those that are drawn, in the mesh's order.
    template <class Body>
    void forEachTriangle(const Body& body) const {
        for (std::size_t n = 0; n < lps_->triangles.size(); ++n) {
            if (left_ && (*left_)[n]) continue;
            body(lps_->triangles[n]);
        }
    }

    /// Leaves out the triangles for which leaves(triangle) is true.
    template <class Test>
    void leaveOut(const Test& leaves) {
        std::vector<bool> left = left_ ? *left_ : std::vector<bool>(lps_->triangles.size());
        for (std::size_t n = 0; n < left.size(); ++n) {
            if (!left[n]) left[n] = leaves(lps_->triangles[n]);
        }
        keepAllBut(std::move(left));
    }

private:
    explicit SceneMesh(std::shared_ptr<const TriangleMesh> lps);
    void keepAllBut(std::vector<bool> left);

    std::shared_ptr<const TriangleMesh> lps_;
    std::shared_ptr<const std::vector<bool>> left_;  ///< of each triangle; null: all are drawn
    std::int64_t count_ = 0;
};

/// Area, mm2, of the triangles that are drawn.
double surfaceArea(const SceneMesh& mesh);

/// Box of the triangles that are drawn; empty without any.
BoundingBox boxOf(const SceneMesh& mesh);

/// The inside of closed surfaces, in cells of 1 mm.
class Inside {
public:
    /// \param surface  fills where a line along z enters and leaves it; lines that meet it an odd
    ///                 number of times fill nothing
    explicit Inside(const SceneMesh& surface);
    bool holds(const Vec3& rasMm) const;

private:
    BoundingBox box_;
    Index3 size_{0, 0, 0};
    std::vector<bool> cells_;
};

/// The part of space that is left out of a page so that no face is seen.
///
/// It lies below a plane across the head that begins 45 mm below its top at the forehead, half way
/// to the brows, and falls backwards by 42 degrees; for heads of another length than 180 mm, as
/// measured in the upper 50 mm, in proportion. Heads that look up or down by 20 degrees keep their
/// brows, eyes, nose, mouth and chin below it. No part of the face lies in the upper 50 mm, so
/// the plane's place does not depend on the face.
class FaceCut {
public:
    /// Finds the head in the image, else in the surfaces. What lies inside a surface that
    /// holds no face (ReportSurface::isWithinSkull) stays.
    FaceCut(const Report& report, const std::vector<SceneMesh>& surfaces);

    bool hides(const Vec3& rasMm) const;

    /// The head was not found, so everything is hidden but what stays.
    bool hidesAll() const { return !plane_; }
    const std::string& reason() const { return reason_; }  ///< of hidesAll()
    double belowTopMm() const;                             ///< where the plane begins

private:
    /// Hidden where z < topMm - scale * (kBelowTopMm + kFall * (frontMm - y)).
    struct Plane {
        double topMm, frontMm, scale;
    };
    /// Extent of a head's upper part, RAS.
    struct Vault {
        double topMm, frontMm, backMm;
    };
    void take(const Vault& vault);
    void findIn(const VolumeView& volume);
    void findIn(const std::vector<SceneMesh>& surfaces);

    std::optional<Plane> plane_;
    std::vector<Inside> staying_;
    std::string reason_;
};

/// A surface as it can be drawn.
struct SceneSurface {
    std::string name;
    ReportColor color{};
    SceneMesh mesh;
    std::span<const double> valuesMm;  ///< of the vertices, or empty
    double largestValueMm = 0;         ///< of all surfaces: one scale of colours
    std::string valuesAre{};           ///< as Report has it
    std::int64_t triangles = 0;        ///< of the surface as given
    bool areMarks = false;             ///< as Report has it
    /// Storage of valuesMm when not in the report.
    std::shared_ptr<const std::vector<double>> ownValues{};
};

struct SceneSpot {
    std::string what;
    Vec3 pointMm;  ///< RAS
    bool isFailure = true;
};

/// Surfaces and spots to draw, in RAS mm.
struct Scene {
    std::vector<SceneSurface> surfaces;
    std::vector<SceneSpot> spots;
    BoundingBox box;                        ///< of all surfaces; of the image when there is none
    std::shared_ptr<const FaceCut> face{};  ///< part left out; may be null
    bool isFrameSaid = true;                ///< else sides are those of RAS, which it may not be

    bool isEmpty() const { return surfaces.empty(); }
    bool hasTriangles() const;
};

/// Looks at the report's surfaces, so the report must outlive the scene.
Scene makeScene(const Report& report);
Scene makeScene(Report&&) = delete;

/// The line, RAS mm, in which a triangle meets a plane.
using Segment = std::array<Vec3, 2>;

/// Section of `mesh` with the plane on which coordinate `axis` is `atMm`. Corners on the plane
/// count as above it, so that a closed surface gives closed curves.
std::vector<Segment> cutByPlane(const SceneMesh& mesh, int axis, double atMm);

}  // namespace adaptiso
