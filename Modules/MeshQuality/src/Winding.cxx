#include "adaptiso/MeshQuality/Winding.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "Triangles.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"

namespace adaptiso {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF, kLeftOut = kNone - 1;
/// Relative to a piece's area to the power 1.5: a smaller volume may be rounding.
constexpr double kFlatPiece = 1e-9;
constexpr std::int64_t kTriangleGrain = 4096;
/// Tests of a ray and a triangle, at most, for each kTriangleGrain triangles: enough for thousands
/// of pieces in each other.
constexpr std::int64_t kMostTests = 1 << 24, kUnlimited = std::numeric_limits<std::int64_t>::max();

/// For each start pieces, ascending.
using PiecesAround = std::vector<std::vector<std::uint32_t>>;

/// For each start the pieces that lie around it, ascending: those that a ray from it passes an odd
/// number of times. Rays are found by the cells of a grid across them.
/// \param pieceOf  of a triangle; kNone: it is not there
/// \param matters  of a start and a piece: whether to look at it
/// \param mostTests  of a ray and a triangle, for each kTriangleGrain triangles
/// \return  empty where there would be more
template <class CornersOf, class PieceOf, class Matters>
std::optional<PiecesAround> piecesAround(const std::vector<Vec3>& starts,
                                         std::int64_t triangleCount, const CornersOf& cornersAt,
                                         const PieceOf& pieceOf, const Matters& matters,
                                         std::int64_t mostTests = kUnlimited) {
    constexpr Ray kRay{0, 1};
    BoundingBox box = BoundingBox::empty();
    for (const Vec3& p : starts) box.add(p);
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(std::ssize(starts))));
    const auto cellAt = [&](const Vec3& p, int axis) {
        const double size = box.size()[axis],
                     part = size > 0 ? static_cast<double>(side) / size : 0;
        return static_cast<std::size_t>(
            std::clamp((p[axis] - box.minimum[axis]) * part, 0.0, static_cast<double>(side - 1)));
    };
    const Buckets<std::uint32_t> rays(side * side, [&](const auto& give) {
        for (std::uint32_t n = 0; n < starts.size(); ++n) {
            give(side * cellAt(starts[n], 2) + cellAt(starts[n], 1), n);
        }
    });
    struct Passed {
        std::uint32_t ray, piece;
        auto operator<=>(const Passed&) const = default;
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<std::vector<Passed>> ofGrain((triangleCount + kTriangleGrain - 1) / kTriangleGrain);
    std::atomic<bool> areTooMany = false;
    parallelForPieces(triangleCount, kTriangleGrain, [&](std::int64_t begin, std::int64_t end) {
        std::int64_t tests = 0;
        for (std::int64_t t = begin; t < end && !areTooMany; ++t) {
            const std::uint32_t piece = pieceOf(t);
            if (piece == kNone) continue;
            const Corners corners = cornersAt(t);
            const BoundingBox around = boxOf(corners);
            if (!around.overlaps({box.minimum, {kInfinity, box.maximum.y, box.maximum.z}}))
                continue;
            for (std::size_t z = cellAt(around.minimum, 2); z <= cellAt(around.maximum, 2); ++z) {
                const auto first = side * z + cellAt(around.minimum, 1),
                           last = side * z + cellAt(around.maximum, 1);
                const std::span<const std::uint32_t> beside = rays.of(first, last + 1);
                tests += std::ssize(beside);
                if (tests > mostTests) {
                    areTooMany = true;
                    return;
                }
                for (const std::uint32_t ray : beside) {
                    if (!around.overlaps(boxOf(starts[ray], kRay)) || !matters(ray, piece))
                        continue;
                    if (!hitOf(starts[ray], kRay, corners).crosses) continue;
                    ofGrain[begin / kTriangleGrain].push_back({ray, piece});
                }
            }
        }
    });
    if (areTooMany) return std::nullopt;
    std::vector<Passed> passed;
    for (const auto& some : ofGrain) passed.insert(passed.end(), some.begin(), some.end());
    std::sort(passed.begin(), passed.end());
    PiecesAround around(starts.size());
    for (const auto& [ray, piece] : passed) {
        std::vector<std::uint32_t>& pieces = around[ray];
        if (pieces.empty() || pieces.back() != piece) {
            pieces.push_back(piece);
        } else {
            pieces.pop_back();  // out of it again
        }
    }
    return around;
}

/// Takes from the pieces around each those that cross it: of two that cross neither lies in the
/// other. \return  false where crossings are not all known
bool takeCrossing(const TriangleMesh& mesh, const std::vector<std::uint32_t>& pieceOf,
                  PiecesAround& around) {
    // of larger pieces only what is near
    BoundingBox near = BoundingBox::empty();
    for (const Triangle& t : mesh.triangles) {
        if (around[pieceOf[t[0]]].empty()) continue;
        for (const VertexId v : t) near.add(mesh.points[v]);
    }
    std::vector<TriangleView::Triangle> triangles;
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        if (!boxOf(cornersOf(mesh, n)).overlaps(near)) continue;
        const auto& [a, b, c] = mesh.triangles[n];
        triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                             static_cast<std::uint32_t>(c)});
    }
    const auto pieceAt = [&](std::uint32_t t) { return pieceOf[triangles[t][0]]; };
    const CrossingPairs crossing = findCrossingPairs(
        {mesh.points, triangles},
        [&](std::uint32_t a, std::uint32_t b) { return pieceAt(a) != pieceAt(b); });
    for (const auto& [a, b] : crossing.pairs) {
        for (const auto& [piece, other] : {std::pair(a, b), std::pair(b, a)}) {
            std::vector<std::uint32_t>& others = around[pieceAt(piece)];
            const auto found = std::lower_bound(others.begin(), others.end(), pieceAt(other));
            if (found != others.end() && *found == pieceAt(other)) others.erase(found);
        }
    }
    return crossing.undecided.empty();
}

}  // namespace

