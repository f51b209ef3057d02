#include "adaptiso/Extraction/Components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kNone = -1;

/// Measures of one component, made before components are compared.
struct Piece {
    double volumeMm3 = 0;  ///< signed; negative: a cavity
    double areaMm2 = 0;
    BoundingBox box{};
    std::vector<std::int64_t> triangles;
};

/// An edge that is not used once in each direction leaves the surface open.
bool hasOpenEdge(const TriangleMesh& mesh) {
    std::vector<std::pair<VertexId, VertexId>> forward;
    std::vector<std::pair<VertexId, VertexId>> backward;
    const std::size_t edges = mesh.triangles.size() / 2 * 3;  // of a closed surface
    forward.reserve(edges);
    backward.reserve(edges);
    for (const Triangle& t : mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            const VertexId from = t[corner];
            const VertexId to = t[(corner + 1) % 3];
            if (from < to) {
                forward.emplace_back(from, to);
            } else {
                backward.emplace_back(to, from);
            }
        }
    }
    std::sort(forward.begin(), forward.end());
    std::sort(backward.begin(), backward.end());
    return forward != backward;
}

std::vector<Piece> measurePieces(const TriangleMesh& mesh, const ComponentLabels& labels) {
    std::vector<Piece> pieces(labels.count);
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        pieces[labels.ofVertex[mesh.triangles[t][0]]].triangles.push_back(t);
    }
    for (Piece& piece : pieces) {
        if (piece.triangles.empty()) continue;  // a vertex that no triangle uses
        // volumes are summed about a point of the piece: far from the origin they keep their digits
        const Vec3 base = mesh.points[mesh.triangles[piece.triangles.front()][0]];
        piece.box = {base, base};
        for (const std::int64_t t : piece.triangles) {
            const Triangle& triangle = mesh.triangles[t];
            const Vec3 a = mesh.points[triangle[0]] - base;
            const Vec3 b = mesh.points[triangle[1]] - base;
            const Vec3 c = mesh.points[triangle[2]] - base;
            piece.volumeMm3 += dot(a, cross(b, c));
            piece.areaMm2 += norm(areaVector2(a, b, c)) / 2;
            for (const VertexId vertex : triangle) piece.box.add(mesh.points[vertex]);
        }
        piece.volumeMm3 /= 6;
    }
    return pieces;
}

/// Answers which components wind around a point, by the triangles above it.
///
/// Points are rounded to integers of at most 30 bits, so that every predicate in the plane is exact
/// in 64 bits, and the point asked about is moved by an infinitely small (e, e^2) in x and y
/// [Edelsbrunner1990, simulation of simplicity]: no ray meets an edge or a vertex, and a closed
/// component is always entered as often as it is left.
class Columns {
public:
    explicit Columns(const TriangleMesh& mesh) : mesh_(mesh) {
        const BoundingBox box = boundingBox(mesh);
        const Vec3 extent = box.size();
        origin_ = box.minimum;
        const double longest = std::max({extent.x, extent.y, extent.z});
        scale_ = longest > 0 ? kRange / longest : 1;
        // about two triangles a cell where they are spread evenly
        const double cells = static_cast<double>(mesh.triangles.size()) / 2;
        side_ = std::clamp<std::int64_t>(std::llround(std::sqrt(cells)), 1, kMaxSide);
        cellSize_ = kRange / side_ + 1;  // NOLINT(cppcoreguidelines-prefer-member-initializer)
        fillCells();
    }

    struct Winding {
        std::int64_t component;
        int number;
    };

