#include "SurfacePictures.h"

#include <algorithm>
#include <cstdio>
#include <span>

#include "SurfaceRenderer.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr int kSize = 330, kGap = 6, kLabel = 24, kHead = 36, kBarRoom = 110;

std::string fixed(double value) {
    char text[32];
    std::snprintf(text, sizeof text, value < 0.1 ? "%.4f" : "%.2f", value);
    return text;
}

void drawColorBar(Canvas& canvas, double left, double largestMm) {
    constexpr int kSteps = 256;
    const double top = kHead + 40, height = 2.0 * kSize - 60;
    for (int n = 0; n < kSteps; ++n) {
        canvas.rectangle({left, top + height * (kSteps - 1 - n) / kSteps}, 20,
                         height / kSteps + 0.5, viridis(n / double(kSteps - 1)));
    }
    for (int tick = 0; tick <= 4; ++tick) {
        const double y = top + height * (1 - tick / 4.0);
        canvas.segments({{{left + 20, y}, {left + 26, y}}}, kInk, 1);
        canvas.text({left + 30, y + 5}, fixed(largestMm * tick / 4), 13, kInk);
    }
    canvas.text({left, top - 14}, "mm", 14, kInk);
}

BoundingBox boxOf(const SceneSurface& surface, const BoundingBox& otherwise) {
    // points that no triangle uses don't count, they may be anything
    return surface.mesh.isEmpty() ? otherwise : boxOf(surface.mesh);
}

}  // namespace

namespace {

/// Surfaces from six sides, below a line of title.
void drawSixSides(Canvas& canvas, const Scene& scene, std::span<const SceneSurface> surfaces,
                  const BoundingBox& box) {
    std::vector<VertexNormals> normals(surfaces.size());
    parallelForPieces(std::ssize(surfaces), 1, [&](std::int64_t begin, std::int64_t) {
        normals[begin] = vertexNormals(surfaces[begin].mesh);
    });
    std::array<Rendering, 6> renderings;
    parallelForPieces(6, 1, [&](std::int64_t begin, std::int64_t) {
        renderings[begin] = render(surfaces, normals, box, sixViews()[begin], kSize);
    });
    const double toleranceMm = 0.02 * norm(box.size());
    for (int side = 0; side < 6; ++side) {
        const View& view = sixViews()[side];
        const Rendering& rendering = renderings[side];
        const int left = kGap + side % 3 * (kSize + kGap);
        const int top = kHead + side / 3 * (kSize + kLabel + kGap);
        canvas.image(left, top, kSize, kSize, rendering.colors);
        for (const SceneSpot& spot : scene.spots) {
            if (!spot.isFailure || !rendering.isSeen(spot.pointMm, view, toleranceMm)) continue;
            const Pixel at = rendering.toPixel(spot.pointMm, view);
            canvas.ring({left + at.x, top + at.y}, 9, kAlarm, 2.5);
        }
        const double base = top + kSize + 16.0;
        canvas.text({left + kSize / 2.0, base}, view.name, 14, kInk, Anchor::Middle);
        canvas.text({left + 30.0, base}, view.leftSide, 14, kFaint);
        canvas.text({left + kSize - 30.0, base}, view.rightSide, 14, kFaint, Anchor::Right);
    }
}

constexpr int kSixWidth = 3 * (kSize + kGap) + kGap;
constexpr int kSixHeight = kHead + 2 * (kSize + kLabel + kGap);

}  // namespace

Picture sixSidesPicture(const Scene& scene, std::size_t n) {
    const SceneSurface& surface = scene.surfaces[n];
    const bool hasBar = !surface.valuesMm.empty();
    Canvas canvas(kSixWidth + (hasBar ? kBarRoom : 0), kSixHeight, kWhite);
    canvas.rectangle({10, 14}, 22, 12, surface.color);
    canvas.text({40, 26}, surface.name, 16, kInk, Anchor::Left, true);
    drawSixSides(canvas, scene, {&surface, 1}, boxOf(surface, scene.box));
    if (hasBar) drawColorBar(canvas, kSixWidth - kGap + 12, surface.largestValueMm);
    return {"surface-" + std::to_string(n + 1) + ".png",
            surface.name + " from six sides",
            "The surface " + surface.name +
                " from the front, the left, above, the back, the right and below" +
                (hasBar ? "; colours tell the distance, from 0 (violet) to " +
                              fixed(surface.largestValueMm) + " mm (yellow)"
                        : "") +
                ". Where its inside shows, it is red.",
            canvas.png(),
            canvas.width(),
            canvas.height()};
}

Picture regionsPicture(const Scene& scene) {
    Canvas canvas(kSixWidth, kSixHeight, kWhite);
    const std::string count = std::to_string(scene.surfaces.size()) +
                              (scene.surfaces.size() == 1 ? " region" : " regions");
    canvas.text({10, 26}, count + ", each in its colour", 16, kInk, Anchor::Left, true);
    drawSixSides(canvas, scene, scene.surfaces, scene.box);
    return {"regions.png",
            "All regions from six sides",
            "The surfaces of " + count +
                ", each in its colour, from the front, the left, above, the back, the right and "
                "below. Where an inside shows, it is red.",
            canvas.png(),
            canvas.width(),
            canvas.height()};
}

}  // namespace adaptiso
