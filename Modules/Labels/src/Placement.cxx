#include "Placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kGrain = 4096;

Vec3 offsetOf(int corner) {
    return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1),
            static_cast<double>(corner >> 2)};
}

Vec3 middleOf(int tetrahedron) {
    return 0.25 * (offsetOf(0) + offsetOf(kRing[tetrahedron]) +
                   offsetOf(kRing[after(tetrahedron)]) + offsetOf(7));
}

/// The two axes whose coordinates are equal on the inner face at a corner of the ring, the one
/// that is larger in the tetrahedron first.
std::array<int, 2> axesOf(int ring, int tetrahedron) {
    const int corner = kRing[ring];
    std::array<int, 2> axes{};
    int n = 0;
    const bool isOne = (corner & (corner - 1)) == 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (((corner >> axis & 1) == 0) == isOne) axes[n++] = axis;
    }
    const Vec3 middle = middleOf(tetrahedron);
    if (middle[axes[0]] < middle[axes[1]]) std::swap(axes[0], axes[1]);
    return axes;
}

/// The largest part of the way from `from` to `to` on which f >= least, f being linear.
double partOfWay(double from, double to, double least) {
    return to >= least ? 1 : (from - least) / (from - to);
}

/// Place of a vertex in its cell; the fourth number is unused. Four single numbers are added at
/// once.
using Local __attribute__((vector_size(16))) = float;

Local localOf(const Vec3& p) {
    return Local{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
}
Vec3 pointOf(const Local& p) {
    return {p[0], p[1], p[2]};
}
Local heldIn(Room room, const Local& p) {
    constexpr auto kLow = static_cast<float>(kLeastGap);
    const Local low = Local{} + kLow, high = Local{} + (1 - kLow);
    if (room.size == kTetrahedra) {
        const Local q = p < low ? low : p;
        return q > high ? high : q;
    }
    room.cell = {};
    return localOf(heldIn(room, pointOf(p)));
}

/// Taubin's filter: rounds of a step inward and a larger one outward [Taubin1995].
///
/// First what many rounds make of the walls is done at once, with vertices held in their rooms at
/// the end only, which leaves kinks round those that are held: without the rounds after it, each
/// vertex held in its room after each step, 20 % more triangles are needed. Measured on balls,
/// tubes and half-balls: fewer rounds leave more of the staircase (area), a wider pass band leaves
/// its long waves, a narrower one shrinks.
constexpr int kRoundsAtOnce = 150, kRounds = 60;
constexpr double kInward = 0.6, kPassBand = 0.005;
constexpr double kOutward = 1 / (kPassBand - 1 / kInward);

/// Amplitude of a wave after the rounds, by 1 - k, k being how far a vertex of it lies from the
/// middle of its neighbours, as a series of Chebyshev polynomials: far fewer steps than rounds.
std::vector<double> seriesOf(int rounds) {
    constexpr int kSamples = 128;
    constexpr double kLeast = 5e-4;
    std::vector<double> series;
    for (int n = 0; n < kSamples / 2; ++n) {
        double sum = 0;
        for (int i = 0; i < kSamples; ++i) {
            const double angle = std::numbers::pi * (i + 0.5) / kSamples;
            const double k = 1 - portable::cos(angle);
            sum += portable::power((1 - kInward * k) * (1 - kOutward * k), rounds) *
                   portable::cos(n * angle);
        }
        series.push_back((n == 0 ? 1.0 : 2.0) / kSamples * sum);
    }
    while (std::abs(series.back()) < kLeast) series.pop_back();
    return series;
}

/// Smooths vertices, in their cells.
class Smoother {
public:
    Smoother(const std::vector<Room>& rooms, const Neighbours& neighbours,
             std::vector<Vec3>&& points)
        : rooms_(rooms), neighbours_(neighbours), ways_(rooms.size()), points_(rooms.size()) {
        const std::vector<Vec3> start = std::move(points);
        for (std::size_t v = 0; v < rooms.size(); ++v) {
            std::array<int, 3> sum{};
            for (const std::uint32_t n : neighbours.at(v)) {
                for (int c = 0; c < 3; ++c) sum[c] += rooms[n].cell[c] - rooms[v].cell[c];
            }
            for (int c = 0; c < 3; ++c) ways_[v][c] = static_cast<std::int8_t>(sum[c]);
            points_[v] = localOf(start[v] - rooms[v].corner());
        }
    }

    /// With the recurrence of Chebyshev polynomials; vertices are held in their rooms at the end.
    void smoothAtOnce(const std::vector<double>& series) {
        std::vector<Local> last = points_, now(points_.size()), moved(points_.size());
        const auto step = [&](float part, bool isFirst) {
            forEach([&](std::int64_t v) {
                const Local middle = middleAt(isFirst ? points_ : now, v);
                last[v] = isFirst ? middle : 2 * middle - last[v];
                moved[v] += part * (last[v] - points_[v]);
            });
            std::swap(last, now);
        };
        for (std::size_t n = 1; n < series.size(); ++n) {
            step(static_cast<float>(series[n]), n == 1);
            if (n == 1) last = points_;
        }
        forEach([&](std::int64_t v) { points_[v] = heldIn(rooms_[v], points_[v] + moved[v]); });
    }

    /// Part of the way to the middle of the neighbours.
    void step(double part) {
        const auto way = static_cast<float>(part);
        next_.resize(points_.size());
        forEach([&](std::int64_t v) {
            const Local p = points_[v];
            next_[v] = heldIn(rooms_[v], p + way * (middleAt(points_, v) - p));
        });
        std::swap(points_, next_);
    }

    /// No more steps follow.
    void end() { freeMemory(next_); }

    Vec3 pointAt(std::size_t v) const { return rooms_[v].corner() + pointOf(points_[v]); }

private:
    template <class F>
    void forEach(const F& f) const {
        parallelForPieces(std::ssize(points_), kGrain, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) f(v);
        });
    }

    Local middleAt(const std::vector<Local>& points, std::int64_t v) const {
        const auto own = neighbours_.at(v);
        if (own.empty()) return points[v];
        const auto& way = ways_[v];
        Local sum{static_cast<float>(way[0]), static_cast<float>(way[1]),
                  static_cast<float>(way[2]), 0};
        for (const std::uint32_t n : own) sum += points[n];
        // a division, not a product: what is flat stays so exactly, which leaves fewer triangles
        return sum / static_cast<float>(own.size());
    }

    const std::vector<Room>& rooms_;
    const Neighbours& neighbours_;
    std::vector<std::array<std::int8_t, 3>> ways_;  ///< sums of the ways to the neighbours' cells
    std::vector<Local> points_, next_;
};