    /// Winding numbers, as found by a ray along +z, about the middle of a triangle, of the
    /// components that `matters` says yes to. Components not listed do not wind around it.
    template <class Matters>
    std::vector<Winding> around(std::int64_t triangle, const ComponentLabels& labels,
                                const Matters& matters) const {
        const std::array<Point, 3> corners = snapped(triangle);
        const Point q{(corners[0].x + corners[1].x + corners[2].x) / 3,
                      (corners[0].y + corners[1].y + corners[2].y) / 3,
                      (corners[0].z + corners[1].z + corners[2].z) / 3};
        std::vector<Winding> windings;
        const std::int64_t cell = q.x / cellSize_ + side_ * (q.y / cellSize_);
        for (const std::int64_t other : cells_.of(static_cast<std::size_t>(cell))) {
            const std::int64_t component = labels.ofVertex[mesh_.triangles[other][0]];
            if (!matters(component)) continue;
            const int sign = crossing(snapped(other), q);
            if (sign == 0) continue;
            const auto known =
                std::find_if(windings.begin(), windings.end(),
                             [&](const Winding& w) { return w.component == component; });
            if (known == windings.end()) {
                windings.push_back({component, sign});
            } else {
                known->number += sign;
            }
        }
        return windings;
    }

private:
    struct Point {
        std::int64_t x, y, z;
    };
    static constexpr std::int64_t kRange = std::int64_t{1} << 30;
    static constexpr std::int64_t kMaxSide = 4096;

    std::array<Point, 3> snapped(std::int64_t triangle) const {
        std::array<Point, 3> corners;
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3 p = scale_ * (mesh_.points[mesh_.triangles[triangle][corner]] - origin_);
            corners[corner] = {std::llround(p.x), std::llround(p.y), std::llround(p.z)};
        }
        return corners;
    }

    /// Calls f with the number of every cell under the triangle's bounding rectangle.
    template <class F>
    void forCellsOf(std::int64_t triangle, const F& f) const {
        const auto [a, b, c] = snapped(triangle);
        const auto [x0, x1] = std::minmax({a.x, b.x, c.x});
        const auto [y0, y1] = std::minmax({a.y, b.y, c.y});
        for (std::int64_t y = y0 / cellSize_; y <= y1 / cellSize_; ++y) {
            for (std::int64_t x = x0 / cellSize_; x <= x1 / cellSize_; ++x) f(x + side_ * y);
        }
    }

    void fillCells() {
        const std::int64_t count = std::ssize(mesh_.triangles);
        cells_.assign(static_cast<std::size_t>(side_ * side_), [&](const auto& give) {
            for (std::int64_t t = 0; t < count; ++t) {
                forCellsOf(t, [&](std::int64_t cell) { give(static_cast<std::size_t>(cell), t); });
            }
        });
    }

    /// Twice the signed area of a, b, q in the plane; exact.
    static std::int64_t area2(const Point& a, const Point& b, const Point& q) {
        return (b.x - a.x) * (q.y - a.y) - (b.y - a.y) * (q.x - a.x);
    }

    /// Side of the moved point q to the line a b: +1 left, -1 right, 0 where a and b fall together.
    static int side(const Point& a, const Point& b, const Point& q) {
        const std::int64_t area = area2(a, b, q);
        if (area != 0) return area > 0 ? 1 : -1;
        if (b.y != a.y) return b.y < a.y ? 1 : -1;  // q moves by e along x
        if (b.x != a.x) return b.x > a.x ? 1 : -1;  // and by e^2 along y
        return 0;
    }

    /// +1 when the ray from q along +z leaves through the triangle's back, -1 when it enters
    /// through its front, 0 when it misses it.
    static int crossing(const std::array<Point, 3>& t, const Point& q) {
        const int turn = side(t[0], t[1], q);
        if (turn == 0 || side(t[1], t[2], q) != turn || side(t[2], t[0], q) != turn) return 0;
        const auto weight0 = static_cast<double>(area2(t[1], t[2], q));
        const auto weight1 = static_cast<double>(area2(t[2], t[0], q));
        const auto weight2 = static_cast<double>(area2(t[0], t[1], q));
        const double sum = weight0 + weight1 + weight2;
        if (sum == 0) return 0;  // seen edge-on: q lies on it, whose middle is never asked about
        const double height =
            (weight0 * static_cast<double>(t[0].z) + weight1 * static_cast<double>(t[1].z) +
             weight2 * static_cast<double>(t[2].z)) /
            sum;
        return height > static_cast<double>(q.z) ? turn : 0;
    }

    const TriangleMesh& mesh_;
    Vec3 origin_;
    double scale_ = 1;
    std::int64_t side_ = 1;
    std::int64_t cellSize_ = 1;
    Buckets<std::int64_t> cells_;  ///< triangles over each
};

