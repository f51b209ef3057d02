#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "adaptiso/Preprocessing/Resample.h"

namespace adaptiso {
namespace {

/// The axes at right angles that are nearest to those of the image, i first.
std::array<Vec3, 3> rightAngledAxes(const Mat3& indexToPhysical) {
    std::array<Vec3, 3> axes;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 rest = normalized(indexToPhysical.column[axis]);
        for (int before = 0; before < axis; ++before) {
            rest = rest - dot(rest, axes[before]) * axes[before];
        }
        axes[axis] = normalized(rest);
    }
    return axes;
}

/// Half of what the voxels' centres span along `axis`, mm.
double halfSpanMm(const ImageGeometry& geometry, const Vec3& axis) {
    double span = 0;
    for (int a = 0; a < 3; ++a) {
        span += static_cast<double>(geometry.size[a] - 1) *
                std::abs(dot(geometry.indexToPhysical.column[a], axis));
    }
    return span / 2;
}

[[noreturn]] void refuse(double stepMm, const std::string& rule) {
    std::ostringstream message;
    message << "voxels of " << stepMm << " mm: " << rule;
    throw InvalidInput(message.str());
}

}  // namespace

std::string_view toString(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::Nearest:
            return "nearest";
        case Interpolation::Linear:
            return "linear";
        case Interpolation::BSpline:
            return "bspline";
    }
    throw InternalError("toString: unknown interpolation");
}

ImageGeometry isotropicGrid(const ImageGeometry& geometry, double stepMm) {
    constexpr double kRounding = 1e-6;  // of a step: 100 mm in steps of 0.1 mm are 1000 of them
    if (!(stepMm > 0) || !std::isfinite(stepMm)) refuse(stepMm, "must be more than 0 mm");
    const std::array<Vec3, 3> axes = rightAngledAxes(geometry.indexToPhysical);
    const Vec3 last{static_cast<double>(geometry.size[0] - 1),
                    static_cast<double>(geometry.size[1] - 1),
                    static_cast<double>(geometry.size[2] - 1)};
    ImageGeometry grid;
    grid.originMm = geometry.toPhysical(0.5 * last);
    for (int axis = 0; axis < 3; ++axis) {
        const double steps = std::floor(2 * halfSpanMm(geometry, axes[axis]) / stepMm + kRounding);
        if (steps < 1) {
            refuse(stepMm,
                   std::string("the image is less than one of them wide along ") + "ijk"[axis]);
        }
        if (!(steps < 0x1p40)) refuse(stepMm, "are too many");  // whose product a double holds
        grid.size[axis] = static_cast<std::int64_t>(steps) + 1;
        grid.indexToPhysical.column[axis] = stepMm * axes[axis];
        grid.originMm = grid.originMm - (steps / 2 * stepMm) * axes[axis];
    }
    return grid;
}

}  // namespace adaptiso
