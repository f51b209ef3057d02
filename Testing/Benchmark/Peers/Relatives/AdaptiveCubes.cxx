#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "CellContour.h"
#include "Relatives.h"

namespace adaptiso::benchmarks {
namespace {

constexpr std::int64_t kLargest = 16;

struct Cube {
    Index3 low;
    std::int64_t side;
};

/// A directed edge of a triangle on a face of its cube that no other triangle has the other way.
struct Rim {
    VertexId from, to;
    std::int64_t side;  ///< of the cube
    bool isAbove;       ///< the cube lies on the upper side of the plane
};

/// A square of one voxel in a plane: axis, its coordinate, and the square's two.
using Square = std::array<std::int64_t, 4>;

class AdaptiveCubes {
public:
    AdaptiveCubes(const SampleGrid& grid, double isovalue, double coarseness)
        : grid_(grid),
          isovalue_(isovalue),
          leastCosine_(std::cos(coarseness * std::numbers::pi / 2)) {}

    TriangleMesh make() {
        const Index3 cells = grid_.cells();
        for (std::int64_t k = 0; k < cells[2]; k += kLargest) {
            for (std::int64_t j = 0; j < cells[1]; j += kLargest) {
                for (std::int64_t i = 0; i < cells[0]; i += kLargest) {
                    divide({{i, j, k}, kLargest});
                }
            }
        }
        findRims();
        for (const Cube& cube : cubes_) {
            if (cube.side > 1) patchFaces(cube);
        }
        return mesh_.take(grid_.geometry());
    }

private:
    bool fits(const Cube& cube) const {
        const Index3 cells = grid_.cells();
        return cube.low[0] + cube.side <= cells[0] && cube.low[1] + cube.side <= cells[1] &&
               cube.low[2] + cube.side <= cells[2];
    }

    /// \return whether it is flat; `isActive`: the surface goes through it
    bool isFlat(const Cube& cube, bool& isActive) const {
        isActive = false;
        Vec3 sum;
        std::vector<Vec3> normals;
        const Index3 cells = grid_.cells();
        for (std::int64_t k = cube.low[2]; k < std::min(cube.low[2] + cube.side, cells[2]); ++k) {
            for (std::int64_t j = cube.low[1]; j < std::min(cube.low[1] + cube.side, cells[1]);
                 ++j) {
                for (std::int64_t i = cube.low[0]; i < std::min(cube.low[0] + cube.side, cells[0]);
                     ++i) {
                    if (!grid_.isActive(i, j, k, isovalue_)) continue;
                    isActive = true;
                    const Vec3 gradient = grid_.gradient(i, j, k);
                    if (squaredNorm(gradient) == 0) continue;
                    normals.push_back(normalized(gradient));
                    sum += normals.back();
                }
            }
        }
        if (!isActive || cube.side == 1) return true;
        if (!fits(cube) || squaredNorm(sum) == 0 || !areEdgesSimple(cube)) return false;
        const Vec3 mean = normalized(sum);
        for (const Vec3& normal : normals) {
            if (dot(normal, mean) < leastCosine_) return false;
        }
        return true;
    }

    bool areEdgesSimple(const Cube& cube) const {
        for (int axis = 0; axis < 3; ++axis) {
            for (int n = 0; n < 4; ++n) {
                Index3 at = cube.low;
                at[static_cast<std::size_t>((axis + 1) % 3)] += n & 1 ? cube.side : 0;
                at[static_cast<std::size_t>((axis + 2) % 3)] += n & 2 ? cube.side : 0;
                int changes = 0;
                bool isInside = grid_.at(at[0], at[1], at[2]) >= isovalue_;
                for (std::int64_t step = 0; step < cube.side; ++step) {
                    ++at[static_cast<std::size_t>(axis)];
                    const bool next = grid_.at(at[0], at[1], at[2]) >= isovalue_;
                    changes += next != isInside;
                    isInside = next;
                }
                if (changes > 1) return false;
            }
        }
        return true;
    }

    void divide(const Cube& cube) {
        const Index3 cells = grid_.cells();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (cube.low[axis] >= cells[axis]) return;
        }
        bool isActive = false;
        if (isFlat(cube, isActive)) {
            if (isActive) contour(cube);
            return;
        }
        const std::int64_t half = cube.side / 2;
        for (int n = 0; n < 8; ++n) {
            divide({{cube.low[0] + (n & 1 ? half : 0), cube.low[1] + (n & 2 ? half : 0),
                     cube.low[2] + (n & 4 ? half : 0)},
                    half});
        }
    }

