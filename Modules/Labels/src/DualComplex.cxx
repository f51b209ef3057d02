#include "DualComplex.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

namespace {

constexpr std::int64_t kNoCell = -1;
constexpr std::int64_t kCellPiece = 4096;

/// Bits of WallCell::points: the inner face before tetrahedron t; the triangles of the sides that
/// the cell shares with the one before it along each axis.
constexpr int innerBit(int t) {
    return t;
}
constexpr int sideBit(int axis, int triangle) {
    return kTetrahedra + 2 * axis + triangle;
}

void requireFewer(std::int64_t count) {
    if (count >= std::int64_t{kMostDualVertices}) {
        throw InvalidInput("extractLabels: the walls have more corners than can be counted: " +
                           std::to_string(count));
    }
}

/// The cells that a wanted wall runs through; a polygon of one has its corners in these alone.
std::vector<WallCell> findCells(const LabelGrid& grid) {
    const auto isWanted = [&](Label label) { return grid.isWanted(label); };
    std::vector<std::vector<WallCell>> layers(grid.size[2] - 1);
    parallelForPieces(grid.size[2] - 1, 1, [&](std::int64_t k, std::int64_t) {
        for (std::int64_t j = 0; j + 1 < grid.size[1]; ++j) {
            std::int64_t place = grid.placeOf(0, j, k);
            const auto isColumnOf = [&](std::int64_t at, Label label) {
                return grid.labels[at] == label && grid.labels[at + grid.step(2)] == label &&
                       grid.labels[at + grid.step(4)] == label &&
                       grid.labels[at + grid.step(6)] == label;
            };
            Label last = grid.labels[place];
            bool isUniform = isColumnOf(place, last);
            for (std::int64_t i = 0; i + 1 < grid.size[0]; ++i, ++place) {
                const Label next = grid.labels[place + 1];
                const bool isNextUniform = isColumnOf(place + 1, next);
                if (!isUniform || !isNextUniform || next != last) {
                    const std::array<Label, 8> corners = grid.cornersOf(place);
                    if (std::ranges::any_of(corners, isWanted)) {
                        WallCell cell;
                        cell.place = place;
                        cell.code = static_cast<std::uint16_t>(patternCode(corners));
                        layers[k].push_back(cell);
                    }
                }
                last = next;
                isUniform = isNextUniform;
            }
        }
    });
    std::vector<WallCell> cells;
    std::size_t count = 0;
    for (const auto& layer : layers) count += layer.size();
    cells.reserve(count);
    VertexId vertices = 0;
    for (auto& layer : layers) {
        const std::vector<WallCell> own = std::move(layer);
        for (WallCell cell : own) {
            cell.firstVertex = static_cast<DualId>(vertices);
            vertices += cell.pattern().groups;
            cells.push_back(cell);
        }
    }
    requireFewer(vertices);
    return cells;
}

/// Finds cells by their places.
class CellFinder {
public:
    CellFinder(const LabelGrid& grid, const std::vector<WallCell>& cells)
        : grid_(grid), cells_(cells), rowBegin_(grid.size[1] * grid.size[2] + 1) {
        std::size_t n = 0;
        for (std::size_t row = 0; row < rowBegin_.size(); ++row) {
            const auto begin = static_cast<std::int64_t>(row) * grid.size[0];
            while (n < cells.size() && cells[n].place < begin) ++n;
            rowBegin_[row] = static_cast<std::int64_t>(n);
        }
    }

    std::int64_t at(std::int64_t place) const {
        const std::int64_t row = place / grid_.size[0];
        const auto begin = cells_.begin() + rowBegin_[row],
                   end = cells_.begin() + rowBegin_[row + 1];
        const auto found = std::lower_bound(
            begin, end, place, [](const WallCell& c, std::int64_t p) { return c.place < p; });
        return found != end && found->place == place ? found - cells_.begin() : kNoCell;
    }

