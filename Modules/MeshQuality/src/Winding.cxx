#include "adaptiso/MeshQuality/Winding.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "Triangles.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF, kLeftOut = kNone - 1;
/// Relative to a piece's area to the power 1.5: a smaller volume may be rounding.
constexpr double kFlatPiece = 1e-9;
constexpr std::int64_t kGrain = 4096;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// For each start the pieces that lie around it, ascending: those that a ray from it passes an odd
/// number of times. Rays are found by the cells of a grid across them.
/// \param pieceOf  of a triangle; kNone: it is not there
/// \param matters  of a start and a piece: whether to look at it
template <class CornersOf, class PieceOf, class Matters>
std::vector<std::vector<std::uint32_t>> piecesAround(const std::vector<Vec3>& starts,
                                                     std::int64_t triangleCount,
                                                     const CornersOf& cornersAt,
                                                     const PieceOf& pieceOf,
                                                     const Matters& matters) {
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
    std::vector<std::vector<Passed>> ofGrain((triangleCount + kGrain - 1) / kGrain);
    parallelForPieces(triangleCount, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const std::uint32_t piece = pieceOf(t);
            if (piece == kNone) continue;
            const Corners corners = cornersAt(t);
            const BoundingBox around = boxOf(corners);
            if (!around.overlaps({box.minimum, {kInfinity, box.maximum.y, box.maximum.z}}))
                continue;
            for (std::size_t z = cellAt(around.minimum, 2); z <= cellAt(around.maximum, 2); ++z) {
                const auto first = side * z + cellAt(around.minimum, 1),
                           last = side * z + cellAt(around.maximum, 1);
                for (const std::uint32_t ray : rays.of(first, last + 1)) {
                    if (!around.overlaps(boxOf(starts[ray], kRay)) || !matters(ray, piece))
                        continue;
                    if (!hitOf(starts[ray], kRay, corners).crosses) continue;
                    ofGrain[begin / kGrain].push_back({ray, piece});
                }
            }
        }
    });
    std::vector<Passed> passed;
    for (const auto& some : ofGrain) passed.insert(passed.end(), some.begin(), some.end());
    std::sort(passed.begin(), passed.end());
    std::vector<std::vector<std::uint32_t>> around(starts.size());
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

/// Takes those away that cross the piece itself: of two that cross neither lies in the other.
class CrossingPieces {
public:
    CrossingPieces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& pieceOf,
                   std::size_t pieces)
        : mesh_(mesh),
          pieceOf_(pieceOf),
          triangles_(pieces,
                     [&](const auto& give) {
                         for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
                             give(pieceOf[mesh.triangles[t][0]], t);
                         }
                     }),
          tree_(mesh) {}

    void takeFrom(std::vector<std::uint32_t>& others, std::size_t piece) const {
        for (const std::int64_t t : triangles_.of(piece)) {
            if (others.empty()) return;
            tree_.forEachOverlap(tree_.triangleBox(t), [&](std::int64_t with) {
                const auto other =
                    std::find(others.begin(), others.end(), pieceOf_[mesh_.triangles[with][0]]);
                if (other == others.end()) return;
                if (trianglesCross(cornersOf(mesh_, t), cornersOf(mesh_, with)))
                    others.erase(other);
            });
        }
    }

private:
    const TriangleMesh& mesh_;
    const std::vector<std::uint32_t>& pieceOf_;  ///< of each vertex
    Buckets<std::int64_t> triangles_;            ///< of each piece
    AabbTree tree_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> findPiecesAround(
    const TriangleMesh& mesh, const std::vector<std::int64_t>& pieceOf,
    const std::vector<Vec3>& points, const std::function<bool(std::size_t, std::size_t)>& matters) {
    return piecesAround(
        points, std::ssize(mesh.triangles), [&](std::int64_t t) { return cornersOf(mesh, t); },
        [&](std::int64_t t) { return static_cast<std::uint32_t>(pieceOf[mesh.triangles[t][0]]); },
        matters);
}

std::vector<std::int64_t> findInsideOutPieces(const TriangleMesh& mesh,
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
            [&](std::int64_t t) { return pieceOf[mesh.triangles[t][0]]; }, std::not_equal_to<>());
        const bool mayCross = std::any_of(around.begin(), around.end(),
                                          [](const auto& pieces) { return !pieces.empty(); });
        if (mayCross) {
            const CrossingPieces crossing(mesh, pieceOf, count);
            parallelForPieces(std::ssize(around), 1, [&](std::int64_t n, std::int64_t) {
                crossing.takeFrom(around[n], static_cast<std::size_t>(n));
                isCavity[n] = static_cast<std::uint8_t>(around[n].size() % 2);
            });
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
    const auto around = piecesAround(
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
