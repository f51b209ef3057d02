#include "SurfaceRenderer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

namespace {

constexpr ReportColor kBack{214, 69, 65};
constexpr int kFiner = 2;  // pixels are drawn this much finer, then averaged
constexpr double kFarBehind = -std::numeric_limits<double>::infinity();

/// A corner as the view sees it: pixels, and mm towards the viewer.
struct Corner {
    double x, y, depth;
    Vec3 normal;
    double value;
};

/// The picture before it is averaged down.
class Raster {
public:
    Raster(const BoundingBox& box, const View& view, int size)
        : view_(view),
          right_(view.right()),
          size_(size * kFiner),
          middle_(0.5 * (box.minimum + box.maximum)),
          light_(normalized(0.9 * view.toViewer + 0.45 * view.up - 0.35 * right_)),
          colors_(static_cast<std::size_t>(size_) * size_, kWhite),
          depths_(colors_.size(), kFarBehind) {
        const Vec3 extent = box.size();
        mmPerPixel_ = 1.06 * std::max({extent.x, extent.y, extent.z, 1e-9}) / size_;
    }

    void draw(const SceneSurface& surface, const VertexNormals& normals) {
        surface_ = &surface;
        normals_ = &normals;
        drawsEdges_ = meanTrianglePixels() > 60;
        surface.mesh.forEachTriangle(
            [&](const Triangle& t) { drawTriangle(corner(t[0]), corner(t[1]), corner(t[2])); });
    }

    Rendering finish() const {
        Rendering result{size_ / kFiner, middle_, mmPerPixel_ * kFiner, {}, {}};
        for (int y = 0; y < result.size; ++y) {
            for (int x = 0; x < result.size; ++x) averagePixel(x, y, result);
        }
        return result;
    }

private:
    Corner corner(VertexId v) const {
        const Vec3 p = surface_->mesh.point(v) - middle_;
        return {size_ / 2.0 + dot(p, right_) / mmPerPixel_,
                size_ / 2.0 - dot(p, view_.up) / mmPerPixel_, dot(p, view_.toViewer),
                toVec3((*normals_)[v]), surface_->valuesMm.empty() ? 0 : surface_->valuesMm[v]};
    }

    double meanTrianglePixels() const {
        const auto count =
            static_cast<double>(std::max<std::int64_t>(surface_->mesh.triangleCount(), 1));
        return surfaceArea(surface_->mesh) / count / (mmPerPixel_ * mmPerPixel_);
    }

    void drawTriangle(const Corner& a, const Corner& b, const Corner& c) {
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (area == 0) return;         // edge-on
        const bool isBack = area > 0;  // y runs down
        const auto first = [](double p, double q, double r) {
            return std::max(0, static_cast<int>(std::ceil(std::min({p, q, r}) - 0.5)));
        };
        const auto last = [this](double p, double q, double r) {
            return std::min(size_ - 1, static_cast<int>(std::floor(std::max({p, q, r}) - 0.5)));
        };
        const double longest =
            std::max({std::hypot(b.x - a.x, b.y - a.y), std::hypot(c.x - b.x, c.y - b.y),
                      std::hypot(a.x - c.x, a.y - c.y)});
        const double edgePart = std::abs(area) > 0 ? 0.7 * longest / std::abs(area) : 0;
        for (int y = first(a.y, b.y, c.y); y <= last(a.y, b.y, c.y); ++y) {
            for (int x = first(a.x, b.x, c.x); x <= last(a.x, b.x, c.x); ++x) {
                const double px = x + 0.5, py = y + 0.5;
                const double u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
                const double v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
                const double w = 1 - u - v;
                if (u < 0 || v < 0 || w < 0) continue;
                const double depth = u * a.depth + v * b.depth + w * c.depth;
                const std::size_t n = static_cast<std::size_t>(y) * size_ + x;
                if (!(depth > depths_[n])) continue;
                depths_[n] = depth;
                const bool isEdge = drawsEdges_ && std::min({u, v, w}) < edgePart;
                colors_[n] = shade(u * a.normal + v * b.normal + w * c.normal,
                                   u * a.value + v * b.value + w * c.value, isBack, isEdge);
            }
        }
    }

