#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "CellContour.h"
#include "Relatives.h"

namespace adaptiso::benchmarks {
namespace {

/// Corners in the order that Maubach's bisection keeps, and which edge is next: 0 to `tag`.
struct Tetrahedron {
    std::array<Index3, 4> corners;
    std::size_t tag = 3;
};

class Bisection {
public:
    Bisection(const SampleGrid& grid, double isovalue, double bound)
        : grid_(grid), isovalue_(isovalue), bound_(bound) {
        const Index3 cells = grid.cells();
        const std::int64_t most = std::max({cells[0], cells[1], cells[2]});
        side_ = static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(most)));
        countActive();
        errors_.resize(static_cast<std::size_t>((side_ + 1) * (side_ + 1) * (side_ + 1)));
    }

    TriangleMesh make() {
        forEachRoot([&](const Tetrahedron& root) { measure(root); });
        saturate();
        forEachRoot([&](const Tetrahedron& root) { refine(root); });
        return mesh_.take(grid_.geometry());
    }

private:
    std::size_t number(const Index3& p) const {
        return static_cast<std::size_t>(p[0] + (side_ + 1) * (p[1] + (side_ + 1) * p[2]));
    }
    double value(const Index3& p) const { return grid_.clamped(p[0], p[1], p[2]); }

