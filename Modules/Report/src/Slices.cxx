#include "Slices.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "Canvas.h"

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

namespace {

constexpr int kColumns = 4, kRows = 3;
constexpr int kTile = 270;  // pixels, the longer side of a tile
constexpr int kGap = 4;
constexpr int kHead = 34;      // room for the legend above
constexpr double kLabel = 14;  // of what is written on slices
constexpr std::size_t kMostSpots = 6;

std::string millimetres(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0f mm", value == 0 ? 0.0 : value);
    return text;
}

/// The window of the image, found once.
struct Backdrop {
    explicit Backdrop(const Report& report)
        : volume(report.volume ? &report.volume->view : nullptr),
          window(volume ? greyWindow(*volume) : ValueRange{0, 1}) {}

    const VolumeView* volume;
    ValueRange window;
};

/// The names of the surfaces in their colours.
void drawLegend(Canvas& canvas, const Scene& scene, double y) {
    double x = 10;
    for (const SceneSurface& surface : scene.surfaces) {
        canvas.rectangle({x, y - 10}, 22, 5, surface.color);
        canvas.text({x + 28, y - 3}, surface.name, 14, kWhite);
        x += 56 + canvas.textWidth(surface.name, 14);
        if (x > canvas.width() - 160) break;  // the page lists them all
    }
}

void drawSides(Canvas& canvas, Pixel corner, const SlicePlane& plane) {
    const SliceSides sides = sidesOf(plane.axis);
    const double middle = corner.y + plane.height / 2.0 + 5;
    canvas.label({corner.x + 5, middle}, sides.left, kLabel);
    canvas.label({corner.x + plane.width - 5, middle}, sides.right, kLabel, Anchor::Right);
    canvas.label({corner.x + plane.width / 2.0, corner.y + 16}, sides.top, kLabel, Anchor::Middle);
}

std::string contourAlt(const Scene& scene, int axis, bool hasImage) {
    std::string text = std::string("Twelve ") + sliceName(axis) +
                       (hasImage ? " slices of the image" : " slices") + " with the outlines of ";
    constexpr std::size_t kMost = 12;
    const std::size_t count = scene.surfaces.size();
    if (count > kMost) return text + std::to_string(count) + " surfaces.";
    for (std::size_t n = 0; n < count; ++n) {
        text += (n == 0 ? "" : n + 1 == count ? " and " : ", ") + scene.surfaces[n].name;
    }
    return text + ".";
}

}  // namespace

Picture contourPicture(const Report& report, const Scene& scene, int axis) {
    const Backdrop backdrop(report);
    SlicePlane plane;
    plane.axis = axis;
    const Vec3 extent = scene.box.maximum - scene.box.minimum;
    const double marginMm =
        0.06 * std::max({extent.x, extent.y, extent.z, 1e-6});  // that no line lies on the edge
    const double widthMm = extent[plane.across()] + 2 * marginMm;
    const double heightMm = extent[plane.up()] + 2 * marginMm;
    plane.mmPerPixel = std::max(widthMm, heightMm) / kTile;
    plane.width = std::max(60, static_cast<int>(widthMm / plane.mmPerPixel));
    plane.height = std::max(60, static_cast<int>(heightMm / plane.mmPerPixel));
    const Vec3 middle = 0.5 * (scene.box.minimum + scene.box.maximum);
    plane.leftMm = middle[plane.across()] - plane.mmPerPixel * plane.width / 2;
    plane.topMm = middle[plane.up()] + plane.mmPerPixel * plane.height / 2;

    Canvas canvas(kColumns * (plane.width + kGap) + kGap,
                  kHead + kRows * (plane.height + kGap) + kGap, kBlack);
    drawLegend(canvas, scene, 26);
    for (int n = 0; n < kColumns * kRows; ++n) {
        plane.atMm = scene.box.minimum[axis] + (n + 0.5) / (kColumns * kRows) * extent[axis];
        const Pixel corner{double(kGap + n % kColumns * (plane.width + kGap)),
                           double(kHead + n / kColumns * (plane.height + kGap))};
        drawSlice(canvas, corner, plane, scene, backdrop.volume, backdrop.window, 1.6);
        drawSides(canvas, corner, plane);
        const std::string axisName(1, "xyz"[axis]);
        canvas.label({corner.x + 6, corner.y + plane.height - 8},
                     axisName + " = " + millimetres(plane.atMm), kLabel);
    }
    const std::string name = sliceName(axis);
    return {"contours-" + name + ".png",
            "Outlines on " + name + " slices",
            contourAlt(scene, axis, backdrop.volume != nullptr),
            canvas.png(),
            canvas.width(),
            canvas.height()};
}

std::optional<Picture> spotPicture(const Report& report, const Scene& scene) {
    if (scene.spots.empty()) return std::nullopt;
    constexpr int kSize = 300, kTitle = 26;
    const Backdrop backdrop(report);
    const std::size_t rows = std::min(scene.spots.size(), kMostSpots);
    const Vec3 extent = scene.box.maximum - scene.box.minimum;
    // a quarter of the surfaces around the spot: near enough to see, far enough to know where
    const double fieldMm = std::max({extent.x, extent.y, extent.z, 1e-6}) / 4;

    Canvas canvas(3 * (kSize + kGap) + kGap,
                  kHead + static_cast<int>(rows) * (kSize + kTitle + kGap) + kGap, kBlack);
    drawLegend(canvas, scene, 26);
    for (std::size_t row = 0; row < rows; ++row) {
        const SceneSpot& spot = scene.spots[row];
        const double top = kHead + double(row) * (kSize + kTitle + kGap);
        canvas.text({10, top + 18}, std::to_string(row + 1) + ". " + spot.what, 14, kWhite);
        for (int column = 0; column < 3; ++column) {
            SlicePlane plane;
            plane.axis = 2 - column;
            plane.atMm = spot.pointMm[plane.axis];
            plane.mmPerPixel = fieldMm / kSize;
            plane.width = plane.height = kSize;
            plane.leftMm = spot.pointMm[plane.across()] - fieldMm / 2;
            plane.topMm = spot.pointMm[plane.up()] + fieldMm / 2;
            const Pixel corner{double(kGap + column * (kSize + kGap)), top + kTitle};
            drawSlice(canvas, corner, plane, scene, backdrop.volume, backdrop.window, 2);
            drawSides(canvas, corner, plane);
            canvas.ring({corner.x + kSize / 2.0, corner.y + kSize / 2.0}, 16, kAlarm, 2.5);
        }
    }
    return Picture{"spots.png",
                   "Where to look",
                   "For each of " + std::to_string(rows) +
                       " places, an axial, a coronal and a sagittal slice through it; the place is "
                       "ringed in red.",
                   canvas.png(),
                   canvas.width(),
                   canvas.height()};
}

}  // namespace adaptiso