/// Normals of the walls at their vertices, into the wall's greater label; 0 at junctions.
std::vector<Local> wallNormals(const DualComplex& complex, const Neighbours& neighbours,
                               const std::vector<Vec3>& points) {
    std::vector<Local> normals(complex.groupCount);
    for (const DualComplex::Polygon& polygon : complex.polygons) {
        const auto corners = complex.cornersOf(polygon);
        std::array<VertexId, 12> own;
        int count = 0;
        for (const VertexId v : corners) {
            if (v < complex.groupCount) own[count++] = v;
        }
        Vec3 area;
        for (int n = 1; n + 1 < count; ++n) {
            area += areaVector2(points[own[0]], points[own[n]], points[own[n + 1]]);
        }
        if (polygon.labels[0] > polygon.labels[1]) area = -area;
        for (int n = 0; n < count; ++n) normals[own[n]] += localOf(area);
    }
    for (std::size_t v = 0; v < normals.size(); ++v) {
        normals[v] =
            neighbours.isJunction[v] != 0 ? Local{} : localOf(normalized(pointOf(normals[v])));
    }
    return normals;
}

/// Calls f(vertex, where it begins), in parallel.
template <class F>
void forEachStart(const LabelGrid& grid, const DualComplex& complex, const std::vector<Room>& rooms,
                  const F& f) {
    const auto count = static_cast<std::int64_t>(complex.cells.size());
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t c = begin; c < end; ++c) {
            const WallCell& cell = complex.cells[c];
            const std::array<Label, 8> labels = grid.cornersOf(cell.place);
            const CellPattern& pattern = cell.pattern();
            for (int g = 0; g < pattern.groups; ++g) {
                unsigned own = 0;
                for (int t = 0; t < kTetrahedra; ++t) {
                    if (pattern.groupOf[t] == g) own |= cornersOf(t);
                }
                Vec3 sum;
                int crossed = 0;
                for (int a = 0; a < 8; ++a) {
                    for (int axis = 0; axis < 3; ++axis) {
                        const int b = a | 1 << axis;
                        if (a == b || (own >> a & own >> b & 1U) == 0 || labels[a] == labels[b]) {
                            continue;
                        }
                        sum += 0.5 * (offsetOf(a) + offsetOf(b));
                        ++crossed;
                    }
                }
                const Room& room = rooms[cell.firstVertex + g];
                f(cell.firstVertex + g, room.size == kTetrahedra
                                            ? room.corner() + Vec3{0.5, 0.5, 0.5}
                                            : heldIn(room, room.corner() + (1.0 / crossed) * sum));
            }
        }
    });
}

}  // namespace