    ReportColor shade(Vec3 normal, double value, bool isBack, bool isEdge) const {
        normal = normalized(normal);
        if (dot(normal, view_.toViewer) < 0) normal = -normal;
        ReportColor color = surface_->color;
        if (!surface_->valuesMm.empty()) color = viridis(value / surface_->largestValueMm);
        if (isBack) color = kBack;
        const double light =
            (0.45 + 0.55 * std::max(0.0, dot(normal, light_))) * (isEdge ? 0.72 : 1);
        for (std::uint8_t& channel : color) {
            channel = static_cast<std::uint8_t>(std::lround(channel * light));
        }
        return color;
    }

    void averagePixel(int x, int y, Rendering& result) const {
        std::array<int, 3> sum{};
        double depth = kFarBehind;
        for (int dy = 0; dy < kFiner; ++dy) {
            for (int dx = 0; dx < kFiner; ++dx) {
                const std::size_t n =
                    static_cast<std::size_t>(y * kFiner + dy) * size_ + x * kFiner + dx;
                for (std::size_t i = 0; i < 3; ++i) sum[i] += colors_[n][i];
                depth = std::max(depth, depths_[n]);
            }
        }
        ReportColor color;
        constexpr int kSamples = kFiner * kFiner;
        for (std::size_t i = 0; i < 3; ++i) {
            color[i] = static_cast<std::uint8_t>((sum[i] + kSamples / 2) / kSamples);
        }
        result.colors.push_back(color);
        result.depthMm.push_back(depth);
    }

    const SceneSurface* surface_ = nullptr;  ///< that is drawn
    const VertexNormals* normals_ = nullptr;
    const View& view_;
    Vec3 right_;
    int size_;
    Vec3 middle_, light_;
    double mmPerPixel_ = 1;
    bool drawsEdges_ = false;
    std::vector<ReportColor> colors_;
    std::vector<double> depths_;
};

}  // namespace

const std::array<View, 6>& sixViews() {
    static const std::array<View, 6> kViews{{{"from the front", {0, 1, 0}, {0, 0, 1}, "R", "L"},
                                             {"from the left", {-1, 0, 0}, {0, 0, 1}, "A", "P"},
                                             {"from above", {0, 0, 1}, {0, 1, 0}, "L", "R"},
                                             {"from the back", {0, -1, 0}, {0, 0, 1}, "L", "R"},
                                             {"from the right", {1, 0, 0}, {0, 0, 1}, "P", "A"},
                                             {"from below", {0, 0, -1}, {0, 1, 0}, "R", "L"}}};
    return kViews;
}

Pixel Rendering::toPixel(const Vec3& p, const View& view) const {
    const Vec3 d = p - middle;
    return {size / 2.0 + dot(d, view.right()) / mmPerPixel,
            size / 2.0 - dot(d, view.up) / mmPerPixel};
}

bool Rendering::isSeen(const Vec3& p, const View& view, double toleranceMm) const {
    const Pixel at = toPixel(p, view);
    if (!(at.x >= 0 && at.y >= 0 && at.x < size && at.y < size)) return false;
    const double depth = dot(p - middle, view.toViewer);
    const double seen =
        depthMm[static_cast<std::size_t>(at.y) * size + static_cast<std::size_t>(at.x)];
    return std::abs(seen - depth) <= toleranceMm;
}

VertexNormals vertexNormals(const SceneMesh& mesh) {
    std::vector<Normal> normals(static_cast<std::size_t>(mesh.pointCount()));
    mesh.forEachTriangle([&](const Triangle& t) {
        const Vec3 area = areaVector2(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2]));
        for (const VertexId v : t) {
            normals[v].x += static_cast<float>(area.x);
            normals[v].y += static_cast<float>(area.y);
            normals[v].z += static_cast<float>(area.z);
        }
    });
    for (Normal& normal : normals) normal = toNormal(toVec3(normal));
    return normals;
}

Rendering render(std::span<const SceneSurface> surfaces, std::span<const VertexNormals> normals,
                 const BoundingBox& box, const View& view, int size) {
    Raster raster(box, view, size);
    for (std::size_t n = 0; n < surfaces.size(); ++n) raster.draw(surfaces[n], normals[n]);
    return raster.finish();
}

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
