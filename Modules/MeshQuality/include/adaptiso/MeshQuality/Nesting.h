#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {

/// Relation of two surfaces.
enum class NestingRelation {
    Nested,     ///< the inner one lies strictly inside the outer one
    Crossing,   ///< they cross or touch
    Identical,  ///< the same triangles at the same places
    Swapped,    ///< the outer one lies strictly inside the inner one
    Apart,      ///< each lies outside the other
    Mixed,      ///< they don't meet, but pieces of them lie on different sides
    Unknown     ///< one has no triangle, or too many are near each other: see NestingReport
};
/// "nested", "crossing", "identical", "swapped", "apart", "mixed", "unknown"
std::string_view toString(NestingRelation relation);

struct NestingOptions {
    std::int64_t maxPairs = 1000;  ///< pairs to name
};

struct NestingReport {
    NestingRelation relation = NestingRelation::Unknown;
    std::int64_t crossingPairs = 0;   ///< pairs of triangles with a point in common
    std::vector<TrianglePair> pairs;  ///< the first of them, ascending: of inner, of outer
    bool isComplete = true;           ///< false: more may meet, as SelfIntersections::isComplete
    bool areSidesKnown = true;  ///< false: rays would pass too many triangles; of some vertices
                                ///< the side is not known, and they are in no count of one
    std::int64_t innerVertices = 0;           ///< of inner, used by a triangle
    std::int64_t innerVerticesNotInside = 0;  ///< of those, not strictly inside outer
    VertexId firstNotInside = -1;             ///< the first of those
    double farthestOutMm = 0;                 ///< how far the farthest of those lies from outer
    bool isFarthestKnown = true;  ///< false: not all are measured, see findNearestPlaces()
    std::int64_t outerVertices = 0;
    std::int64_t outerVerticesInside = 0;  ///< of outer, strictly inside inner
    SurfaceGap gap;  ///< A is inner, B outer; 0 mm when they meet; not measured where none is
                     ///< known to meet, but not all are decided

    bool isStrictlyNested() const { return relation == NestingRelation::Nested; }
};

/// Checks that `inner` lies strictly inside `outer`, and measures the gap.
///
/// All of it is exact (trianglesMeet, InsideTest) but for distances, which are rounded. Inside is
/// by the even-odd rule; a surface that is there twice as a whole, which has no inside by it,
/// counts once. Where the surfaces don't meet, vertices that hang together lie on one side, so one
/// of them is asked; where one surface is open, each of the other's is asked, as InsideTest says.
/// Meshes may be broken: triangles with a corner that is not finite are left out, triangles without
/// area meet nothing. \pre triangles name points that are there, options.maxPairs
/// >= 0 \throws InvalidInput otherwise Cost: O(T log T), in parallel; two AabbTrees of memory, and
/// those of findCrossingPairs() where boxes overlap too often. No more pairs are kept than named.
NestingReport checkNesting(const TriangleMesh& inner, const TriangleMesh& outer,
                           const NestingOptions& options = {});

}  // namespace adaptiso
