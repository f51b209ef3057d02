#include "SixSides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <span>

#include "SurfaceRenderer.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Phrases.h"

namespace adaptiso {

namespace {

constexpr int kViewSize = 330, kViewGap = 6, kViewLabel = 24, kViewHead = 36, kBarRoom = 110;

std::string fixed(double value) {
    char text[32];
    std::snprintf(text, sizeof text, value < 0.1 ? "%.4f" : "%.2f", value);
    return text;
}

void drawColorBar(Canvas& canvas, double left, double largestMm) {
    constexpr int kSteps = 256;
    const double top = kViewHead + 40, height = 2.0 * kViewSize - 60;
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

/// Draws one view.
using RenderSide = std::function<Rendering(const View&)>;

/// Six sides, below a line of title.
/// \param toleranceMm  how far behind what is drawn a spot may lie, to be ringed
void drawSixSides(Canvas& canvas, const Scene& scene, const RenderSide& renderSide,
                  double toleranceMm) {
    std::array<Rendering, 6> renderings;
    parallelForPieces(6, 1, [&](std::int64_t begin, std::int64_t) {
        renderings[begin] = renderSide(sixViews()[begin]);
    });
    for (int side = 0; side < 6; ++side) {
        const View& view = sixViews()[side];
        const Rendering& rendering = renderings[side];
        const int left = kViewGap + side % 3 * (kViewSize + kViewGap);
        const int top = kViewHead + side / 3 * (kViewSize + kViewLabel + kViewGap);
        canvas.image(left, top, kViewSize, kViewSize, rendering.colors);
        for (const SceneSpot& spot : scene.spots) {
            if (!spot.isFailure || !rendering.isSeen(spot.pointMm, view, toleranceMm)) continue;
            const Pixel at = rendering.toPixel(spot.pointMm, view);
            canvas.ring({left + at.x, top + at.y}, 9, kAlarm, 2.5);
        }
        const double base = top + kViewSize + 16.0;
        const std::string name = std::string(view.name) + (scene.isFrameSaid ? "" : ", if RAS");
        canvas.text({left + kViewSize / 2.0, base}, name, 14, kInk, Anchor::Middle);
        canvas.text({left + 30.0, base}, view.leftSide, 14, kFaint);
        canvas.text({left + kViewSize - 30.0, base}, view.rightSide, 14, kFaint, Anchor::Right);
    }
}

std::vector<VertexNormals> normalsOf(std::span<const SceneSurface> surfaces) {
    std::vector<VertexNormals> normals(surfaces.size());
    parallelForPieces(std::ssize(surfaces), 1, [&](std::int64_t begin, std::int64_t) {
        normals[begin] = vertexNormals(surfaces[begin].mesh);
    });
    return normals;
}

void drawSixSides(Canvas& canvas, const Scene& scene, std::span<const SceneSurface> surfaces,
                  const BoundingBox& box) {
    const std::vector<VertexNormals> normals = normalsOf(surfaces);
    drawSixSides(
        canvas, scene,
        [&](const View& view) { return render(surfaces, normals, box, view, kViewSize); },
        0.02 * norm(box.size()));
}

/// `front`, with what lies behind it seen through it. \pre both are drawn on white
Rendering seenThrough(Rendering front, const Rendering& behind) {
    constexpr double kThrough = 0.5, kGround = 255;
    for (std::size_t n = 0; n < front.colors.size(); ++n) {
        const double covered = behind.opacity[n] / 255.0;
        const double part = behind.depthMm[n] >= front.depthMm[n] ? 1 : kThrough;
        for (std::size_t i = 0; i < 3; ++i) {
            const double color = behind.colors[n][i] - (1 - covered) * kGround;  // times `covered`
            const double mean = (1 - part * covered) * front.colors[n][i] + part * color;
            front.colors[n][i] = static_cast<std::uint8_t>(std::clamp(mean, 0.0, 255.0) + 0.5);
        }
    }
    return front;
}

constexpr int kSixWidth = 3 * (kViewSize + kViewGap) + kViewGap;
constexpr int kSixHeight = kViewHead + 2 * (kViewSize + kViewLabel + kViewGap);

}  // namespace

Picture sixSidesPicture(const Scene& scene, std::size_t n) {
    const SceneSurface& surface = scene.surfaces[n];
    const bool hasBar = !surface.valuesMm.empty();
    Canvas canvas(kSixWidth + (hasBar ? kBarRoom : 0), kSixHeight, kWhite);
    canvas.rectangle({10, 14}, 22, 12, surface.color);
    canvas.text({40, 26}, surface.name, 16, kInk, Anchor::Left, true);
    drawSixSides(canvas, scene, {&surface, 1}, boxOf(surface, scene.box));
    if (hasBar) {
        drawColorBar(canvas, kSixWidth - kViewGap + 12, surface.largestValueMm);
        canvas.text({canvas.width() - 10.0, 26}, "colours: mm " + surface.valuesAre, 14, kInk,
                    Anchor::Right);
    }
    return {
        "surface-" + std::to_string(n + 1) + ".png",
        surface.name + " from six sides",
        "The surface " + surface.name +
            " from the front, the left, above, the back, the right and below" +
            (hasBar ? "; colours tell the distance " + surface.valuesAre + ", from 0 (violet) to " +
                          fixed(surface.largestValueMm) + " mm (yellow)"
                    : "") +
            ". Where its inside shows, it is red.",
        canvas.png(),
        canvas.width(),
        canvas.height()};
}

std::optional<Picture> alignmentPicture(const Scene& scene) {
    const std::span<const SceneSurface> all = scene.surfaces;
    const auto first = std::ranges::find(all, true, &SceneSurface::areMarks);
    const std::ptrdiff_t at = first - all.begin();
    if (at == 0 || at == std::ssize(all)) return std::nullopt;
    SceneSurface surface = all[at - 1];
    surface.color = {128, 128, 134};  // colours of marks stand out from it
    surface.valuesMm = {};
    const std::span<const SceneSurface> base(&surface, 1), marks = all.subspan(at);
    const std::vector<VertexNormals> baseNormals = normalsOf(base), markNormals = normalsOf(marks);
    const BoundingBox box = boxOf(surface, scene.box);

    Canvas canvas(kSixWidth, kSixHeight, kWhite);
    double x = 10;
    std::string names;
    const auto addToLegend = [&](const SceneSurface& drawn) {
        canvas.rectangle({x, 14}, 22, 12, drawn.color);
        canvas.text({x + 30, 26}, drawn.name, 16, kInk, Anchor::Left, true);
        x += 70 + canvas.textWidth(drawn.name, 16);
    };
    addToLegend(surface);
    for (const SceneSurface& drawn : marks) {
        addToLegend(drawn);
        addPart(names, drawn.name);
    }
    drawSixSides(
        canvas, scene,
        [&](const View& view) {
            return seenThrough(render(base, baseNormals, box, view, kViewSize, false),
                               render(marks, markNormals, box, view, kViewSize, false));
        },
        0.02 * norm(box.size()));
    return Picture{"alignment.png",
                   "Alignment: " + names + " and " + surface.name,
                   "The surface " + surface.name + " from six sides, with " + names +
                       "; what lies behind it is seen through it, paler.",
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
