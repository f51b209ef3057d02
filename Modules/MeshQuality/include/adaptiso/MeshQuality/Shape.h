#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Spread of a quantity over a mesh. Percentiles are by nearest rank: the smallest value that
/// at least that part does not exceed.
struct Spread {
    double minimum = 0, p1 = 0, p5 = 0, median = 0, mean = 0, p99 = 0, maximum = 0;
    std::int64_t triangleOfMinimum = -1;  ///< the first of several; -1: nothing was measured
    std::int64_t triangleOfMaximum = -1;
};

struct ShapeReport {
    std::int64_t triangles = 0;  ///< measured
    Spread angleDeg;             ///< smallest angle of each triangle: 60 is best
    Spread aspectRatio;          ///< 1 is best; infinite without area
    Spread edgeMm;               ///< every triangle's three: an edge in two triangles counts twice
};

/// The shape of the triangles of `mesh`. The aspect ratio is longest edge / (2 sqrt(3) times the
/// radius of the inscribed circle) [Pebay2003]: 1 for equilateral triangles.
///
/// Triangles that name a vertex twice, or have a corner that is not finite, are left out; those
/// that are flat count, with an angle of 0 degrees.
/// \pre triangles name points that are there \throws InvalidInput otherwise
/// Cost: O(T); 40 bytes a triangle of memory.
ShapeReport measureShape(const TriangleMesh& mesh);

/// Plausible sizes of a surface in mm.
struct SizeLimits {
    double minExtentMm = 0;         ///< of every side of the bounding box
    double minLargestExtentMm = 1;  ///< of its longest side
    double maxLargestExtentMm = 2000;
};

enum class SizeVerdict { Plausible, TooSmall, TooLarge, Unknown };

/// A length unit that a file's numbers may have been meant in.
enum class LengthUnit { Metres, Centimetres, Micrometres };
/// "metres", "centimetres", "micrometres"
std::string_view toString(LengthUnit unit);

struct SizeReport {
    Vec3 extentMm;  ///< sides of the bounding box of the vertices that triangles use
    SizeVerdict verdict = SizeVerdict::Unknown;  ///< Unknown: no triangle has finite corners
    std::optional<LengthUnit> guess;  ///< where not plausible: the unit that would make it so
};

/// Judges the size of `mesh`, its numbers taken for millimetres.
/// \pre triangles name points that are there \throws InvalidInput otherwise
SizeReport judgeSize(const TriangleMesh& mesh, const SizeLimits& limits);

}  // namespace adaptiso