/// The components around `piece`, found by the majority of five of its triangles.
std::vector<std::int64_t> enclosingPieces(const std::vector<Piece>& pieces, std::int64_t piece,
                                          const ComponentLabels& labels, const Columns& columns) {
    constexpr int kPoints = 5;
    const Piece& inner = pieces[piece];
    const auto matters = [&](std::int64_t other) {
        return std::abs(pieces[other].volumeMm3) > std::abs(inner.volumeMm3) &&
               pieces[other].box.contains(inner.box);
    };
    std::vector<std::int64_t> votes;  // a component's number, once for each point inside it
    const std::int64_t count = std::ssize(inner.triangles);
    for (int n = 0; n < kPoints; ++n) {
        const std::int64_t triangle = inner.triangles[n * count / kPoints];
        for (const auto& winding : columns.around(triangle, labels, matters)) {
            if (winding.number != 0) votes.push_back(winding.component);
        }
    }
    std::sort(votes.begin(), votes.end());
    std::vector<std::int64_t> enclosing;
    for (auto first = votes.begin(); first != votes.end();) {
        const auto last = std::upper_bound(first, votes.end(), *first);
        if (last - first > kPoints / 2) enclosing.push_back(*first);
        first = last;
    }
    return enclosing;
}

/// For each component the smallest one around it, or kNone.
std::vector<std::int64_t> parentsOf(const std::vector<Piece>& pieces, const ComponentLabels& labels,
                                    const TriangleMesh& mesh) {
    std::vector<std::int64_t> parents(pieces.size(), kNone);
    if (pieces.size() < 2) return parents;
    const Columns columns(mesh);
    for (std::int64_t piece = 0; piece < std::ssize(pieces); ++piece) {
        if (pieces[piece].triangles.empty()) continue;
        for (const std::int64_t other : enclosingPieces(pieces, piece, labels, columns)) {
            const std::int64_t best = parents[piece];
            if (best == kNone ||
                std::abs(pieces[other].volumeMm3) < std::abs(pieces[best].volumeMm3)) {
                parents[piece] = other;
            }
        }
    }
    return parents;
}

/// The components from the outside inwards: a parent stands before what lies in it.
std::vector<std::int64_t> outerFirst(const std::vector<Piece>& pieces) {
    std::vector<std::int64_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::int64_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
        return std::abs(pieces[a].volumeMm3) > std::abs(pieces[b].volumeMm3);
    });
    return order;
}

bool isCavity(const Piece& piece) {
    return piece.volumeMm3 < 0;
}

/// Drops the cavities that are filled, and all that lies inside them.
void fillCavities(const std::vector<Piece>& pieces, const std::vector<std::int64_t>& parents,
                  const ComponentSelection& selection, std::vector<bool>& kept) {
    std::vector<bool> filled(pieces.size(), false);
    for (const std::int64_t piece : outerFirst(pieces)) {
        const bool isFilled =
            isCavity(pieces[piece]) &&
            (selection.fillCavities || -pieces[piece].volumeMm3 < selection.minVolumeMm3);
        filled[piece] = isFilled || (parents[piece] != kNone && filled[parents[piece]]);
        if (filled[piece]) kept[piece] = false;
    }
}

/// Material of each outer wall's piece: what it encloses less the cavities that are kept in it.
std::vector<double> materialVolumes(const std::vector<Piece>& pieces,
                                    const std::vector<std::int64_t>& parents,
                                    const std::vector<bool>& kept) {
    std::vector<double> volumes(pieces.size(), 0);
    for (std::int64_t piece = 0; piece < std::ssize(pieces); ++piece) {
        if (!kept[piece]) continue;
        if (!isCavity(pieces[piece])) {
            volumes[piece] += pieces[piece].volumeMm3;
        } else if (parents[piece] != kNone) {
            volumes[parents[piece]] += pieces[piece].volumeMm3;
        }
    }
    return volumes;
}

/// Drops every outer wall that `goes` says yes to, then the cavities left without one.
template <class Goes>
void dropPieces(const std::vector<Piece>& pieces, const std::vector<std::int64_t>& parents,
                std::vector<bool>& kept, const Goes& goes) {
    for (std::int64_t piece = 0; piece < std::ssize(pieces); ++piece) {
        if (kept[piece] && !isCavity(pieces[piece]) && goes(piece)) kept[piece] = false;
    }
    for (std::int64_t piece = 0; piece < std::ssize(pieces); ++piece) {
        if (kept[piece] && isCavity(pieces[piece])) {
            kept[piece] = parents[piece] != kNone && kept[parents[piece]];
        }
    }
}