    /// Active cells below and left of each node, to ask for any box at once.
    void countActive() {
        const Index3 cells = grid_.cells();
        const std::int64_t nx = cells[0] + 1, ny = cells[1] + 1;
        counts_.resize(static_cast<std::size_t>(nx * ny * (cells[2] + 1)));
        const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t k) -> std::int32_t& {
            return counts_[static_cast<std::size_t>(i + nx * (j + ny * k))];
        };
        for (std::int64_t k = 1; k <= cells[2]; ++k) {
            for (std::int64_t j = 1; j <= cells[1]; ++j) {
                for (std::int64_t i = 1; i <= cells[0]; ++i) {
                    at(i, j, k) = grid_.isActive(i - 1, j - 1, k - 1, isovalue_) + at(i - 1, j, k) +
                                  at(i, j - 1, k) + at(i, j, k - 1) - at(i - 1, j - 1, k) -
                                  at(i - 1, j, k - 1) - at(i, j - 1, k - 1) +
                                  at(i - 1, j - 1, k - 1);
                }
            }
        }
    }

    bool isActive(const Tetrahedron& t) const {
        const Index3 cells = grid_.cells();
        Index3 low = t.corners[0], high = low;
        for (const Index3& p : t.corners) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min({low[axis], p[axis], cells[axis]});
                high[axis] = std::min(std::max(high[axis], p[axis]), cells[axis]);
            }
        }
        const std::int64_t nx = cells[0] + 1, ny = cells[1] + 1;
        std::int64_t sum = 0;
        for (int n = 0; n < 8; ++n) {
            const std::int64_t i = n & 1 ? low[0] : high[0], j = n & 2 ? low[1] : high[1],
                               k = n & 4 ? low[2] : high[2];
            const int sign = std::popcount(static_cast<unsigned>(n)) % 2 ? -1 : 1;
            sum += sign * counts_[static_cast<std::size_t>(i + nx * (j + ny * k))];
        }
        return sum > 0;
    }

    template <class Visit>
    void forEachRoot(const Visit& visit) const {
        std::array<std::size_t, 3> order{0, 1, 2};
        do {
            Tetrahedron root;
            Index3 p{0, 0, 0};
            root.corners[0] = p;
            for (std::size_t n = 0; n < 3; ++n) {
                p[order[n]] = side_;
                root.corners[n + 1] = p;
            }
            visit(root);
        } while (std::next_permutation(order.begin(), order.end()));
    }

    /// Between voxels there is none.
    bool middle(const Tetrahedron& t, Index3& p) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int64_t sum = t.corners[0][axis] + t.corners[t.tag][axis];
            if (sum % 2 != 0) return false;
            p[axis] = sum / 2;
        }
        return true;
    }

    static std::array<Tetrahedron, 2> halves(const Tetrahedron& t, const Index3& middle) {
        Tetrahedron a = t, b = t;
        a.corners[t.tag] = middle;
        for (std::size_t n = 0; n < t.tag; ++n) b.corners[n] = t.corners[n + 1];
        b.corners[t.tag] = middle;
        a.tag = b.tag = t.tag == 1 ? 3 : t.tag - 1;
        return {a, b};
    }

    void measure(const Tetrahedron& t) {
        Index3 p;
        if (!isActive(t) || !middle(t, p)) return;
        const double linear = (value(t.corners[0]) + value(t.corners[t.tag])) / 2;
        float& error = errors_[number(p)];
        error = std::max(error, static_cast<float>(std::abs(value(p) - linear)));
        for (const Tetrahedron& half : halves(t, p)) measure(half);
    }

    void raise(const Index3& p, const Index3& child) {
        for (const std::int64_t x : child) {
            if (x < 0 || x > side_) return;
        }
        errors_[number(p)] = std::max(errors_[number(p)], errors_[number(child)]);
    }

    /// No error is below those of the vertices that need this one: middles of edges need centres
    /// of the cubes around them half as large, of squares those of their sides, of cubes of
    /// squares.
    void saturate() {
        for (std::int64_t s = 1; s < side_; s *= 2) {
            for (int odd = 1; odd <= 3; ++odd) {
                for (std::int64_t k = 0; k <= side_; k += s) {
                    for (std::int64_t j = 0; j <= side_; j += s) {
                        for (std::int64_t i = 0; i <= side_; i += s) raiseAt({i, j, k}, s, odd);
                    }
                }
            }
        }
    }

    void raiseAt(const Index3& p, std::int64_t s, int odd) {
        const std::array<bool, 3> isOdd{p[0] / s % 2 == 1, p[1] / s % 2 == 1, p[2] / s % 2 == 1};
        if (isOdd[0] + isOdd[1] + isOdd[2] != odd) return;
        if (odd == 1) {
            if (s == 1) return;
            for (int n = 0; n < 8; ++n) {
                const std::int64_t h = s / 2;
                raise(p,
                      {p[0] + (n & 1 ? h : -h), p[1] + (n & 2 ? h : -h), p[2] + (n & 4 ? h : -h)});
            }
            return;
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!isOdd[axis]) continue;
            for (const std::int64_t d : {-s, s}) {
                Index3 child = p;
                child[axis] += d;
                raise(p, child);
            }
        }
    }

    void refine(const Tetrahedron& t) {
        if (!isActive(t)) return;
        Index3 p;
        if (middle(t, p) && errors_[number(p)] > bound_) {
            for (const Tetrahedron& half : halves(t, p)) refine(half);
            return;
        }
        contour(t);
    }

    Vec3 on(const Tetrahedron& t, std::size_t a, std::size_t b) const {
        const auto place = [](const Index3& p) {
            return Vec3{double(p[0]), double(p[1]), double(p[2])};
        };
        return crossing(place(t.corners[a]), value(t.corners[a]), place(t.corners[b]),
                        value(t.corners[b]), isovalue_);
    }

    void contour(const Tetrahedron& t) {
        std::vector<std::size_t> in, out;
        for (std::size_t n = 0; n < 4; ++n) {
            (value(t.corners[n]) >= isovalue_ ? in : out).push_back(n);
        }
        if (in.empty() || out.empty()) return;
        std::vector<Vec3> polygon;
        if (in.size() == 2) {
            polygon = {on(t, in[0], out[0]), on(t, in[0], out[1]), on(t, in[1], out[1]),
                       on(t, in[1], out[0])};
        } else {
            const std::vector<std::size_t>&one = in.size() == 1 ? in : out,
                  &three = in.size() == 1 ? out : in;
            for (const std::size_t n : three) polygon.push_back(on(t, one[0], n));
        }
        // seen from outside
        const Index3 &a = t.corners[in[0]], &b = t.corners[out[0]];
        const Vec3 outward{double(b[0] - a[0]), double(b[1] - a[1]), double(b[2] - a[2])};
        if (dot(cross(polygon[1] - polygon[0], polygon[2] - polygon[0]), outward) < 0) {
            std::reverse(polygon.begin(), polygon.end());
        }
        add(polygon);
    }

    void add(const std::vector<Vec3>& polygon) {
        const Index3 cells = grid_.cells();
        for (std::size_t n = 2; n < polygon.size(); ++n) {
            const Vec3 middle = 1.0 / 3 * (polygon[0] + polygon[n - 1] + polygon[n]);
            if (middle.x > double(cells[0]) || middle.y > double(cells[1]) ||
                middle.z > double(cells[2])) {
                continue;
            }
            mesh_.add(mesh_.vertex(polygon[0]), mesh_.vertex(polygon[n - 1]),
                      mesh_.vertex(polygon[n]));
        }
    }

    const SampleGrid& grid_;
    double isovalue_, bound_;
    std::int64_t side_ = 1;
    std::vector<std::int32_t> counts_;
    std::vector<float> errors_;
    ContourMesh mesh_;
};

}  // namespace

TriangleMesh bisectedTetrahedra(const SampleGrid& grid, double isovalue, double coarseness) {
    const auto [least, most] = std::minmax_element(grid.samples().begin(), grid.samples().end());
    return Bisection(grid, isovalue, coarseness * coarseness * (*most - *least)).make();
}

}  // namespace adaptiso::benchmarks