    /// The cells round a cell's first corner; number o lies before it along the axes of o's bits.
    std::array<std::int64_t, 8> before(std::int64_t cell) const {
        std::array<std::int64_t, 8> found;
        const std::int64_t place = cells_[cell].place;
        const Index3 index = grid_.indexOf(place);
        found[0] = cell;
        for (int o = 1; o < 8; ++o) {
            const bool isInside = ((o & 1) == 0 || index[0] > 0) &&
                                  ((o & 2) == 0 || index[1] > 0) && ((o & 4) == 0 || index[2] > 0);
            found[o] = isInside ? at(place - grid_.step(o)) : kNoCell;
        }
        return found;
    }

private:
    const LabelGrid& grid_;
    const std::vector<WallCell>& cells_;
    std::vector<std::int64_t> rowBegin_;
};

template <class T>
bool areAlike(const std::array<T, 3>& three) {
    return three[0] == three[1] && three[0] == three[2];
}

/// One face that two groups share, or two triangles of a side that they share both.
struct SharedFace {
    VertexId a, b;
    int bit;        ///< of WallCell::points
    bool hasPoint;  ///< the groups are not convex together
    bool isJunction;
};

int countLabels(std::array<Label, 4> labels) {
    std::sort(labels.begin(), labels.end());
    return static_cast<int>(std::unique(labels.begin(), labels.end()) - labels.begin());
}

/// Calls f(SharedFace) for what groups share inside a cell.
template <class F>
void forEachInnerFace(const LabelGrid& grid, const WallCell& cell, const F& f) {
    const CellPattern& pattern = cell.pattern();
    if (pattern.groups < 2) return;
    const std::array<Label, 8> labels = grid.cornersOf(cell.place);
    const bool isHalved = pattern.groups == 2 && pattern.size[0] + pattern.size[1] == kTetrahedra;
    for (int t = 0; t < kTetrahedra; ++t) {
        const int g = pattern.groupOf[before(t)], h = pattern.groupOf[t];
        if (g == h || g == CellPattern::kNone || h == CellPattern::kNone) continue;
        if (areAlike<Label>({labels[0], labels[7], labels[kRing[t]]})) continue;
        const std::array<Label, 4> around{labels[0], labels[7], labels[kRing[t]],
                                          isHalved ? labels[kRing[(t + 3) % 6]] : labels[0]};
        f(SharedFace{cell.firstVertex + g, cell.firstVertex + h, innerBit(t),
                     !isHalved && pattern.size[g] + pattern.size[h] > 3, countLabels(around) > 2});
    }
}

/// Calls f(SharedFace) for what groups of a cell share with those of the one before it along an
/// axis.
template <class F>
void forEachSideFace(const LabelGrid& grid, const WallCell& cell, const WallCell& previous,
                     int axis, const F& f) {
    const std::array<Label, 8> labels = grid.cornersOf(cell.place);
    const CellPattern &pattern = cell.pattern(), &other = previous.pattern();
    const auto shared = [&](int n) {
        const int g = other.groupOf[kSideTetrahedra[axis][1][n]],
                  h = pattern.groupOf[kSideTetrahedra[axis][0][n]];
        return std::array<VertexId, 2>{previous.firstVertex + g, cell.firstVertex + h};
    };
    const auto labelsOf = [&](int n) {
        const std::array<int, 3> t = sideTriangle(axis, 0, n);
        return std::array<Label, 3>{labels[t[0]], labels[t[1]], labels[t[2]]};
    };
    const std::array<std::array<Label, 3>, 2> around{labelsOf(0), labelsOf(1)};
    const std::array<bool, 2> isMixed{!areAlike(around[0]), !areAlike(around[1])};
    const auto isWhole = [](const CellPattern& p) { return p.isWhole(); };
    const bool areWhole = isWhole(pattern) && isWhole(other);
    if ((isMixed[0] && isMixed[1] && shared(0) == shared(1)) ||
        (areWhole && (isMixed[0] || isMixed[1]))) {
        const auto [a, b] = shared(isMixed[0] ? 0 : 1);
        f(SharedFace{a, b, sideBit(axis, 0), false,
                     countLabels({around[0][0], around[0][1], around[0][2], around[1][1]}) > 2});
        return;
    }
    for (int n = 0; n < 2; ++n) {
        if (!isMixed[n]) continue;
        const auto [a, b] = shared(n);
        f(SharedFace{a, b, sideBit(axis, n), true,
                     countLabels({around[n][0], around[n][1], around[n][2], around[n][0]}) > 2});
    }
}

template <class F>
void forEachFace(const LabelGrid& grid, const std::vector<WallCell>& cells, std::int64_t c,
                 const std::array<std::int64_t, 8>& before, const F& f) {
    forEachInnerFace(grid, cells[c], f);
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t previous = before[1 << axis];
        if (previous != kNoCell) forEachSideFace(grid, cells[c], cells[previous], axis, f);
    }
}

