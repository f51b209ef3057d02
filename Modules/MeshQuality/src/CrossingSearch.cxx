#include "adaptiso/MeshQuality/CrossingSearch.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "TriangleGroups.h"
#include "Triangles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Certificate.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {

namespace {

constexpr std::size_t kMostNumbers = std::numeric_limits<std::uint32_t>::max();

Corners cornersOf(const TriangleView& mesh, std::int64_t triangle) {
    return mesh.cornersOf(static_cast<std::size_t>(triangle));
}
using adaptiso::cornersOf;

/// The triangles of a mesh that may cross others, those with area and finite corners, by 32-bit
/// numbers. Where many are stored in any order they come in the order of space, with points of
/// their own: nearly all that is done with neighbours would wait for memory.
struct FiniteTriangles {
    std::vector<TriangleView::Triangle> triangles;
    std::vector<std::uint32_t> numbers;  ///< in the mesh
    std::vector<Vec3> points;            ///< empty: the mesh's

    template <class Mesh>
    explicit FiniteTriangles(const Mesh& mesh)
        : FiniteTriangles(mesh, [](std::int64_t) { return true; }) {}

    /// \param mesh     a TriangleMesh or a TriangleView
    /// \param isMeant  isMeant(number): the triangle is one of them
    template <class Mesh, class IsMeant>
    FiniteTriangles(const Mesh& mesh, const IsMeant& isMeant) {
        if (mesh.points.size() > kMostNumbers || mesh.triangles.size() > kMostNumbers) {
            throw InvalidInput("findSelfIntersections: the mesh has more than " +
                               std::to_string(kMostNumbers) + " points or triangles");
        }
        const auto pointCount = static_cast<std::int64_t>(mesh.points.size());
        std::size_t count = 0;
        for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) count += isMeant(n) ? 1 : 0;
        reserveInHugePages(triangles, count);
        reserveInHugePages(numbers, count);
        for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
            const auto& [a, b, c] = mesh.triangles[n];
            for (const VertexId v : {VertexId{a}, VertexId{b}, VertexId{c}}) {
                if (v >= 0 && v < pointCount) continue;
                throw InvalidInput("findSelfIntersections: triangle " + std::to_string(n) +
                                   " names vertex " + std::to_string(v) + " of a mesh with " +
                                   std::to_string(pointCount) + " points");
            }
            if (!isMeant(n)) continue;
            const Corners corners = cornersOf(mesh, n);
            if (!areFinite(corners) || axisWithArea(corners) < 0) continue;
            triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                 static_cast<std::uint32_t>(c)});
            numbers.push_back(static_cast<std::uint32_t>(n));
        }
        if (areScattered(mesh.points.size())) sort(mesh.points);
    }

    template <class Mesh>
    TriangleView view(const Mesh& of) const {
        return viewOf(of.points);
    }

private:
    TriangleView viewOf(std::span<const Vec3> all) const {
        return {points.empty() ? all : points, triangles};
    }

    /// As a fraction of the points: the mean step from a triangle to the next in the list, by their
    /// last points. Marching cubes' is a thousandth, in any order a fifth.
    bool areScattered(std::size_t pointCount) const {
        constexpr std::size_t kMany = 1 << 15;  // below, all fits a processor's cache
        constexpr double kScattered = 0.05;
        if (triangles.size() < kMany) return false;
        double steps = 0, before = 0;
        for (const TriangleView::Triangle& t : triangles) {
            const double last = *std::max_element(t.begin(), t.end());
            steps += std::abs(last - before);
            before = last;
        }
        return steps >
               kScattered * static_cast<double>(triangles.size()) * static_cast<double>(pointCount);
    }

    void sort(std::span<const Vec3> all) {
        constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
        const TriangleView stored = viewOf(all);
        const std::vector<std::uint32_t> order =
            inMortonOrder(triangles.size(), stored.box(), [&](std::uint32_t t) {
                const Corners c = stored.cornersOf(t);
                return 1.0 / 3 * (c[0] + c[1] + c[2]);
            });
        std::vector<std::uint32_t> place(all.size(), kNone);
        std::vector<TriangleView::Triangle> sorted;
        std::vector<std::uint32_t> sortedNumbers;
        reserveInHugePages(sorted, order.size());
        reserveInHugePages(sortedNumbers, order.size());
        reserveInHugePages(points, all.size());
        for (const std::uint32_t t : order) {
            TriangleView::Triangle moved = triangles[t];
            for (std::uint32_t& v : moved) {
                if (place[v] == kNone) {
                    place[v] = static_cast<std::uint32_t>(points.size());
                    points.push_back(all[v]);
                }
                v = place[v];
            }
            sorted.push_back(moved);
            sortedNumbers.push_back(numbers[t]);
        }
        triangles = std::move(sorted);
        numbers = std::move(sortedNumbers);
    }
};

