#include "MendRegion.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::detail {
namespace {

/// A square of the lattice, its corners counter-clockwise seen from larger coordinates.
struct Square {
    std::uint64_t face;
    int axis;
    double plane;
    std::array<LatticePosition, 4> position;
    std::array<Vec3, 4> corner;

    Square(const MendLattice& lattice, std::uint64_t number) : face(number), axis(axisOf(number)) {
        const LatticePosition low = positionOf(number >> 2);
        const int u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        plane = lattice.coordinate(axis, low[axis]);
        position = {low, moved(low, u, 1), moved(moved(low, u, 1), v, 1), moved(low, v, 1)};
        for (int i = 0; i < 4; ++i) corner[i] = lattice.at(position[i]);
    }
    /// The lattice edge between corners i and i + 1.
    std::uint64_t edge(int i) const {
        const int u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        switch (i) {
            case 0:
                return keyOf(position[0], u);
            case 1:
                return keyOf(position[1], v);
            case 2:
                return keyOf(position[3], u);
            default:
                return keyOf(position[0], v);
        }
    }
    int sideOfEdge(std::uint64_t number) const {
        for (int i = 0; i < 3; ++i) {
            if (edge(i) == number) return i;
        }
        return 3;
    }
};

/// A triangle's section with a square. None where there is none.
/// \param isUnclear  set where a corner or an edge is touched
std::optional<FacePiece> sectionOf(const MendInput& input, std::uint32_t triangle,
                                   const Square& square, bool& isUnclear) {
    const Corners t = cornersOf(input.mesh, triangle);
    std::array<int, 3> above;
    for (int i = 0; i < 3; ++i) {
        const double height = t[i][square.axis] - square.plane;
        above[i] = height > 0 ? 1 : -1;
        if (height == 0) isUnclear = true;
    }
    if (isUnclear || (above[0] == above[1] && above[1] == above[2])) return std::nullopt;
    std::array<int, 4> side;
    for (int i = 0; i < 4; ++i) {
        side[i] = orient3d(t[0], t[1], t[2], square.corner[i]);
        if (side[i] == 0) isUnclear = true;
    }
    if (isUnclear) return std::nullopt;
    if (side[0] == side[1] && side[1] == side[2] && side[2] == side[3]) return std::nullopt;
    // of each corner of the triangle's next edge and the square's next edge
    std::array<std::array<int, 4>, 3> turn;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
            turn[i][j] =
                orient3d(t[i], t[(i + 1) % 3], square.corner[j], square.corner[(j + 1) % 4]);
        }
    }
    FacePiece piece;
    piece.triangle = triangle;
    int starts = 0, ends = 0;
    const auto add = [&](bool isStart, const FaceNode& node) {
        (isStart ? piece.start : piece.end) = node;
        ++(isStart ? starts : ends);
    };
    for (int i = 0; i < 3; ++i) {
        if (above[i] == above[(i + 1) % 3]) continue;
        const auto& [a, b, c, d] = turn[i];
        if (a == 0 || b == 0 || c == 0 || d == 0) {
            isUnclear = true;
        } else if (a == b && b == c && c == d) {
            add(above[i] > 0, {false, input.edgeOf[triangle][i]});
        }
    }
    for (int j = 0; j < 4; ++j) {
        if (side[j] == side[(j + 1) % 4]) continue;
        const int a = turn[0][j], b = turn[1][j], c = turn[2][j];
        if (a == 0 || b == 0 || c == 0) {
            isUnclear = true;
        } else if (a == b && b == c) {
            add(side[j] < 0, {true, square.edge(j)});
        }
    }
    if (starts == 0 && ends == 0) return std::nullopt;
    if (starts != 1 || ends != 1) isUnclear = true;
    return piece;
}

/// Puts pieces in order from lattice edge to lattice edge. \return false where they are no one line
bool putInOrder(std::vector<FacePiece>& pieces) {
    const auto begins = [](const FacePiece& piece) { return piece.start.isOnLattice; };
    for (std::size_t n = 0; n < pieces.size(); ++n) {
        const auto next =
            std::find_if(pieces.begin() + static_cast<std::ptrdiff_t>(n), pieces.end(),
                         [&](const FacePiece& piece) {
                             return n == 0 ? begins(piece) : piece.start == pieces[n - 1].end;
                         });
        if (next == pieces.end() || (n > 0 && pieces[n - 1].end.isOnLattice)) return false;
        std::iter_swap(pieces.begin() + static_cast<std::ptrdiff_t>(n), next);
    }
    return pieces.back().end.isOnLattice &&
           pieces.front().start.number != pieces.back().end.number &&
           std::count_if(pieces.begin(), pieces.end(), begins) == 1;
}

}  // namespace

