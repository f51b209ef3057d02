#pragma once

#include <cstdint>
#include <string>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/FrameTransform.h"

namespace adaptiso {

/// What a file's rounding of coordinates makes of a mesh that has none of it.
struct RoundingHarm {
    std::int64_t flatTriangles = 0;  ///< that lose their area
    std::int64_t mergedPoints = 0;   ///< that come to lie on another
    std::int64_t crossingPairs = 0;  ///< of triangles
    std::int64_t movedPoints = 0;    ///< no harm, but against it

    explicit operator bool() const { return flatTriangles + mergedPoints + crossingPairs > 0; }
};

/// Moves single vertices to neighbouring coordinates of a file's precision where triangles would
/// cross or lose their area, or two vertices lie at one place, by its rounding alone: a surface
/// that is sound is so in the file too.
///
/// Vertices that are moved move by three units in the last place at most; all others stay as they
/// are. More than a few hundred such places are counted, and left, and so are they where more than
/// a hundredth of the triangles lose their area or corners.
///
/// \param mesh     LPS mm
/// \param toFrame  LPS mm to the frame of the file; invertible
/// \return         what is left
/// Cost: as findSelfIntersections(), once or twice, and two copies of the points; nothing for
/// Float64. The same mesh gives the same result, whatever the number of threads.
RoundingHarm settleRounding(TriangleMesh& mesh, CoordinatePrecision precision,
                            const AffineTransform& toFrame);

/// "STL (binary) rounds coordinates to 24 bits, by which 2 pairs of triangles cross; ...".
std::string textOf(const RoundingHarm& harm, const MeshFormat& format);

}  // namespace adaptiso