/// Distance that rounding of coordinates in a box may hide.
double roundingIn(const BoundingBox& box) {
    return 1e-13 * (norm(box.maximum) + norm(box.minimum));
}

/// A piece's triangles, as they come.
using OfPieces = std::vector<std::vector<std::int64_t>>;

/// All of them, ascending, each once.
std::vector<std::int64_t> joined(const OfPieces& pieces) {
    std::vector<std::int64_t> all;
    for (const auto& some : pieces) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

CrossingTriangles trianglesOf(const CrossingPairs& crossing) {
    std::vector<std::int64_t> found;
    for (const auto& pair : crossing.pairs) found.insert(found.end(), pair.begin(), pair.end());
    CrossingTriangles triangles{joined({std::move(found)}), {}};
    std::set_difference(crossing.undecided.begin(), crossing.undecided.end(),
                        triangles.found.begin(), triangles.found.end(),
                        std::back_inserter(triangles.undecided));
    return triangles;
}

/// The triangles that cross, and those of which it is not decided.
std::vector<std::int64_t> allOf(const CrossingTriangles& triangles) {
    return joined({triangles.found, triangles.undecided});
}

/// Triangles by their cells. Marching cubes makes those of a cell one after the other: nearly
/// always they lie side by side already.
class CellRuns {
public:
    explicit CellRuns(std::span<const std::uint64_t> cells) {
        for (std::size_t t = 0; t < cells.size(); ++t) {
            if (cells[t] == kNoCell) continue;
            const bool goesOn = t > 0 && cells[t - 1] == cells[t];
            if (goesOn) {
                ++runs_.back().end;
            } else {
                runs_.push_back({cells[t], t, t + 1});
            }
        }
        std::sort(runs_.begin(), runs_.end(), [](const Run& a, const Run& b) {
            return a.cell != b.cell ? a.cell < b.cell : a.begin < b.begin;
        });
    }

    std::int64_t count() const { return std::ssize(runs_); }

    /// \param triangles  gets those of the cell whose first run it is; none for another run
    void collect(std::int64_t run, std::vector<std::int64_t>& triangles) const {
        triangles.clear();
        const std::uint64_t cell = runs_[run].cell;
        if (run > 0 && runs_[run - 1].cell == cell) return;
        for (std::int64_t r = run; r < count() && runs_[r].cell == cell; ++r) {
            for (std::size_t t = runs_[r].begin; t < runs_[r].end; ++t) {
                triangles.push_back(static_cast<std::int64_t>(t));
            }
        }
    }

private:
    struct Run {
        std::uint64_t cell;
        std::size_t begin, end;
    };
    std::vector<Run> runs_;
};

/// Those of the same cell that cross.
template <class Mesh>
std::vector<std::int64_t> crossingWithinCells(const Mesh& mesh,
                                              std::span<const std::uint64_t> cells) {
    constexpr std::int64_t kPiece = 1 << 12;  // runs
    const CellRuns runs(cells);
    const double gap = roundingIn(TriangleView{mesh.points, {}}.box());
    const auto cross = [&](std::int64_t a, std::int64_t b) {
        const auto &s = mesh.triangles[a], &t = mesh.triangles[b];
        if (areClear(mesh.points, s, t, gap, 0)) return false;
        const Corners first = cornersOf(mesh, a), second = cornersOf(mesh, b);
        return areFinite(first) && areFinite(second) && trianglesCross(first, second);
    };
    OfPieces ofPiece((runs.count() + kPiece - 1) / kPiece);
    parallelForPieces(runs.count(), kPiece, [&](std::int64_t begin, std::int64_t end) {
        std::vector<std::int64_t> triangles;
        for (std::int64_t run = begin; run < end; ++run) {
            runs.collect(run, triangles);
            for (std::size_t i = 0; i < triangles.size(); ++i) {
                for (std::size_t j = 0; j < i; ++j) {
                    if (!cross(triangles[i], triangles[j])) continue;
                    ofPiece[begin / kPiece].insert(ofPiece[begin / kPiece].end(),
                                                   {triangles[i], triangles[j]});
                }
            }
        }
    });
    return joined(ofPiece);
}

/// Of each triangle: it has no cell, or is near one that has none.
template <class Mesh>
std::vector<std::uint8_t> nearOnesWithoutCells(const Mesh& mesh,
                                               std::span<const std::uint64_t> cells) {
    constexpr std::int64_t kPiece = 1 << 13;
    const FiniteTriangles free(mesh, [&](std::int64_t t) { return cells[t] == kNoCell; });
    const TriangleView view = free.view(mesh);
    const TriangleTree tree(view);
    std::vector<std::uint8_t> isNear(mesh.triangles.size(), 1);
    parallelForPieces(std::ssize(isNear), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            if (cells[t] == kNoCell) continue;
            isNear[t] = 0;
            tree.forEachOverlap(boxOf(cornersOf(mesh, t)), view,
                                [&](std::uint32_t) { isNear[t] = 1; });
        }
    });
    return isNear;
}

