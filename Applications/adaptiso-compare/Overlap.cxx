#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "Run.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::compare {
namespace {

/// The whole numbers in [first, last); empty where first >= last.
struct Range {
    std::int64_t first, last;
};

/// Whole numbers of [0, count) from `low` to `high`, both included.
Range wholeNumbersBetween(double low, double high, std::int64_t count) {
    const auto end = static_cast<double>(count);
    return {static_cast<std::int64_t>(std::clamp(std::ceil(low), 0.0, end)),
            static_cast<std::int64_t>(std::clamp(std::floor(high) + 1, 0.0, end))};
}

/// Where `row` lies of the line from -> to: 1 left, -1 right, never 0. Ties are broken by moving
/// the row by (e^2, e), e infinitely small; 0 only where from and to are one point.
int sideOf(const Point2& row, const Point2& from, const Point2& to) {
    const int side = orient2d(from, to, row);
    if (side != 0) return side;
    const double along = to[0] - from[0], up = to[1] - from[1];
    if (along != 0) return along > 0 ? 1 : -1;
    return up > 0 ? -1 : up < 0 ? 1 : 0;
}

/// A closed surface in voxel indices, ready to be cut into slices.
class SlicedMesh {
public:
    SlicedMesh(const TriangleMesh& mesh, const ImageGeometry& image)
        : mesh_(mesh), size_(image.size) {
        const Mat3 toIndex = inverse(image.indexToPhysical);
        points_.reserve(mesh.points.size());
        for (const Vec3& p : mesh.points) points_.push_back(toIndex * (p - image.originMm));
        sortBySlice();
    }

    /// For every voxel of slice k, in rows: 1 where its centre is inside.
    void fillSlice(std::int64_t k, std::vector<std::uint8_t>& inside) const {
        inside.assign(size_[0] * size_[1], 0);
        for (const std::int64_t triangle : trianglesOf(k)) toggleBehind(triangle, k, inside);
        for (std::int64_t j = 0; j < size_[1]; ++j) {
            std::uint8_t* const row = inside.data() + j * size_[0];
            for (std::int64_t i = 1; i < size_[0]; ++i) row[i] ^= row[i - 1];
        }
    }

private:
    std::span<const std::int64_t> trianglesOf(std::int64_t k) const {
        return {order_.data() + begin_[k], order_.data() + begin_[k + 1]};
    }

    Range range(const Triangle& t, int axis) const {
        const auto [low, high] =
            std::minmax({points_[t[0]][axis], points_[t[1]][axis], points_[t[2]][axis]});
        return wholeNumbersBetween(low, high, size_[axis]);
    }

    /// Lists the triangles of each slice, by counting.
    void sortBySlice() {
        begin_.assign(size_[2] + 1, 0);
        for (const Triangle& t : mesh_.triangles) {
            const Range slices = range(t, 2);
            for (std::int64_t k = slices.first; k < slices.last; ++k) ++begin_[k + 1];
        }
        for (std::int64_t k = 0; k < size_[2]; ++k) begin_[k + 1] += begin_[k];
        order_.resize(begin_.back());
        std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
        for (std::size_t n = 0; n < mesh_.triangles.size(); ++n) {
            const Range slices = range(mesh_.triangles[n], 2);
            for (std::int64_t k = slices.first; k < slices.last; ++k) {
                order_[next[k]++] = static_cast<std::int64_t>(n);
            }
        }
    }

    /// Marks, in every row of slice k that the triangle crosses, the first voxel behind it.
    void toggleBehind(std::int64_t triangle, std::int64_t k,
                      std::vector<std::uint8_t>& inside) const {
        const Triangle& t = mesh_.triangles[triangle];
        const Vec3 &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
        const Point2 flatA{a.y, a.z}, flatB{b.y, b.z}, flatC{c.y, c.z};
        const Range rows = range(t, 1);
        for (std::int64_t j = rows.first; j < rows.last; ++j) {
            const Point2 row{static_cast<double>(j), static_cast<double>(k)};
            const int side = sideOf(row, flatA, flatB);
            if (side == 0 || sideOf(row, flatB, flatC) != side ||
                sideOf(row, flatC, flatA) != side) {
                continue;
            }
            const double firstBehind = std::max(0.0, std::ceil(crossing(row, a, b, c)));
            if (firstBehind >= static_cast<double>(size_[0])) continue;
            inside[static_cast<std::int64_t>(firstBehind) + j * size_[0]] ^= 1;
        }
    }

    /// Index i at which a row, known to pass the triangle, crosses its plane.
    static double crossing(const Point2& row, const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 normal = areaVector2(a, b, c);
        const double i = a.x - (normal.y * (row[0] - a.y) + normal.z * (row[1] - a.z)) / normal.x;
        const auto [low, high] = std::minmax({a.x, b.x, c.x});
        // a triangle seen edge-on: its corners decide, not its plane
        return std::isfinite(i) ? std::clamp(i, low, high) : low;
    }

    const TriangleMesh& mesh_;
    Index3 size_;
    std::vector<Vec3> points_;         ///< voxel indices
    std::vector<std::int64_t> begin_;  ///< of each slice's triangles in order_
    std::vector<std::int64_t> order_;  ///< triangle numbers, slice after slice
};

}  // namespace

Overlap voxelOverlap(const TriangleMesh& a, const TriangleMesh& b, const ImageGeometry& image) {
    const SlicedMesh slicedA(a, image), slicedB(b, image);
    std::vector<Overlap> ofSlice(image.size[2]);
    parallelForPieces(image.size[2], 1, [&](std::int64_t k, std::int64_t) {
        std::vector<std::uint8_t> insideA, insideB;
        slicedA.fillSlice(k, insideA);
        slicedB.fillSlice(k, insideB);
        for (std::size_t n = 0; n < insideA.size(); ++n) {
            ofSlice[k].voxelsA += insideA[n];
            ofSlice[k].voxelsB += insideB[n];
            ofSlice[k].voxelsBoth += insideA[n] & insideB[n];
        }
    });
    Overlap all;
    for (const Overlap& slice : ofSlice) {
        all.voxelsA += slice.voxelsA;
        all.voxelsB += slice.voxelsB;
        all.voxelsBoth += slice.voxelsBoth;
    }
    return all;
}

}  // namespace adaptiso::compare
