#include "adaptiso/MeshQuality/Walls.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

namespace {

/// Ways through a solid.
class Solid {
public:
    Solid(const TriangleMesh& mesh, double limitMm)
        : mesh_(mesh),
          tree_(mesh),
          stepMm_(std::max(limitMm, norm(boundingBox(mesh).size()) / 64)) {}

    /// Length of the way from `p`, on the surface, to the opposite side; infinite where there is
    /// none, or it is `most` or farther. \param direction  unit, inward
    double throughFrom(const Vec3& p, const Vec3& direction, double most) const {
        constexpr double kOpposite = 1 / std::numbers::sqrt2;
        double nearest = most, cosine = 0;
        const auto meet = [&](std::int64_t t) {
            const Corners c = cornersOf(mesh_, t);
            const Vec3 area = areaVector2(c[0], c[1], c[2]);
            const double facing = dot(area, direction);
            if (!(facing > 0)) return;  // it enters there, or is the side that it comes from
            const double along = dot(c[0] - p, area) / facing;
            if (!(along > 0 && along < nearest)) return;
            const Vec3 at = p + along * direction;
            for (int n = 0; n < 3; ++n) {
                if (dot(cross(c[(n + 1) % 3] - c[n], at - c[n]), area) < 0) return;
            }
            nearest = along;
            cosine = facing / norm(area);
        };
        // small boxes along the way: one around all of it would hold half the surface
        const double end = std::min(most, 64 * stepMm_);
        for (double from = 0; from < std::min(nearest, end); from += stepMm_) {
            const double to = std::min(from + stepMm_, end);
            BoundingBox box = BoundingBox::empty();
            box.add(p + from * direction);
            box.add(p + to * direction);
            tree_.forEachOverlap(box, meet);
        }
        return cosine >= kOpposite ? nearest : std::numeric_limits<double>::infinity();
    }

private:
    const TriangleMesh& mesh_;
    AabbTree tree_;
    double stepMm_;
};

double least(const WallReport& report) {
    return report.hasWall() ? report.leastMm : std::numeric_limits<double>::infinity();
}

/// In the middle of a triangle (corner -1), or near a corner of it.
Vec3 pointNear(const Corners& c, int corner) {
    constexpr double kToMiddle = 0.1;
    const Vec3 middle = 1.0 / 3 * (c[0] + c[1] + c[2]);
    return corner < 0 ? middle : c[corner] + kToMiddle * (middle - c[corner]);
}

/// Adds what is below one triangle.
void measure(const Solid& solid, const TriangleMesh& mesh, std::int64_t triangle, double limitMm,
             WallReport& report) {
    const Corners c = cornersOf(mesh, triangle);
    const Vec3 area = areaVector2(c[0], c[1], c[2]);
    const double area2 = norm(area);
    if (!(area2 > 0)) return;
    report.areaMm2 += 0.5 * area2;
    const Vec3 inward = -1 / area2 * area;
    const double longest = std::max({norm(c[1] - c[0]), norm(c[2] - c[1]), norm(c[0] - c[2])});
    const int count = longest > limitMm ? 4 : 1;
    int thin = 0;
    for (int n = 0; n < count; ++n) {
        const Vec3 point = pointNear(c, n - 1);
        const double mm = solid.throughFrom(point, inward, std::max(limitMm, least(report)));
        thin += int{mm < limitMm};
        if (!(mm < least(report))) continue;
        report.leastMm = mm;
        report.triangle = triangle;
        report.corner = n - 1;
        report.pointMm = point;
    }
    report.thinAreaMm2 += 0.5 * area2 * thin / static_cast<double>(count);
}

}  // namespace

Vec3 wallPoint(const WallReport& report, const TriangleMesh& mesh) {
    return pointNear(cornersOf(mesh, report.triangle), report.corner);
}

WallReport measureWalls(const TriangleMesh& mesh, double limitMm) {
    if (mesh.triangles.empty()) return {};
    constexpr std::int64_t kPiece = 4096;
    const Solid solid(mesh, limitMm);
    const std::int64_t count = std::ssize(mesh.triangles);
    std::vector<WallReport> pieces((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            measure(solid, mesh, t, limitMm, pieces[begin / kPiece]);
        }
    });
    WallReport all;
    for (const WallReport& piece : pieces) {
        const double thin = all.thinAreaMm2 + piece.thinAreaMm2, area = all.areaMm2 + piece.areaMm2;
        if (least(piece) < least(all)) all = piece;
        all.thinAreaMm2 = thin;
        all.areaMm2 = area;
    }
    return all;
}

}  // namespace adaptiso
