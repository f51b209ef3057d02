#include "Voxelized.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::headmodel {
namespace {

struct Crossing {
    double at;  ///< index along the row's axis
    int turn;   ///< +1 into the surface, -1 out of it, by the triangle's winding
};

/// Where the triangles cross the rows of a grid along one axis. Rows are moved by an irrational
/// part of a voxel, so that hits at edges and corners are none that happen.
class RowCrossings {
public:
    RowCrossings(const TriangleMesh& mesh, const ImageGeometry& grid, int axis)
        : axis_(axis), u_((axis + 1) % 3), v_((axis + 2) % 3), size_(grid.size) {
        rows_.resize(static_cast<std::size_t>(size_[u_] * size_[v_]));
        for (const Triangle& t : mesh.triangles) {
            std::array<Vec3, 3> corner;
            for (int n = 0; n < 3; ++n) corner[n] = grid.toIndex(mesh.points[t[n]]);
            add(corner);
        }
        for (std::vector<Crossing>& row : rows_) {
            std::sort(row.begin(), row.end(),
                      [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
        }
    }

    /// Adds 1 to inside[n] for voxels inside, to outside[n] for those outside; rows that don't
    /// come out as they went in (they pass a hole) say nothing.
    void vote(bool byWinding, Mask& inside, Mask& outside) const {
        for (std::int64_t v = 0; v < size_[v_]; ++v) {
            for (std::int64_t u = 0; u < size_[u_]; ++u) {
                const std::vector<Crossing>& row = rows_[u + size_[u_] * v];
                int total = 0;
                for (const Crossing& crossing : row) total += crossing.turn;
                if (byWinding ? total != 0 : row.size() % 2 != 0) continue;
                std::size_t next = 0;
                int depth = 0;
                for (std::int64_t w = 0; w < size_[axis_]; ++w) {
                    for (; next < row.size() && row[next].at < static_cast<double>(w); ++next) {
                        depth += byWinding ? row[next].turn : 1;
                    }
                    Index3 at;
                    at[axis_] = w;
                    at[u_] = u;
                    at[v_] = v;
                    const bool isInside = byWinding ? depth > 0 : depth % 2 != 0;
                    ++(isInside ? inside : outside)[at[0] + size_[0] * (at[1] + size_[1] * at[2])];
                }
            }
        }
    }

private:
    static constexpr double kShiftU = 0.0141421356237, kShiftV = 0.0173205080757;

    void add(const std::array<Vec3, 3>& c) {
        const auto range = [&](int axis, double shift, std::int64_t& low, std::int64_t& high) {
            const auto [a, b] = std::minmax({c[0][axis], c[1][axis], c[2][axis]});
            low = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(a - shift)));
            high = std::min(size_[axis] - 1, static_cast<std::int64_t>(std::floor(b - shift)));
        };
        std::int64_t u0 = 0, u1 = 0, v0 = 0, v1 = 0;
        range(u_, kShiftU, u0, u1);
        range(v_, kShiftV, v0, v1);
        const auto side = [&](const Vec3& a, const Vec3& b, double u, double v) {
            return (b[u_] - a[u_]) * (v - a[v_]) - (b[v_] - a[v_]) * (u - a[u_]);
        };
        const double area = side(c[0], c[1], c[2][u_], c[2][v_]);
        if (area == 0) return;
        for (std::int64_t v = v0; v <= v1; ++v) {
            for (std::int64_t u = u0; u <= u1; ++u) {
                const double pu = static_cast<double>(u) + kShiftU;
                const double pv = static_cast<double>(v) + kShiftV;
                const double w2 = side(c[0], c[1], pu, pv) / area;
                const double w0 = side(c[1], c[2], pu, pv) / area;
                const double w1 = 1 - w0 - w2;
                if (w0 < 0 || w1 < 0 || w2 < 0) continue;
                const double at = w0 * c[0][axis_] + w1 * c[1][axis_] + w2 * c[2][axis_];
                // the normal's component along the axis has the sign of the area: > 0 goes out
                rows_[u + size_[u_] * v].push_back({at, area > 0 ? -1 : 1});
            }
        }
    }

    int axis_, u_, v_;
    const Index3& size_;
    std::vector<std::vector<Crossing>> rows_;
};

}  // namespace

Mask voxelized(const TriangleMesh& surface, const ImageGeometry& grid) {
    Mask inside(static_cast<std::size_t>(grid.voxelCount()), 0), outside = inside;
    const bool isOriented = checkTopology(surface, {.maxExamplesPerDefect = 0}).isOriented();
    for (int axis = 0; axis < 3; ++axis)
        RowCrossings(surface, grid, axis).vote(isOriented, inside, outside);
    for (std::size_t n = 0; n < inside.size(); ++n) inside[n] = inside[n] > outside[n] ? 1 : 0;
    return inside;
}

}  // namespace adaptiso::headmodel