std::vector<bool> selectClosed(const TriangleMesh& mesh, const std::vector<Piece>& pieces,
                               const ComponentLabels& labels, const ComponentSelection& selection) {
    const std::vector<std::int64_t> parents = parentsOf(pieces, labels, mesh);
    std::vector<bool> kept(pieces.size(), true);
    fillCavities(pieces, parents, selection, kept);
    const std::vector<double> volumes = materialVolumes(pieces, parents, kept);
    dropPieces(pieces, parents, kept,
               [&](std::int64_t piece) { return volumes[piece] < selection.minVolumeMm3; });
    if (selection.largestOnly) {
        std::int64_t largest = kNone;
        for (std::int64_t piece = 0; piece < std::ssize(pieces); ++piece) {
            if (!kept[piece] || isCavity(pieces[piece])) continue;
            if (largest == kNone || volumes[piece] > volumes[largest]) largest = piece;
        }
        dropPieces(pieces, parents, kept, [&](std::int64_t piece) { return piece != largest; });
    }
    return kept;
}

std::vector<bool> selectLargestArea(const std::vector<Piece>& pieces) {
    const auto largest =
        std::max_element(pieces.begin(), pieces.end(),
                         [](const Piece& a, const Piece& b) { return a.areaMm2 < b.areaMm2; });
    std::vector<bool> kept(pieces.size(), false);
    if (largest != pieces.end()) kept[largest - pieces.begin()] = true;
    return kept;
}

TriangleMesh keepComponents(const TriangleMesh& mesh, const ComponentLabels& labels,
                            const std::vector<bool>& kept) {
    TriangleMesh result;
    std::vector<VertexId> used(mesh.points.size(), 0);
    for (const Triangle& t : mesh.triangles) {
        if (!kept[labels.ofVertex[t[0]]]) continue;
        result.triangles.push_back(t);
        for (const VertexId vertex : t) used[vertex] = 1;
    }
    for (VertexId vertex = 0; vertex < std::ssize(mesh.points); ++vertex) {
        if (!used[vertex]) continue;
        used[vertex] = std::ssize(result.points);
        result.points.push_back(mesh.points[vertex]);
        if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[vertex]);
    }
    for (Triangle& t : result.triangles) t = {used[t[0]], used[t[1]], used[t[2]]};
    return result;
}

}  // namespace

ComponentLabels labelComponents(const TriangleMesh& mesh) {
    DisjointSets sets(std::ssize(mesh.points));
    for (const auto& [a, b, c] : mesh.triangles) {
        sets.join(a, b);
        sets.join(a, c);
    }
    ComponentLabels labels{std::vector<std::int64_t>(mesh.points.size()), 0};
    for (VertexId vertex = 0; vertex < std::ssize(mesh.points); ++vertex) {
        const VertexId root = sets.find(vertex);
        labels.ofVertex[vertex] = root == vertex ? labels.count++ : labels.ofVertex[root];
    }
    return labels;
}

TriangleMesh selectComponents(const TriangleMesh& mesh, const ComponentSelection& selection) {
    if (!(selection.minVolumeMm3 >= 0) || std::isinf(selection.minVolumeMm3)) {
        throw InvalidInput("selectComponents: minVolumeMm3 is " +
                           std::to_string(selection.minVolumeMm3) + ", must be finite and >= 0");
    }
    if (selection.keepsAll() || mesh.triangles.empty()) return mesh;
    const bool isOpen = hasOpenEdge(mesh);
    if (isOpen && (selection.fillCavities || selection.minVolumeMm3 > 0)) {
        throw InvalidInput(
            "selectComponents: the surface is open, so volumes and cavities are not defined");
    }
    const ComponentLabels labels = labelComponents(mesh);
    const std::vector<Piece> pieces = measurePieces(mesh, labels);
    return keepComponents(
        mesh, labels,
        isOpen ? selectLargestArea(pieces) : selectClosed(mesh, pieces, labels, selection));
}

}  // namespace adaptiso