std::vector<std::vector<std::uint32_t>> findPiecesAround(
    const TriangleMesh& mesh, const std::vector<std::int64_t>& pieceOf,
    const std::vector<Vec3>& points, const std::function<bool(std::size_t, std::size_t)>& matters) {
    return *piecesAround(
        points, std::ssize(mesh.triangles), [&](std::int64_t t) { return cornersOf(mesh, t); },
        [&](std::int64_t t) { return static_cast<std::uint32_t>(pieceOf[mesh.triangles[t][0]]); },
        matters);
}

std::optional<std::vector<std::int64_t>> findInsideOutPieces(const TriangleMesh& mesh,
                                                             const TopologyReport& topology) {
    if (!topology.isWatertight() || topology.count(TopologyDefect::NonFiniteVertex) > 0) {
        throw InvalidInput(
            "findInsideOutPieces: the mesh must be closed, manifold, oriented and finite");
    }
    const auto count = topology.components.size();
    std::vector<std::uint8_t> isCavity(count);
    if (count > 1) {
        const std::vector<VertexId> roots = findComponentRoots(mesh);
        std::vector<std::uint32_t> pieceOf(mesh.points.size());
        std::vector<Vec3> starts(count);
        for (std::uint32_t n = 0; n < count; ++n) {
            const VertexId first = topology.components[n].firstVertex;
            pieceOf[first] = n;
            starts[n] = mesh.points[first];
        }
        for (std::size_t v = 0; v < roots.size(); ++v) pieceOf[v] = pieceOf[roots[v]];
        auto around = piecesAround(
            starts, std::ssize(mesh.triangles), [&](std::int64_t t) { return cornersOf(mesh, t); },
            [&](std::int64_t t) { return pieceOf[mesh.triangles[t][0]]; }, std::not_equal_to<>(),
            kMostTests);
        if (!around) return std::nullopt;
        const bool mayCross = std::any_of(around->begin(), around->end(),
                                          [](const auto& pieces) { return !pieces.empty(); });
        if (mayCross && !takeCrossing(mesh, pieceOf, *around)) return std::nullopt;
        for (std::size_t n = 0; n < count; ++n) {
            isCavity[n] = static_cast<std::uint8_t>((*around)[n].size() % 2);
        }
    }
    std::vector<std::int64_t> insideOut;
    for (std::size_t n = 0; n < isCavity.size(); ++n) {
        const bool isRight = topology.components[n].isOutward() == (isCavity[n] == 0);
        if (!isRight) insideOut.push_back(static_cast<std::int64_t>(n));
    }
    return insideOut;
}

InsideOutPieces findInsideOutPieces(const TriangleView& surface,
                                    const std::vector<std::uint8_t>& isLeftOut) {
    DisjointSets sets(std::ssize(surface.points));
    for (const auto& [a, b, c] : surface.triangles) {
        sets.join(a, b);
        sets.join(a, c);
    }
    std::vector<std::uint32_t> pieceOf(surface.points.size(), kNone);  // first at its root alone
    for (std::size_t v = 0; v < isLeftOut.size(); ++v) {
        if (isLeftOut[v] != 0) pieceOf[sets.find(static_cast<std::int64_t>(v))] = kLeftOut;
    }
    std::vector<Vec3> starts;
    for (const auto& t : surface.triangles) {
        std::uint32_t& piece = pieceOf[sets.find(t[0])];
        if (piece != kNone) continue;
        piece = static_cast<std::uint32_t>(starts.size());
        starts.push_back(surface.points[t[0]]);
    }
    const auto pieceAt = [&](std::int64_t t) {
        const std::uint32_t piece = pieceOf[surface.triangles[t][0]];
        return piece == kLeftOut ? kNone : piece;
    };
    for (std::size_t v = 0; v < pieceOf.size(); ++v) {
        pieceOf[v] = pieceOf[sets.find(static_cast<std::int64_t>(v))];  // a root comes first
    }
    std::vector<double> volume6(starts.size()), area2(starts.size());
    for (std::int64_t t = 0; t < std::ssize(surface.triangles); ++t) {
        const std::uint32_t piece = pieceAt(t);
        if (piece == kNone) continue;
        const auto [a, b, c] = surface.cornersOf(static_cast<std::size_t>(t));
        const Vec3 area = areaVector2(a, b, c);
        volume6[piece] += dot(a - starts[piece], area);
        area2[piece] += norm(area);
    }
    const PiecesAround around = *piecesAround(
        starts, std::ssize(surface.triangles),
        [&](std::int64_t t) { return surface.cornersOf(static_cast<std::size_t>(t)); }, pieceAt,
        std::not_equal_to<>());
    InsideOutPieces result;
    std::vector<std::uint8_t> isWrong(starts.size());
    for (std::size_t n = 0; n < starts.size(); ++n) {
        const double least = kFlatPiece * area2[n] * std::sqrt(area2[n]);
        if (!(std::abs(volume6[n]) > least)) {
            ++result.flat;
        } else if ((volume6[n] > 0) == (around[n].size() % 2 == 1)) {
            ++result.count;
            isWrong[n] = 1;
        }
    }
    for (std::int64_t t = 0; t < std::ssize(surface.triangles); ++t) {
        const std::uint32_t piece = pieceAt(t);
        if (piece != kNone && isWrong[piece] != 0) result.triangles.push_back(t);
    }
    return result;
}

}  // namespace adaptiso