    void contour(const Cube& cube) {
        static constexpr int kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
        Hexahedron cell;
        for (std::size_t n = 0; n < 8; ++n) {
            const std::int64_t i = cube.low[0] + kCorners[n][0] * cube.side,
                               j = cube.low[1] + kCorners[n][1] * cube.side,
                               k = cube.low[2] + kCorners[n][2] * cube.side;
            cell.values[n] = grid_.at(i, j, k);
            cell.corners[n] = {double(i), double(j), double(k)};
        }
        addCell(cell, isovalue_, mesh_);
        cubes_.push_back(cube);
        cubeOf_.resize(mesh_.triangles().size(), cubes_.size() - 1);
    }

    /// Edges that no triangle has the other way, by the voxels' faces that they lie on.
    void findRims() {
        std::set<std::pair<VertexId, VertexId>> edges;
        for (const Triangle& t : mesh_.triangles()) {
            for (std::size_t c = 0; c < 3; ++c) edges.emplace(t[c], t[(c + 1) % 3]);
        }
        for (std::size_t n = 0; n < cubeOf_.size(); ++n) {
            const Triangle t = mesh_.triangles()[n];
            for (std::size_t c = 0; c < 3; ++c) {
                const VertexId from = t[c], to = t[(c + 1) % 3];
                if (!edges.contains({to, from})) addRim(from, to, cubes_[cubeOf_[n]]);
            }
        }
    }

    void addRim(VertexId from, VertexId to, const Cube& cube) {
        const Vec3 &a = mesh_.point(from), &b = mesh_.point(to);
        const Vec3 middle = 0.5 * (a + b);
        for (std::int64_t axis = 0; axis < 3; ++axis) {
            const auto n = static_cast<std::size_t>(axis);
            for (const bool isUpper : {false, true}) {
                const std::int64_t plane = cube.low[n] + (isUpper ? cube.side : 0);
                const auto at = static_cast<double>(plane);
                const int x = static_cast<int>(axis);
                if (a[x] != at || b[x] != at) continue;
                const auto u = static_cast<std::int64_t>(std::floor(middle[(x + 1) % 3]));
                const auto v = static_cast<std::int64_t>(std::floor(middle[(x + 2) % 3]));
                rims_[{axis, plane, u, v}].push_back({from, to, cube.side, !isUpper});
            }
        }
    }

    void patchFaces(const Cube& cube) {
        for (std::int64_t axis = 0; axis < 3; ++axis) {
            for (const bool isUpper : {false, true}) patchFace(cube, axis, isUpper);
        }
    }

    /// Fills the crack between the large cube's line on a face and those of small ones.
    void patchFace(const Cube& cube, std::int64_t axis, bool isUpper) {
        const auto n = static_cast<std::size_t>(axis);
        const std::int64_t plane = cube.low[n] + (isUpper ? cube.side : 0);
        const std::int64_t u = cube.low[(n + 1) % 3], v = cube.low[(n + 2) % 3];
        std::vector<Rim> large;
        std::map<VertexId, VertexId> small;
        for (std::int64_t b = v; b < v + cube.side; ++b) {
            for (std::int64_t a = u; a < u + cube.side; ++a) {
                const auto found = rims_.find(Square{axis, plane, a, b});
                if (found == rims_.end()) continue;
                for (const Rim& rim : found->second) {
                    const bool isOwn = rim.isAbove == !isUpper;
                    if (isOwn && rim.side == cube.side) large.push_back(rim);
                    if (!isOwn && rim.side < cube.side) small.emplace(rim.from, rim.to);
                }
            }
        }
        if (large.size() != 1 || small.empty()) return;
        // the small ones' line, from its end that nothing leads to
        std::set<VertexId> reached;
        for (const auto& [from, to] : small) reached.insert(to);
        VertexId start = -1;
        for (const auto& [from, to] : small) {
            if (!reached.contains(from)) start = from;
        }
        std::vector<VertexId> line;
        for (VertexId at = start; at >= 0 && line.size() <= small.size();) {
            line.push_back(at);
            const auto next = small.find(at);
            at = next == small.end() ? -1 : next->second;
        }
        // it runs from near large.to to near large.from: the patch has both the other way
        const VertexId from = large[0].from, to = large[0].to;
        for (std::size_t at = line.size(); at > 1; --at)
            mesh_.add(from, line[at - 1], line[at - 2]);
        if (!line.empty()) mesh_.add(from, line.front(), to);
    }

    const SampleGrid& grid_;
    double isovalue_, leastCosine_;
    ContourMesh mesh_;
    std::vector<Cube> cubes_;
    std::vector<std::size_t> cubeOf_;  ///< of each triangle
    std::map<Square, std::vector<Rim>> rims_;
};

}  // namespace

TriangleMesh adaptiveCubes(const SampleGrid& grid, double isovalue, double coarseness) {
    return AdaptiveCubes(grid, isovalue, coarseness).make();
}

}  // namespace adaptiso::benchmarks
