#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

/// Defects that a file's rounding of coordinates adds to a mesh.
struct RoundingHarm {
    std::int64_t flatTriangles = 0;  ///< that lose their area
    std::int64_t mergedPoints = 0;   ///< that come to lie on another
    std::int64_t crossingPairs = 0;  ///< of triangles
    std::int64_t movedPoints = 0;    ///< no harm, but against it
    double roundingMm = 0;           ///< no point of the file is farther from the mesh; no harm

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
/// Float64, whose rounding counts as 0. The same mesh gives the same result, whatever the number of
/// threads.
RoundingHarm settleRounding(TriangleMesh& mesh, CoordinatePrecision precision,
                            const AffineTransform& toFrame);

/// The mesh as a file holds it, in LPS mm again: its points have the file's digits.
/// \param mesh  LPS mm, settled \param toFrame  as settleRounding()
TriangleMesh asStored(const TriangleMesh& mesh, CoordinatePrecision precision,
                      const AffineTransform& toFrame);

/// Why a file of this format would lie beyond a bound by its rounding alone: "STL keeps 24
/// bits of a coordinate: points would move by up to 0.23 mm, more than the bound of 0.05 mm; ...".
/// Empty where the rounding is less.
/// \param boundMm  > 0
std::optional<std::string> roundingFault(double roundingMm, double boundMm,
                                         const MeshFormat& format);

/// "bound-exceeded", where rounding takes a file beyond the bound that was asked for by more than a
/// hundredth: "lies within 0.0569 mm, not 0.05 mm: STL keeps 24 bits ...". None elsewhere.
/// \param boundMm  that is proved, with the rounding \param requestedMm  > 0
std::optional<Warning> roundingWarning(const std::string& file, double boundMm, double requestedMm,
                                       double roundingMm, const MeshFormat& format);

/// "STL rounds coordinates to 24 bits, by which 2 pairs of triangles cross; ...".
std::string textOf(const RoundingHarm& harm, const MeshFormat& format);

}  // namespace adaptiso