/// Those that cross a triangle without a cell, and these.
template <class Mesh>
std::vector<std::int64_t> crossingWithoutCells(const Mesh& mesh,
                                               std::span<const std::uint64_t> cells) {
    if (std::find(cells.begin(), cells.end(), kNoCell) == cells.end()) return {};
    const std::vector<std::uint8_t> isNear = nearOnesWithoutCells(mesh, cells);
    const FiniteTriangles near(mesh, [&](std::int64_t t) { return isNear[t] != 0; });
    const auto isFree = [&](std::uint32_t t) { return cells[near.numbers[t]] == kNoCell; };
    std::vector<std::int64_t> crossing =
        allOf(trianglesOf(findCrossingPairs(near.view(mesh), [&](std::uint32_t a, std::uint32_t b) {
            return isFree(a) || isFree(b);
        })));
    for (std::int64_t& t : crossing) t = near.numbers[t];
    return crossing;
}

/// Leaves the `count` smallest, in any order.
void keepFirst(std::vector<TrianglePair>& pairs, std::int64_t count) {
    if (std::ssize(pairs) <= count) return;
    std::nth_element(pairs.begin(), pairs.begin() + count, pairs.end());
    pairs.resize(static_cast<std::size_t>(count));
}

}  // namespace

namespace {

/// Decides pairs of triangles.
class PairTest {
public:
    explicit PairTest(const TriangleView& mesh)
        : mesh_(mesh), gap_(roundingIn(mesh.box())), fans_(mesh.points, mesh.triangles) {}

    bool cross(std::uint32_t a, std::uint32_t b) const {
        const TriangleView::Triangle &s = mesh_.triangles[a], &t = mesh_.triangles[b];
        return !fans_.areClear(s, t) && !areClear(mesh_.points, s, t, gap_, 0) &&
               trianglesCross(mesh_.cornersOf(a), mesh_.cornersOf(b));
    }

private:
    const TriangleView& mesh_;
    double gap_;  ///< distance that rounding may hide
    ClearFans fans_;
};

using IsMet = std::function<bool(std::uint32_t, std::uint32_t)>;

/// The pairs whose boxes overlap; empty where these are too many.
std::optional<CrossingPairs> findByBoxes(const TriangleView& mesh, const TriangleTree& tree,
                                         const IsMet& isMet) {
    constexpr std::int64_t kPiece = 128;  // leaves
    // of a piece of 1,024 triangles; those of surfaces take a tenth
    constexpr std::int64_t kMost = 256 * 1024;
    const TriangleTree::Pairs near(tree, mesh);
    std::vector<CrossingPairs> ofPiece((tree.leafCount() + kPiece - 1) / kPiece);
    std::atomic<bool> areTooMany = false;
    parallelForPieces(tree.leafCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
        CrossingPairs& found = ofPiece[begin / kPiece];
        if (areTooMany) return;
        const bool isWhole = near.forEach(begin, end, kMost, [&](std::uint32_t a, std::uint32_t b) {
            ++found.tests;
            if (isMet(a, b)) found.pairs.push_back({a, b});
        });
        if (!isWhole) areTooMany = true;
    });
    if (areTooMany) return std::nullopt;
    CrossingPairs all;
    for (const CrossingPairs& piece : ofPiece) {
        all.pairs.insert(all.pairs.end(), piece.pairs.begin(), piece.pairs.end());
        all.tests += piece.tests;
    }
    return all;
}

}  // namespace

CrossingPairs findCrossingPairs(const TriangleView& mesh, const IsMet& isTested) {
    if (mesh.triangles.empty()) return {};
    TriangleTree tree;
    std::optional<PairTest> test;
    parallelInvoke([&] { tree = TriangleTree(mesh); }, [&] { test.emplace(mesh); });
    const IsMet isMet = [&](std::uint32_t a, std::uint32_t b) {
        return (!isTested || isTested(a, b)) && test->cross(a, b);
    };
    if (std::optional<CrossingPairs> found = findByBoxes(mesh, tree, isMet)) {
        return *std::move(found);
    }
    tree = {};
    TriangleGroups::Pairs found = TriangleGroups(mesh).findPairs(isMet);
    return {std::move(found.pairs), std::move(found.undecided), found.tests};
}

CrossingTriangles findCrossingTriangles(const TriangleView& mesh) {
    return trianglesOf(findCrossingPairs(mesh));
}

