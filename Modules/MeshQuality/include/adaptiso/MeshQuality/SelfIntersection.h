#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// True if two triangles cross, decided exactly (orient2d, orient3d).
///
/// Triangles are closed: they cross when they have a point in common, be it one that touches.
/// Corners at the same place are shared, whatever their numbers (so an unwelded mesh is not all
/// crossings), and what hangs together by a shared corner or edge anyway doesn't count:
///   - one corner shared: they cross when they meet in more than that corner;
///   - two shared: when they lie in one plane, on the same side of the shared edge (a fold);
///   - three shared: always (one lies on the other).
/// A triangle whose corners lie exactly on a line crosses nothing. \pre corners are finite
bool trianglesCross(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// True if two triangles of different surfaces share a point, decided exactly: touching
/// is enough, also at a corner or along an edge that both have. A triangle whose corners lie
/// exactly on a line meets nothing. \pre corners are finite
bool trianglesMeet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

struct SelfIntersectionOptions {
    std::int64_t maxPairs = 1000;  ///< pairs to name; all are counted
};

/// Numbers of two triangles that cross, the smaller first.
using TrianglePair = std::array<std::int64_t, 2>;

struct SelfIntersections {
    std::int64_t pairCount = 0;
    std::vector<TrianglePair> pairs;  ///< the first of them, ascending
    bool isComplete = true;           ///< false: more may cross, see findCrossingPairs()

    /// No pair crosses, and all are decided.
    bool isClear() const { return pairCount == 0 && isComplete; }
};

/// "1,234"; where there may be more "more than 4,100,000", with two digits, or "at least 1".
std::string foundText(std::int64_t found, bool isComplete);

/// "3 pairs", "more than 4,100,000 pairs": how many were found, where there may be more.
std::string pairsText(std::int64_t found, bool isComplete);

/// "3 pairs of triangles cross", "more than 4,100,000 pairs of triangles cross", "not decided: ..."
std::string crossingText(const SelfIntersections& crossings);

/// All pairs of triangles of `mesh` that cross, as trianglesCross has it; where they are too many,
/// some of them: findCrossingPairs() says how many. Triangles with a non-finite corner cross
/// nothing.
/// \pre triangles name points that are there, there are fewer than 2^32 of both, and
///      options.maxPairs >= 0 \throws InvalidInput otherwise
/// Cost: that of findCrossingPairs(), and 20 bytes a triangle.
/// The same mesh gives the same bytes, whatever the number of threads.
SelfIntersections findSelfIntersections(const TriangleMesh& mesh,
                                        const SelfIntersectionOptions& options = {});

/// The triangles of those pairs, and those that near pairs leave undecided, ascending. What is
/// required, what is thrown and what it costs: as findSelfIntersections() has it.
std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh);

/// The same apart.
struct CrossingTriangles {
    std::vector<std::int64_t> found;      ///< that cross others, ascending
    std::vector<std::int64_t> undecided;  ///< others that near pairs leave undecided, ascending

    bool isEmpty() const { return found.empty() && undecided.empty(); }
    bool isComplete() const { return undecided.empty(); }
};
CrossingTriangles findCrossingTriangles(const TriangleMesh& mesh);
/// \pre the corners of triangles are finite
CrossingTriangles findCrossingTriangles(const TriangleView& mesh);

/// Cell of a triangle that may cross any other.
inline constexpr std::uint64_t kNoCell = ~std::uint64_t{0};

/// The same for a mesh of which it is known that triangles of different cells do not cross, as
/// where marching cubes put them there: such pairs are not looked at. \param cells  of each
/// triangle; kNoCell: it may cross any other. Empty: each may Cost: without triangles in cells,
/// that of findCrossingPairs(); where all are in cells, O(T)
std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh,
                                            std::span<const std::uint64_t> cells);

std::vector<std::int64_t> crossingTriangles(const TriangleView& mesh,
                                            std::span<const std::uint64_t> cells);

}  // namespace adaptiso
