#pragma once

#include <optional>
#include <string_view>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// What sizes of a surface in mm are believed.
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

/// Whether `mesh`, its numbers taken for millimetres, has a plausible size.
/// \pre triangles name points that are there \throws InvalidInput otherwise
SizeReport judgeSize(const TriangleMesh& mesh, const SizeLimits& limits);

}  // namespace adaptiso
