#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "CellContour.h"
#include "Relatives.h"

namespace adaptiso::benchmarks {
namespace {

constexpr int kRounds = 30;
constexpr double kPull = 8;      // a node on the surface counts so much more than one off it
constexpr double kRelaxed = .5;  // of the way to the weighted mean in a round

class WarpedGrid {
public:
    WarpedGrid(const SampleGrid& grid, double isovalue, double step)
        : grid_(grid), isovalue_(isovalue), step_(step) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double length = static_cast<double>(grid.cells()[axis]);
            nodes_[axis] = std::max<std::int64_t>(2, std::llround(length / step) + 1);
            stride_[axis] = length / static_cast<double>(nodes_[axis] - 1);
        }
        forEachNode([&](std::int64_t i, std::int64_t j, std::int64_t k) {
            places_.push_back(
                {double(i) * stride_[0], double(j) * stride_[1], double(k) * stride_[2]});
        });
    }

    TriangleMesh make() {
        measureVariation();
        for (int round = 0; round < kRounds; ++round) relax();
        forEachNode([&](std::int64_t i, std::int64_t j, std::int64_t k) {
            if (i + 1 < nodes_[0] && j + 1 < nodes_[1] && k + 1 < nodes_[2]) contour(i, j, k);
        });
        return mesh_.take(grid_.geometry());
    }

private:
    template <class Visit>
    void forEachNode(const Visit& visit) const {
        for (std::int64_t k = 0; k < nodes_[2]; ++k) {
            for (std::int64_t j = 0; j < nodes_[1]; ++j) {
                for (std::int64_t i = 0; i < nodes_[0]; ++i) visit(i, j, k);
            }
        }
    }
    std::size_t number(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return static_cast<std::size_t>(i + nodes_[0] * (j + nodes_[1] * k));
    }

    /// The share of active cells in each box of the coarse grid, as it was at first.
    void measureVariation() {
        variation_.assign(places_.size(), 0);
        const Index3 cells = grid_.cells();
        for (std::int64_t k = 0; k < cells[2]; ++k) {
            for (std::int64_t j = 0; j < cells[1]; ++j) {
                for (std::int64_t i = 0; i < cells[0]; ++i) {
                    if (!grid_.isActive(i, j, k, isovalue_)) continue;
                    variation_[boxOf({double(i) + .5, double(j) + .5, double(k) + .5})] += 1;
                }
            }
        }
        const double box = stride_[0] * stride_[1] * stride_[2];
        for (double& share : variation_) share = std::min(1.0, share / box * step_);
    }

    std::size_t boxOf(const Vec3& p) const {
        std::array<std::int64_t, 3> at;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = std::clamp<std::int64_t>(
                std::llround(p[static_cast<int>(axis)] / stride_[axis]), 0, nodes_[axis] - 1);
        }
        return number(at[0], at[1], at[2]);
    }

    void relax() {
        std::vector<Vec3> next = places_;
        forEachNode([&](std::int64_t i, std::int64_t j, std::int64_t k) {
            const std::array<std::int64_t, 3> at{i, j, k};
            Vec3 sum;
            double weights = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (const std::int64_t d : {-1, 1}) {
                    std::array<std::int64_t, 3> to = at;
                    to[axis] += d;
                    if (to[axis] < 0 || to[axis] >= nodes_[axis]) continue;
                    const Vec3& place = places_[number(to[0], to[1], to[2])];
                    const double weight = 1 + kPull * variation_[boxOf(place)];
                    sum += weight * place;
                    weights += weight;
                }
            }
            const Vec3 aim = 1 / weights * sum;
            Vec3& place = next[number(i, j, k)];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // the border stays the border
                if (at[axis] == 0 || at[axis] == nodes_[axis] - 1) continue;
                const int x = static_cast<int>(axis);
                place[x] += kRelaxed * (aim[x] - place[x]);
            }
        });
        places_ = std::move(next);
    }

    void contour(std::int64_t i, std::int64_t j, std::int64_t k) {
        static constexpr int kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
        Hexahedron cell;
        for (std::size_t n = 0; n < 8; ++n) {
            cell.corners[n] =
                places_[number(i + kCorners[n][0], j + kCorners[n][1], k + kCorners[n][2])];
            cell.values[n] = grid_.linear(cell.corners[n]);
        }
        addCell(cell, isovalue_, mesh_);
    }

    const SampleGrid& grid_;
    double isovalue_, step_;
    std::array<std::int64_t, 3> nodes_{};
    std::array<double, 3> stride_{};
    std::vector<Vec3> places_;
    std::vector<double> variation_;
    ContourMesh mesh_;
};

}  // namespace

TriangleMesh warpedGrid(const SampleGrid& grid, double isovalue, double coarseness) {
    return WarpedGrid(grid, isovalue, 1 + 7 * coarseness).make();
}

}  // namespace adaptiso::benchmarks
