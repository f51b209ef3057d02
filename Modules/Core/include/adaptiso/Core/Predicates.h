#pragma once

#include <array>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

using Point2 = std::array<double, 2>;

/// On which side of the line a -> b the point c lies, decided exactly: 1 left (a, b, c are
/// counter-clockwise), -1 right, 0 on it.
///
/// A floating-point filter answers almost always; the rest is done in exact expansion arithmetic
/// [Shewchuk1997]. Exact for coordinates that are 0 or between 1e-100 and 1e100 in size and that
/// differ by 0 or more than 1e-90 (so that no product underflows).
/// \pre coordinates are finite
int orient2d(const Point2& a, const Point2& b, const Point2& c);

/// On which side of the plane through a, b, c the point d lies, decided exactly: 1 where the
/// right-hand normal (b - a) x (c - a) points, -1 on the other side, 0 in the plane or when a, b
/// and c lie on a line. Method and limits as for orient2d. \pre coordinates are finite
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace adaptiso
