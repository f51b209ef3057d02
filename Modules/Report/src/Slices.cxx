#include "Slices.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace adaptiso {
namespace {

/// The sample at a continuous index, from the eight around it.
/// \return none more than half a voxel outside
template <class T>
std::optional<double> interpolate(const TypedVolumeView<T>& volume, const Vec3& index) {
    std::int64_t low[3];
    double part[3];
    for (int axis = 0; axis < 3; ++axis) {
        const auto last = static_cast<double>(volume.geometry.size[axis] - 1);
        if (!(index[axis] >= -0.5 && index[axis] <= last + 0.5)) return std::nullopt;
        const double place = std::clamp(index[axis], 0.0, last);
        low[axis] = std::min(static_cast<std::int64_t>(place),
                             std::max<std::int64_t>(volume.geometry.size[axis] - 2, 0));
        part[axis] = place - static_cast<double>(low[axis]);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::int64_t at[3];
        for (int axis = 0; axis < 3; ++axis) {
            const bool isHigh = corner >> axis & 1;
            weight *= isHigh ? part[axis] : 1 - part[axis];
            at[axis] = low[axis] + isHigh;
        }
        if (weight > 0) sum += weight * static_cast<double>(volume.at(at[0], at[1], at[2]));
    }
    return sum;
}

}  // namespace

std::uint8_t greyOf(double value, const ValueRange& window) {
    const double part = (value - window.minimum) / (window.maximum - window.minimum);
    if (!(part > 0)) return 0;  // NaN too
    return static_cast<std::uint8_t>(std::lround(255 * std::min(part, 1.0)));
}

ValueRange greyWindow(const VolumeView& volume) {
    constexpr std::int64_t kEnough = 1'000'000;
    std::vector<double> values;
    dispatchPixelType(volume, [&](const auto& view) {
        const std::int64_t count = view.geometry.voxelCount();
        // a step that shares no factor with the rows, so that no column is looked at alone
        const std::int64_t step = std::max<std::int64_t>(1, count / kEnough) | 1;
        for (std::int64_t n = 0; n < count; n += step) {
            const auto value = static_cast<double>(view.samples[n]);
            if (std::isfinite(value)) values.push_back(value);
        }
    });
    if (values.empty()) return {0, 1};
    const auto rank = [&](double part) {
        const auto nth = values.begin() +
                         static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), nth, values.end());
        return *nth;
    };
    ValueRange window{rank(0.01), rank(0.995)};
    if (!(window.maximum > window.minimum)) window = {rank(0), rank(1)};
    if (!(window.maximum > window.minimum)) window.maximum = window.minimum + 1;
    return window;
}

const char* sliceName(int axis) {
    return axis == 2 ? "axial" : axis == 1 ? "coronal" : "sagittal";
}

SliceSides sidesOf(int axis) {
    if (axis == 2) return {"L", "R", "A", "P"};
    if (axis == 1) return {"L", "R", "S", "I"};
    return {"P", "A", "S", "I"};
}

std::vector<std::uint8_t> sampleSlice(const VolumeView& volume, const ValueRange& window,
                                      const SlicePlane& plane, const FaceCut* face) {
    std::vector<std::uint8_t> grey(static_cast<std::size_t>(plane.width) * plane.height);
    const ImageGeometry& geometry = volume.geometry();
    Vec3 corner, right, down;  // RAS is LPS turned by half about z, so is its own inverse
    corner[plane.axis] = plane.atMm;
    corner[plane.across()] = plane.leftMm + plane.mmPerPixel / 2;
    corner[plane.up()] = plane.topMm - plane.mmPerPixel / 2;
    right[plane.across()] = plane.mmPerPixel;
    down[plane.up()] = -plane.mmPerPixel;
    const Mat3 toIndex = inverse(geometry.indexToPhysical);
    const Vec3 start = geometry.toIndex(lpsToRas(corner));
    const Vec3 stepX = toIndex * lpsToRas(right), stepY = toIndex * lpsToRas(down);
    dispatchPixelType(volume, [&](const auto& view) {
        std::size_t n = 0;
        for (int y = 0; y < plane.height; ++y) {
            for (int x = 0; x < plane.width; ++x, ++n) {
                if (face && face->hides(corner + double(x) * right + double(y) * down)) continue;
                const auto value = interpolate(view, start + double(x) * stepX + double(y) * stepY);
                if (value) grey[n] = greyOf(*value, window);
            }
        }
    });
    return grey;
}

void drawSlice(Canvas& canvas, Pixel corner, const SlicePlane& plane, const Scene& scene,
               const VolumeView* volume, const ValueRange& window, double lineWidth) {
    canvas.clip(corner, plane.width, plane.height);
    if (volume) {
        canvas.image(static_cast<int>(corner.x), static_cast<int>(corner.y), plane.width,
                     plane.height, sampleSlice(*volume, window, plane, scene.face.get()));
    } else {
        canvas.rectangle(corner, plane.width, plane.height, kBlack);
    }
    std::vector<std::vector<std::pair<Pixel, Pixel>>> outlines;
    for (const SceneSurface& surface : scene.surfaces) {
        auto& lines = outlines.emplace_back();
        for (const Segment& segment : cutByPlane(surface.mesh, plane.axis, plane.atMm)) {
            const Pixel a = plane.toPixel(segment[0]), b = plane.toPixel(segment[1]);
            lines.push_back({{corner.x + a.x, corner.y + a.y}, {corner.x + b.x, corner.y + b.y}});
        }
    }
    // yellow on bright tissue is seen by its dark rim; all rims lie under all lines
    constexpr double kRim = 2;
    for (const auto& lines : outlines) canvas.segments(lines, kBlack, lineWidth + kRim);
    for (std::size_t n = 0; n < outlines.size(); ++n) {
        canvas.segments(outlines[n], scene.surfaces[n].color, lineWidth);
    }
    canvas.restore();
}

}  // namespace adaptiso
