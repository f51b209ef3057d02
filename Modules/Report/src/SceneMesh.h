#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

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
    std::shared_ptr<const std::vector<bool>> left_;  ///< of each triangle; none: all are drawn
    std::int64_t count_ = 0;
};

/// Area, mm2, of the triangles that are drawn.
double surfaceArea(const SceneMesh& mesh);

/// Of the triangles that are drawn. Without any, minimum > maximum.
BoundingBox boxOf(const SceneMesh& mesh);

}  // namespace adaptiso