std::vector<Room> roomsOf(const LabelGrid& grid, const DualComplex& complex) {
    std::vector<Room> rooms(complex.groupCount);
    for (const WallCell& cell : complex.cells) {
        const Index3 index = grid.indexOf(cell.place);
        const CellPattern& pattern = cell.pattern();
        for (int g = 0; g < pattern.groups; ++g) {
            Room& room = rooms[cell.firstVertex + g];
            for (int axis = 0; axis < 3; ++axis) {
                room.cell[axis] = static_cast<std::int32_t>(index[axis]);
            }
            room.first = pattern.first[g];
            room.size = pattern.size[g];
        }
    }
    return rooms;
}

Vec3 heldIn(const Room& room, const Vec3& p) {
    const Vec3 corner = room.corner();
    Vec3 q = p - corner;
    if (room.size == kTetrahedra) {
        for (int axis = 0; axis < 3; ++axis)
            q[axis] = std::clamp(q[axis], kLeastGap, 1 - kLeastGap);
        return corner + q;
    }
    const int last = (room.first + room.size - 1) % kTetrahedra;
    Vec3 middle;
    for (int n = 0; n < room.size; ++n) middle += middleOf((room.first + n) % kTetrahedra);
    middle = (1.0 / room.size) * middle;
    double part = 1;
    for (int axis = 0; axis < 3; ++axis) {
        part = std::min({part, partOfWay(middle[axis], q[axis], kLeastGap),
                         partOfWay(1 - middle[axis], 1 - q[axis], kLeastGap)});
    }
    for (const auto& [high, low] : {axesOf(room.first, room.first), axesOf(after(last), last)}) {
        part = std::min(part, partOfWay(middle[high] - middle[low], q[high] - q[low], kLeastGap));
    }
    return corner + middle + part * (q - middle);
}

Neighbours neighboursOf(const DualComplex& complex) {
    Neighbours n;
    n.isJunction.assign(complex.groupCount, 0);
    std::vector<std::uint8_t>& isJunction = n.isJunction;
    for (const Adjacency& edge : complex.adjacencies) {
        if (edge.isJunction) isJunction[edge.a] = isJunction[edge.b] = 1;
    }
    n.begin.assign(complex.groupCount + 1, 0);
    const auto forEach = [&](const auto& f) {
        for (const Adjacency& edge : complex.adjacencies) {
            if (edge.isJunction || isJunction[edge.a] == 0) f(edge.a, edge.b);
            if (edge.isJunction || isJunction[edge.b] == 0) f(edge.b, edge.a);
        }
    };
    forEach([&](VertexId v, VertexId) { ++n.begin[v + 1]; });
    for (std::size_t v = 1; v < n.begin.size(); ++v) n.begin[v] += n.begin[v - 1];
    n.of.resize(n.begin.back());
    std::vector<std::uint32_t> at(n.begin.begin(), n.begin.end() - 1);
    forEach([&](VertexId v, VertexId w) { n.of[at[v]++] = static_cast<std::uint32_t>(w); });
    return n;
}

std::vector<Vec3> startPoints(const LabelGrid& grid, const DualComplex& complex,
                              const std::vector<Room>& rooms) {
    std::vector<Vec3> points(complex.groupCount);
    forEachStart(grid, complex, rooms, [&](std::size_t v, const Vec3& p) { points[v] = p; });
    return points;
}