MendRegion::MendRegion(const MendInput& input, const AabbTree& tree, const WindingField& field,
                       const MendLattice& lattice)
    : input_(input), tree_(tree), field_(field), lattice_(lattice) {}

void MendRegion::insert(const LatticePosition& cell) {
    for (const std::int64_t i : cell) {
        if (i < 1 || i >= (1 << kLatticeBits) - 2) {
            throw InvalidInput("mend: the triangles have no inside: they are open or one-sided");
        }
    }
    if (!cells_.insert(keyOf(cell)).second) return;
    added_.push_back(keyOf(cell));
    if (cells_.size() > kMostCells) {
        throw InvalidInput("mend: more than " + formatCount(kMostCells) + " cells of " +
                           formatShort(lattice_.spacing()) +
                           " mm would have to be made anew; a larger bound takes fewer");
    }
}

void MendRegion::add(const std::vector<std::uint64_t>& cells) {
    for (const std::uint64_t cell : cells) insert(positionOf(cell));
}

void MendRegion::addFaults() {
    const auto& points = input_.mesh.points;
    const auto addCell = [&](const LatticePosition& cell) { insert(cell); };
    for (const MendInput::Edge& edge : input_.edges) {
        if (edge.isSound || edge.a == edge.b) continue;
        forEachCellOf({points[edge.a], points[edge.b], points[edge.b]}, addCell);
    }
    for (const std::uint32_t v : input_.badVertices) insert(lattice_.cellOf(points[v]));
    for (const auto& [s, t] : input_.crossingPairs) {
        const Corners a = cornersOf(input_.mesh, s), b = cornersOf(input_.mesh, t);
        const BoundingBox first = boxOf(a), second = boxOf(b);
        BoundingBox both = first;
        for (int axis = 0; axis < 3; ++axis) {
            both.minimum[axis] = std::max(both.minimum[axis], second.minimum[axis]);
            both.maximum[axis] = std::min(both.maximum[axis], second.maximum[axis]);
        }
        forEachCell(
            lattice_, lattice_.cellOf(both.minimum), lattice_.cellOf(both.maximum),
            [&](const BoundingBox& box) { return mayTouch(a, box) && mayTouch(b, box); }, addCell);
    }
    for (const std::uint32_t t : input_.undecided) {
        forEachCellOf(cornersOf(input_.mesh, t), addCell);
    }
}

void MendRegion::findWindings() {
    std::vector<std::uint64_t> corners;
    corners.reserve(8 * added_.size());
    for (const std::uint64_t cell : added_) {
        for (int c = 0; c < kBoxCorners; ++c) {
            const std::uint64_t key = keyOf(cornerOfCell(positionOf(cell), c));
            if (!winding_.contains(key)) corners.push_back(key);
        }
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<double> found(corners.size());
    parallelForPieces(std::ssize(corners), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            found[n] = field_.at(lattice_.at(positionOf(corners[n])));
        }
    });
    for (std::size_t n = 0; n < corners.size(); ++n) winding_.emplace(corners[n], found[n]);
}

void MendRegion::grow() {
    while (!added_.empty()) {
        findWindings();
        std::vector<std::pair<std::uint64_t, std::uint64_t>> faces;  // and the cell beyond
        for (const std::uint64_t cell : added_) {
            for (int f = 0; f < kBoxFaces; ++f) {
                const LatticePosition at = positionOf(cell), beyond = neighbourOf(at, f);
                if (!contains(beyond)) faces.emplace_back(faceOfCell(at, f), keyOf(beyond));
            }
        }
        added_.clear();
        std::sort(faces.begin(), faces.end());
        std::vector<FaceTrace> traces(faces.size());
        parallelForPieces(std::ssize(faces), 32, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) traces[n] = findTrace(faces[n].first);
        });
        for (std::size_t n = 0; n < faces.size(); ++n) {
            if (traces[n].kind == FaceTrace::Kind::Unclear) insert(positionOf(faces[n].second));
        }
        for (std::size_t n = 0; n < faces.size(); ++n) {
            if (traces[n].kind == FaceTrace::Kind::None) continue;
            traces_.emplace(faces[n].first, std::move(traces[n]));
        }
    }
}

