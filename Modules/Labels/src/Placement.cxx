#include "Placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = 4096;

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

/// Of each vertex, its neighbours that count.
struct Neighbours {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint32_t> of;

    std::span<const std::uint32_t> at(std::size_t v) const {
        return {of.data() + begin[v], begin[v + 1] - begin[v]};
    }
};

Neighbours neighboursOf(const DualComplex& complex) {
    std::vector<std::uint8_t> isJunction(complex.groupCount, 0);
    for (const Adjacency& edge : complex.adjacencies) {
        if (edge.isJunction) isJunction[edge.a] = isJunction[edge.b] = 1;
    }
    Neighbours n;
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

/// Normals of the walls at their vertices, into the wall's greater label; 0 at junctions.
std::vector<Vec3> wallNormals(const DualComplex& complex, const std::vector<Vec3>& points) {
    std::vector<Vec3> normals(complex.groupCount);
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
        for (int n = 0; n < count; ++n) normals[own[n]] += area;
    }
    for (Vec3& normal : normals) normal = normalized(normal);
    for (const Adjacency& edge : complex.adjacencies) {
        if (edge.isJunction) normals[edge.a] = normals[edge.b] = {};
    }
    return normals;
}

/// What smoothing needs to know of a vertex beside its neighbours.
struct Place {
    std::array<std::int8_t, 3> toCells;  ///< sum of the ways to its neighbours' cells
    bool isWhole;                        ///< its room is all of its cell
};

std::vector<Place> placesOf(const std::vector<Room>& rooms, const Neighbours& neighbours) {
    std::vector<Place> places(rooms.size());
    for (std::size_t v = 0; v < rooms.size(); ++v) {
        std::array<int, 3> sum{};
        for (const std::uint32_t n : neighbours.at(v)) {
            for (int c = 0; c < 3; ++c) sum[c] += rooms[n].cell[c] - rooms[v].cell[c];
        }
        for (int c = 0; c < 3; ++c) places[v].toCells[c] = static_cast<std::int8_t>(sum[c]);
        places[v].isWhole = rooms[v].size == kTetrahedra;
    }
    return places;
}

/// Where smoothing moves a vertex: part of the way to the middle of its neighbours, in its room.
/// \param points  in their cells
Vec3 moved(const std::vector<Vec3>& points, std::size_t v, const Place& place,
           std::span<const std::uint32_t> neighbours, double part) {
    Vec3 sum{static_cast<double>(place.toCells[0]), static_cast<double>(place.toCells[1]),
             static_cast<double>(place.toCells[2])};
    for (const std::uint32_t n : neighbours) sum += points[n];
    // a division, not a product: what is flat stays so exactly, which leaves fewer triangles
    const auto count = static_cast<double>(neighbours.size());
    const Vec3 middle{sum.x / count, sum.y / count, sum.z / count};
    const Vec3 p = points[v] + part * (middle - points[v]);
    if (!place.isWhole) return p;
    const auto held = [](double x) { return std::min(std::max(x, kLeastGap), 1 - kLeastGap); };
    return {held(p.x), held(p.y), held(p.z)};
}

/// Taubin's filter: rounds of a step inward and a larger one outward.
void smooth(const std::vector<Room>& rooms, const Neighbours& neighbours,
            std::vector<Vec3>& points) {
    // Measured on balls, tubes and half-balls: fewer rounds leave more of the staircase (area), a
    // wider pass band leaves its long waves, a narrower one shrinks. In single precision flat
    // walls would not stay flat.
    constexpr int kRounds = 150;
    constexpr double kInward = 0.6, kPassBand = 0.005;
    constexpr double kOutward = 1 / (kPassBand - 1 / kInward);
    const std::vector<Place> places = placesOf(rooms, neighbours);
    for (std::size_t v = 0; v < points.size(); ++v) points[v] = points[v] - rooms[v].corner();
    std::vector<Vec3> next(points.size());
    const auto move = [&](double part) {
        parallelForPieces(std::ssize(points), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) {
                const auto own = neighbours.at(v);
                next[v] = own.empty() ? points[v] : moved(points, v, places[v], own, part);
                if (places[v].isWhole) continue;
                Room room = rooms[v];
                room.cell = {};
                next[v] = heldIn(room, next[v]);
            }
        });
        std::swap(points, next);
    };
    for (int round = 0; round < kRounds; ++round) {
        move(kInward);
        move(kOutward);
    }
    for (std::size_t v = 0; v < points.size(); ++v) {
        points[v] = heldIn(rooms[v], rooms[v].corner() + points[v]);
    }
}

/// Smoothing sinks curved walls. Where the way along the normal, on average over the
/// neighbourhood, is more than a sheet of voxels leaves open anyway, what is more is taken back.
void takeBackShift(const DualComplex& complex, const std::vector<Room>& rooms,
                   const Neighbours& neighbours, const std::vector<Vec3>& start,
                   std::vector<Vec3>& points) {
    constexpr double kFreeShift = 0.07;  // voxels: tubes of radius 4 keep their true volume
    constexpr int kRounds = 20;          // steps of averaging: some 4 voxels around
    const std::vector<Vec3> normals = wallNormals(complex, points);
    std::vector<double> shift(points.size()), next(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        shift[v] = dot(points[v] - start[v], normals[v]);
    }
    for (int round = 0; round < kRounds; ++round) {
        parallelForPieces(complex.groupCount, kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) {
                if (normals[v] == Vec3{}) continue;
                double sum = shift[v], count = 1;
                for (auto n = neighbours.begin[v]; n < neighbours.begin[v + 1]; ++n) {
                    if (normals[neighbours.of[n]] == Vec3{}) continue;
                    sum += shift[neighbours.of[n]];
                    ++count;
                }
                next[v] = sum / count;
            }
        });
        std::swap(shift, next);
    }
    for (std::size_t v = 0; v < points.size(); ++v) {
        const double excess = shift[v] - std::clamp(shift[v], -kFreeShift, kFreeShift);
        if (excess != 0 && !(normals[v] == Vec3{})) {
            points[v] = heldIn(rooms[v], points[v] - excess * normals[v]);
        }
    }
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

std::vector<Vec3> startPoints(const LabelGrid& grid, const DualComplex& complex,
                              const std::vector<Room>& rooms) {
    std::vector<Vec3> points(complex.groupCount);
    const auto count = static_cast<std::int64_t>(complex.cells.size());
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
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
                points[cell.firstVertex + g] =
                    room.size == kTetrahedra ? room.corner() + Vec3{0.5, 0.5, 0.5}
                                             : heldIn(room, room.corner() + (1.0 / crossed) * sum);
            }
        }
    });
    return points;
}

void relax(const DualComplex& complex, const std::vector<Room>& rooms, std::vector<Vec3>& points) {
    const Neighbours neighbours = neighboursOf(complex);
    const std::vector<Vec3> start = points;
    smooth(rooms, neighbours, points);
    takeBackShift(complex, rooms, neighbours, start, points);
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