std::vector<Vec3> smooth(const std::vector<Room>& rooms, const Neighbours& neighbours,
                         std::vector<Vec3>&& points) {
    Smoother smoother(rooms, neighbours, std::move(points));
    static const std::vector<double> series = seriesOf(kRoundsAtOnce);
    smoother.smoothAtOnce(series);
    for (int round = 0; round < kRounds; ++round) {
        smoother.step(kInward);
        smoother.step(kOutward);
    }
    smoother.end();
    std::vector<Vec3> smoothed(rooms.size());
    for (std::size_t v = 0; v < smoothed.size(); ++v) {
        smoothed[v] = heldIn(rooms[v], smoother.pointAt(v));
    }
    return smoothed;
}

/// Smoothing sinks curved walls. Where the way along the normal, on average over the
/// neighbourhood, is more than a sheet of voxels leaves open anyway, what is more is taken back.
void takeBackShift(const LabelGrid& grid, const DualComplex& complex,
                   const std::vector<Room>& rooms, const Neighbours& neighbours,
                   std::vector<Vec3>& points) {
    constexpr double kFreeShift = 0.07;  // voxels: tubes of radius 4 keep their true volume
    constexpr int kSteps = 20;           // steps of averaging: some 4 voxels around
    const std::vector<Local> normals = wallNormals(complex, neighbours, points);
    const auto hasNormal = [&](std::size_t v) {
        return normals[v][0] != 0 || normals[v][1] != 0 || normals[v][2] != 0;
    };
    std::vector<float> shift(points.size()), next(points.size());
    forEachStart(grid, complex, rooms, [&](std::size_t v, const Vec3& start) {
        shift[v] = static_cast<float>(dot(points[v] - start, pointOf(normals[v])));
    });
    for (int step = 0; step < kSteps; ++step) {
        parallelForPieces(complex.groupCount, kGrain, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) {
                if (!hasNormal(v)) continue;
                float sum = shift[v], count = 1;
                for (const std::uint32_t n : neighbours.at(v)) {
                    if (!hasNormal(n)) continue;
                    sum += shift[n];
                    ++count;
                }
                next[v] = sum / count;
            }
        });
        std::swap(shift, next);
    }
    for (std::size_t v = 0; v < points.size(); ++v) {
        const double own = shift[v], excess = own - std::clamp(own, -kFreeShift, kFreeShift);
        if (excess == 0 || !hasNormal(v)) continue;
        points[v] = heldIn(rooms[v], points[v] - excess * pointOf(normals[v]));
    }
}

std::int64_t countHeld(const DualComplex& complex, const std::vector<Room>& rooms,
                       const std::vector<Vec3>& points) {
    std::int64_t held = 0;
    for (VertexId v = 0; v < complex.groupCount; ++v) {
        const Vec3 q = points[v] - rooms[v].corner();
        bool isHeld = false;
        for (int axis = 0; axis < 3; ++axis) {
            isHeld = isHeld || q[axis] <= kLeastGap || q[axis] >= 1 - kLeastGap;
        }
        held += isHeld ? 1 : 0;
    }
    return held;
}

void appendFacePoints(const LabelGrid& grid, const DualComplex& complex,
                      std::vector<Vec3>& points) {
    for (const FacePoint& face : facePoints(grid, complex)) {
        const Index3 index = grid.indexOf(face.cell);
        const Vec3 corner{static_cast<double>(index[0]), static_cast<double>(index[1]),
                          static_cast<double>(index[2])};
        std::array<Vec3, 3> c;
        for (int n = 0; n < 3; ++n) c[n] = corner + offsetOf(face.face[n]);
        const Vec3 normal = areaVector2(c[0], c[1], c[2]);
        const Vec3 a = points[face.between[0]], b = points[face.between[1]];
        const double from = dot(a - c[0], normal), into = dot(b - c[0], normal);
        const Vec3 passed = a + from / (from - into) * (b - a);
        const double area = squaredNorm(normal);
        double part = 1;
        for (int n = 0; n < 3; ++n) {  // barycentric, 1/3 in the middle
            const double weight =
                dot(areaVector2(passed, c[(n + 1) % 3], c[(n + 2) % 3]), normal) / area;
            part = std::min(part, partOfWay(1.0 / 3, weight, 4 * kLeastGap));
        }
        const Vec3 middle = (1.0 / 3) * (c[0] + c[1] + c[2]);
        points.push_back(middle + part * (passed - middle));
    }
}

}  // namespace adaptiso::detail