/// Marks the faces that need a point, and lists what groups share.
void findFaces(const LabelGrid& grid, const CellFinder& finder, DualComplex& complex) {
    const auto count = static_cast<std::int64_t>(complex.cells.size());
    std::vector<std::vector<Adjacency>> found((count + kCellPiece - 1) / kCellPiece);
    parallelForPieces(count, kCellPiece, [&](std::int64_t begin, std::int64_t end) {
        std::vector<Adjacency>& own = found[begin / kCellPiece];
        for (std::int64_t c = begin; c < end; ++c) {
            unsigned points = 0;
            forEachFace(grid, complex.cells, c, finder.before(c), [&](const SharedFace& face) {
                if (face.hasPoint) points |= 1U << face.bit;
                own.push_back({static_cast<DualId>(face.a),
                               static_cast<DualId>(face.b) & (kMostDualVertices - 1),
                               face.isJunction ? 1U : 0U});
            });
            complex.cells[c].points = static_cast<std::uint16_t>(points);
        }
    });
    std::size_t all = 0;
    for (const auto& own : found) all += own.size();
    complex.adjacencies.reserve(all);
    for (auto& own : found) {
        complex.adjacencies.insert(complex.adjacencies.end(), own.begin(), own.end());
        freeMemory(own);
    }
    complex.groupCount = complex.cells.empty() ? 0
                                               : complex.cells.back().firstVertex +
                                                     complex.cells.back().pattern().groups;
    for (WallCell& cell : complex.cells) {
        cell.firstPoint = static_cast<DualId>(complex.groupCount + complex.pointCount);
        complex.pointCount += std::popcount(cell.points);
    }
    requireFewer(complex.groupCount + complex.pointCount);
}

/// The point on a face, or -1.
VertexId facePoint(const WallCell& cell, int bit) {
    if ((cell.points >> bit & 1U) == 0) return -1;
    return cell.firstPoint + std::popcount(cell.points & ((1U << bit) - 1));
}

/// A tetrahedron round a lattice edge, in its cell.
struct Around {
    int offset;  ///< of the cell, as CellFinder::before() counts
    int tetrahedron;
};

/// The bit of the face that two tetrahedra share, and which of their cells has it.
struct Passage {
    int offset;
    int bit;
};
Passage passageBetween(const Around& from, const Around& into) {
    if (from.offset == into.offset) {
        const int t =
            into.tetrahedron == after(from.tetrahedron) ? into.tetrahedron : from.tetrahedron;
        return {from.offset, innerBit(t)};
    }
    const int axis = std::countr_zero(static_cast<unsigned>(from.offset ^ into.offset));
    const Around& upper = (from.offset >> axis & 1) == 0 ? from : into;
    const int triangle = kSideTetrahedra[axis][0][0] == upper.tetrahedron ? 0 : 1;
    return {upper.offset, sideBit(axis, triangle)};
}

/// The corners of the polygon of a lattice edge of a cell.
struct EdgeCorners {
    std::array<VertexId, 12> vertices;
    int count = 0;
    bool isWhole = true;