FaceTrace MendRegion::findTrace(std::uint64_t face) const {
    const Square square(lattice_, face);
    FaceTrace trace;
    bool isUnclear = false;
    tree_.forEachOverlap({square.corner[0], square.corner[2]}, [&](std::int64_t t) {
        if (isUnclear) return;
        const auto piece = sectionOf(input_, static_cast<std::uint32_t>(t), square, isUnclear);
        if (piece) trace.pieces.push_back(*piece);
    });
    std::array<bool, 4> inside;
    for (int i = 0; i < 4; ++i) inside[i] = isInside(square.position[i]);
    const bool isOneSided =
        inside[0] == inside[1] && inside[1] == inside[2] && inside[2] == inside[3];
    if (!isUnclear && trace.pieces.empty()) {
        trace.kind = isOneSided ? FaceTrace::Kind::None : FaceTrace::Kind::Unclear;
        return trace;
    }
    if (isUnclear || !putInOrder(trace.pieces)) return {FaceTrace::Kind::Unclear, {}};
    if (isOneSided) {
        trace.kind = FaceTrace::Kind::Inner;
        return trace;
    }
    // the corners after the lattice edge where the line ends lie behind the mesh, up to the edge
    // where it starts
    const FacePiece &first = trace.pieces.front(), &last = trace.pieces.back();
    const int start = square.sideOfEdge(first.start.number),
              end = square.sideOfEdge(last.end.number);
    bool parts = true, isBehind = true;
    for (int i = 1; i <= 4; ++i) {
        const int corner = (end + i) % 4;
        parts = parts && inside[corner] == isBehind;
        if (corner == start) isBehind = false;
    }
    const auto isInTheMiddle = [&](const FaceNode& node, std::uint32_t triangle) {
        const double along = planeAlong(node.number, triangle);
        return along > 0.01 && along < 0.99;
    };
    const bool isClear = parts && isInTheMiddle(first.start, first.triangle) &&
                         isInTheMiddle(last.end, last.triangle);
    if (!isClear) return {FaceTrace::Kind::Unclear, {}};
    trace.kind = FaceTrace::Kind::Border;
    return trace;
}

std::vector<std::uint64_t> MendRegion::cells() const {
    std::vector<std::uint64_t> sorted(cells_.begin(), cells_.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

const FaceTrace& MendRegion::traceOf(std::uint64_t face) const {
    static const FaceTrace kNone;
    const auto found = traces_.find(face);
    return found == traces_.end() ? kNone : found->second;
}

double MendRegion::planeAlong(std::uint64_t edge, std::uint32_t triangle) const {
    const Corners t = cornersOf(input_.mesh, triangle);
    const LatticePosition low = positionOf(edge >> 2);
    const Vec3 normal = areaVector2(t[0], t[1], t[2]);
    const double from = dot(normal, lattice_.at(low) - t[0]),
                 to = dot(normal, lattice_.at(moved(low, axisOf(edge), 1)) - t[0]);
    return from / (from - to);
}

double MendRegion::crossingAlong(std::uint64_t edge) const {
    const LatticePosition low = positionOf(edge >> 2), high = moved(low, axisOf(edge), 1);
    const Vec3 a = lattice_.at(low), b = lattice_.at(high);
    std::vector<std::pair<double, int>> crossings;  // place, change of the winding number
    tree_.forEachOverlap({a, b}, [&](std::int64_t n) {
        const Corners t = cornersOf(input_.mesh, n);
        const int before = orient3d(t[0], t[1], t[2], a), after = orient3d(t[0], t[1], t[2], b);
        if (before == after || before == 0 || after == 0) return;
        const int s = orient3d(a, b, t[0], t[1]);
        if (s != orient3d(a, b, t[1], t[2]) || s != orient3d(a, b, t[2], t[0])) return;
        crossings.emplace_back(planeAlong(edge, static_cast<std::uint32_t>(n)), before);
    });
    std::sort(crossings.begin(), crossings.end());
    const double start = windingAt(low), end = windingAt(high);
    double along = (kInside - start) / (end - start), winding = start;
    for (const auto& [place, change] : crossings) {
        if ((winding >= kInside) != (winding + change >= kInside)) {
            along = place;
            break;
        }
        winding += change;
    }
    return std::clamp(along, 0.02, 0.98);
}

bool MendRegion::isTouched(const LatticePosition& cell) const {
    const BoundingBox box = lattice_.boxOf(cell, cell);
    bool isTouched = false;
    tree_.forEachOverlap(box, [&](std::int64_t t) {
        isTouched = isTouched || mayTouch(cornersOf(input_.mesh, t), box);
    });
    return isTouched;
}

}  // namespace adaptiso::detail