namespace {

/// \param mesh  a TriangleMesh or a TriangleView
template <class Mesh>
CrossingTriangles findCrossingTrianglesOf(const Mesh& mesh) {
    const FiniteTriangles finite(mesh);
    CrossingTriangles crossing = findCrossingTriangles(finite.view(mesh));
    for (auto* const some : {&crossing.found, &crossing.undecided}) {
        for (std::int64_t& t : *some) t = finite.numbers[t];
        std::sort(some->begin(), some->end());
    }
    return crossing;
}

}  // namespace

CrossingTriangles findCrossingTriangles(const TriangleMesh& mesh) {
    return findCrossingTrianglesOf(mesh);
}

std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh) {
    return allOf(findCrossingTriangles(mesh));
}

std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh,
                                            std::span<const std::uint64_t> cells) {
    if (cells.empty()) return crossingTriangles(mesh);
    return joined({crossingWithinCells(mesh, cells), crossingWithoutCells(mesh, cells)});
}

std::vector<std::int64_t> crossingTriangles(const TriangleView& mesh,
                                            std::span<const std::uint64_t> cells) {
    if (cells.empty()) return allOf(findCrossingTrianglesOf(mesh));
    return joined({crossingWithinCells(mesh, cells), crossingWithoutCells(mesh, cells)});
}

SelfIntersections findSelfIntersections(const TriangleMesh& mesh,
                                        const SelfIntersectionOptions& options) {
    if (options.maxPairs < 0) {
        throw InvalidInput("findSelfIntersections: maxPairs is " +
                           std::to_string(options.maxPairs) + ", must be at least 0");
    }
    const FiniteTriangles finite(mesh);
    const CrossingPairs found = findCrossingPairs(finite.view(mesh));
    SelfIntersections result;
    result.pairCount = std::ssize(found.pairs);
    result.isComplete = found.undecided.empty();
    if (options.maxPairs == 0) return result;
    result.pairs.reserve(found.pairs.size());
    for (const auto& [a, b] : found.pairs) {
        const auto [first, second] = std::minmax(finite.numbers[a], finite.numbers[b]);
        result.pairs.push_back({first, second});
    }
    keepFirst(result.pairs, options.maxPairs);
    std::sort(result.pairs.begin(), result.pairs.end());
    return result;
}

namespace {

/// Puts the triangles around a vertex into one ring.
/// \return false for no such fan
bool sortRound(std::span<std::array<std::uint32_t, 2>> sectors) {
    for (auto next = sectors.begin() + 1; next != sectors.end(); ++next) {
        const auto found = std::find_if(next, sectors.end(),
                                        [&](const auto& s) { return s[0] == (*(next - 1))[1]; });
        if (found == sectors.end()) return false;
        std::swap(*next, *found);
    }
    return sectors.back()[1] == sectors.front()[0];
}

}  // namespace

bool goesRoundOnce(std::span<const Vec3> spokes) {
    // a triangle is upright when its normal's cosine to the direction is larger
    constexpr double kLeastCosine = 0.02;
    const auto next = [&](std::size_t i) { return spokes[i + 1 < spokes.size() ? i + 1 : 0]; };
    std::array<Vec3, kMostOfFan> area2;
    Vec3 axis;
    for (std::size_t i = 0; i < spokes.size(); ++i) {
        area2[i] = cross(spokes[i], next(i));
        axis += area2[i];
    }
    const Vec3 across =
        std::abs(axis.x) < std::abs(axis.y) ? cross(axis, {1, 0, 0}) : cross(axis, {0, 1, 0});
    const double least = kLeastCosine * norm(axis);
    int rounds = 0;  // how often the sectors pass the direction from which `across` grows
    for (std::size_t i = 0; i < spokes.size(); ++i) {
        const double upright = dot(area2[i], axis);
        if (!(upright > 0 && upright * upright > least * least * squaredNorm(area2[i]))) {
            return false;
        }
        if (dot(spokes[i], across) < 0 && dot(next(i), across) >= 0) ++rounds;
    }
    return rounds == 1;
}

void ClearFans::prove(std::span<const Vec3> points, Sectors sectors) {
    constexpr std::int64_t kPiece = 4096;
    const auto isClear = [&](std::int64_t v) {
        const std::span<Sector> ring = sectors.of(static_cast<std::size_t>(v));
        if (ring.size() < 3 || ring.size() > kMostOfFan || !sortRound(ring)) return false;
        std::array<Vec3, kMostOfFan> spokes;
        for (std::size_t i = 0; i < ring.size(); ++i) spokes[i] = points[ring[i][0]] - points[v];
        return goesRoundOnce({spokes.data(), ring.size()});
    };
    parallelForPieces(std::ssize(isClear_), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            isClear_[v] = static_cast<std::uint8_t>(isClear(v));
        }
    });
}

}  // namespace adaptiso
