#include "adaptiso/Extraction/Components.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"

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

/// For each component the smallest one around it, or kNone: by the majority of five of its
/// triangles, as components may touch.
std::vector<std::int64_t> parentsOf(const std::vector<Piece>& pieces, const ComponentLabels& labels,
                                    const TriangleMesh& mesh) {
    constexpr std::size_t kPoints = 5;
    std::vector<std::int64_t> parents(pieces.size(), kNone);
    if (pieces.size() < 2) return parents;
    std::vector<Vec3> points;
    std::vector<std::size_t> own;  // component of each
    for (std::size_t n = 0; n < pieces.size(); ++n) {
        const auto& triangles = pieces[n].triangles;
        for (std::size_t k = 0; k < kPoints && !triangles.empty(); ++k) {
            const auto& [a, b, c] = mesh.triangles[triangles[k * triangles.size() / kPoints]];
            points.push_back(1.0 / 3 * (mesh.points[a] + mesh.points[b] + mesh.points[c]));
            own.push_back(n);
        }
    }
    const auto around =
        findPiecesAround(mesh, labels.ofVertex, points, [&](std::size_t point, std::size_t other) {
            const Piece &inner = pieces[own[point]], &outer = pieces[other];
            return std::abs(outer.volumeMm3) > std::abs(inner.volumeMm3) &&
                   outer.box.contains(inner.box);
        });
    for (std::size_t first = 0; first < points.size(); first += kPoints) {
        std::map<std::uint32_t, std::size_t> votes;
        for (std::size_t k = 0; k < kPoints; ++k) {
            for (const std::uint32_t other : around[first + k]) ++votes[other];
        }
        std::int64_t& best = parents[own[first]];
        for (const auto& [other, count] : votes) {
            if (2 * count <= kPoints) continue;
            const bool isSmaller = best == kNone || std::abs(pieces[other].volumeMm3) <
                                                        std::abs(pieces[best].volumeMm3);
            if (isSmaller) best = other;
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

}  // namespace

ComponentLabels labelComponents(const TriangleMesh& mesh) {
    ComponentLabels labels{findComponentRoots(mesh), 0};
    for (VertexId vertex = 0; vertex < std::ssize(mesh.points); ++vertex) {
        std::int64_t& label = labels.ofVertex[vertex];  // that of the root, which comes first
        label = label == vertex ? labels.count++ : labels.ofVertex[label];
    }
    return labels;
}

const Options<ComponentSelection>& pieceOptions() {
    static const Options<ComponentSelection> kRows{
        option<&ComponentSelection::largestOnly>(
            {.name = "largest",
             .key = "largest",
             .label = "The largest piece alone",
             .help = "Keep the piece with the most material only (of an open surface: the largest "
                     "area)"}),
        option<&ComponentSelection::minVolumeMm3>(
            {.name = "min-volume",
             .key = "minVolumeMm3",
             .label = "Pieces of at least",
             .valueName = "MM3",
             .help = "Drop pieces with less material than this, and fill cavities with less",
             .rule = {.least = 0, .unit = "mm3"}}),
        option<&ComponentSelection::fillCavities>(
            {.name = "fill-cavities",
             .key = "fillCavities",
             .label = "Cavities filled",
             .help = "Drop inner surfaces, and all that lies inside them"})};
    return kRows;
}

std::vector<std::uint8_t> keptTriangles(const TriangleMesh& mesh,
                                        const ComponentSelection& selection) {
    if (!(selection.minVolumeMm3 >= 0) || std::isinf(selection.minVolumeMm3)) {
        throw InvalidInput("selectComponents: minVolumeMm3 is " +
                           std::to_string(selection.minVolumeMm3) + ", must be finite and >= 0");
    }
    std::vector<std::uint8_t> isKept(mesh.triangles.size(), 1);
    if (selection.keepsAll() || mesh.triangles.empty()) return isKept;
    const bool isOpen = hasOpenEdge(mesh);
    if (isOpen && (selection.fillCavities || selection.minVolumeMm3 > 0)) {
        throw InvalidInput(
            "selectComponents: the surface is open, so volumes and cavities are not defined");
    }
    const ComponentLabels labels = labelComponents(mesh);
    const std::vector<Piece> pieces = measurePieces(mesh, labels);
    const std::vector<bool> kept =
        isOpen ? selectLargestArea(pieces) : selectClosed(mesh, pieces, labels, selection);
    for (std::size_t t = 0; t < isKept.size(); ++t) {
        isKept[t] = kept[labels.ofVertex[mesh.triangles[t][0]]] ? 1 : 0;
    }
    return isKept;
}

TriangleMesh selectComponents(const TriangleMesh& mesh, const ComponentSelection& selection) {
    const std::vector<std::uint8_t> isKept = keptTriangles(mesh, selection);
    if (selection.keepsAll() || mesh.triangles.empty()) return mesh;
    TriangleMesh result;
    std::vector<VertexId> used(mesh.points.size(), 0);
    for (std::size_t t = 0; t < isKept.size(); ++t) {
        if (isKept[t] == 0) continue;
        result.triangles.push_back(mesh.triangles[t]);
        for (const VertexId vertex : mesh.triangles[t]) used[vertex] = 1;
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

}  // namespace adaptiso