    void push(VertexId v) { vertices[count++] = v; }
};
EdgeCorners cornersOfEdge(const std::vector<WallCell>& cells,
                          const std::array<std::int64_t, 8>& before, int kind) {
    const EdgeRing& ring = edgeRing(kind);
    std::array<Around, 6> around;
    std::array<VertexId, 6> vertex;
    EdgeCorners corners;
    for (int n = 0; n < ring.count; ++n) {
        const auto& [at, t] = ring.around[n];
        around[n] = {-(at[0] + 2 * at[1] + 4 * at[2]), t};
        const WallCell& cell = cells[before[around[n].offset]];
        vertex[n] = cell.firstVertex + cell.pattern().groupOf[t];
        corners.isWhole = corners.isWhole && cell.pattern().isWhole();
    }
    for (int n = 0; n < ring.count; ++n) {
        const int next = (n + 1) % ring.count;
        if (vertex[n] == vertex[next]) continue;
        corners.push(vertex[n]);
        const Passage passage = passageBetween(around[n], around[next]);
        const VertexId point = facePoint(cells[before[passage.offset]], passage.bit);
        if (point >= 0) corners.push(point);
    }
    return corners;
}

}  // namespace

DualComplex makeDualComplex(const LabelGrid& grid) {
    DualComplex complex;
    complex.cells = findCells(grid);
    findFaces(grid, CellFinder(grid, complex.cells), complex);
    return complex;
}

void addPolygons(const LabelGrid& grid, DualComplex& complex) {
    const CellFinder finder(grid, complex.cells);
    const auto count = static_cast<std::int64_t>(complex.cells.size());
    struct Piece {
        std::vector<DualComplex::Polygon> polygons;
        std::vector<DualId> corners;
    };
    std::vector<Piece> pieces((count + kCellPiece - 1) / kCellPiece);
    parallelForPieces(count, kCellPiece, [&](std::int64_t begin, std::int64_t end) {
        Piece& piece = pieces[begin / kCellPiece];
        for (std::int64_t c = begin; c < end; ++c) {
            const std::int64_t place = complex.cells[c].place;
            const std::array<Label, 8> labels = grid.cornersOf(place);
            const auto before = finder.before(c);
            for (int kind = 1; kind <= kEdgeKinds; ++kind) {
                if (labels[0] == labels[kind]) continue;
                if (!grid.isWanted(labels[0]) && !grid.isWanted(labels[kind])) continue;
                const EdgeCorners corners = cornersOfEdge(complex.cells, before, kind);
                if (corners.count < 3) continue;
                piece.polygons.push_back({place,
                                          {labels[0], labels[kind]},
                                          static_cast<std::uint32_t>(piece.corners.size()),
                                          static_cast<std::uint8_t>(kind),
                                          static_cast<std::uint8_t>(corners.count),
                                          corners.isWhole});
                for (int n = 0; n < corners.count; ++n) {
                    piece.corners.push_back(static_cast<DualId>(corners.vertices[n]));
                }
            }
        }
    });
    std::size_t polygons = 0, corners = 0;
    for (const Piece& piece : pieces) {
        polygons += piece.polygons.size();
        corners += piece.corners.size();
    }
    complex.polygons.reserve(polygons);
    complex.corners.reserve(corners);
    requireFewer(static_cast<std::int64_t>(corners));
    for (Piece& piece : pieces) {
        const auto first = static_cast<std::uint32_t>(complex.corners.size());
        for (DualComplex::Polygon polygon : piece.polygons) {
            polygon.begin += first;
            complex.polygons.push_back(polygon);
        }
        complex.corners.insert(complex.corners.end(), piece.corners.begin(), piece.corners.end());
        piece = {};
    }
}

std::vector<FacePoint> facePoints(const LabelGrid& grid, const DualComplex& complex) {
    const CellFinder finder(grid, complex.cells);
    std::vector<FacePoint> points;
    points.reserve(complex.pointCount);
    for (std::size_t c = 0; c < complex.cells.size(); ++c) {
        const WallCell& cell = complex.cells[c];
        if (cell.points == 0) continue;
        const auto n = static_cast<std::int64_t>(c);
        forEachFace(grid, complex.cells, n, finder.before(n), [&](const SharedFace& face) {
            if (!face.hasPoint) return;
            const int side = face.bit - kTetrahedra;
            points.push_back({{face.a, face.b},
                              cell.place,
                              side < 0 ? std::array<int, 3>{0, kRing[face.bit], 7}
                                       : sideTriangle(side / 2, 0, side % 2)});
        });
    }
    return points;
}

}  // namespace adaptiso::detail
