#include "SlicePictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "Canvas.h"
#include "Slices.h"

namespace adaptiso {
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
