#include "SurfaceRenderer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso {

namespace {

constexpr ReportColor kBack{214, 69, 65};
constexpr double kFarBehind = -std::numeric_limits<double>::infinity();

/// A corner as the view sees it: pixels, and mm towards the viewer.
struct Corner {
    double x = 0, y = 0, depth = 0;
};

/// A triangle as the view sees it.
struct ViewedFace {
    Corner a, b, c;
    double area = 0;  ///< twice; positive: from its back, as y runs down

    ViewedFace() = default;
    ViewedFace(const Corner& first, const Corner& second, const Corner& third)
        : a(first),
          b(second),
          c(third),
          area((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) {}

    /// The weights of the corners at the middle of a pixel.
    std::array<double, 3> weights(int x, int y) const {
        const double px = x + 0.5, py = y + 0.5;
        const double u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
        const double v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
        return {u, v, 1 - u - v};
    }
};

/// First and last of some pixels of a row or a column.
struct PixelRange {
    int first, last;

    /// Those whose middles lie between the least and the largest of three places.
    static PixelRange between(double p, double q, double r, int size) {
        return {std::max(0, static_cast<int>(std::ceil(std::min({p, q, r}) - 0.5))),
                std::min(size - 1, static_cast<int>(std::floor(std::max({p, q, r}) - 0.5)))};
    }
    void add(const PixelRange& other) {
        first = std::min(first, other.first);
        last = std::max(last, other.last);
    }
    /// Less what lies beyond an edge of a face, but for a pixel's width.
    void cut(const ViewedFace& face, const Corner& from, const Corner& to, int y) {
        constexpr double kLevel = 1e-6;  // such an edge meets the row too far off to tell where
        const double rise = to.y - from.y;
        if (!(std::abs(rise) > kLevel)) return;
        const double at = from.x + (to.x - from.x) * ((y + 0.5 - from.y) / rise);
        if ((rise > 0) == (face.area > 0)) {
            if (at - 0.5 < last - 1) last = static_cast<int>(std::max(at - 0.5, first - 2.0)) + 1;
        } else if (at - 0.5 > first + 1) {
            first = static_cast<int>(std::min(at - 0.5, last + 2.0)) - 1;
        }
    }
};

/// How surfaces are drawn.
struct Style {
    int finer = 2;  ///< pixels are drawn this much finer, then averaged
    ReportColor ground = kWhite;
    bool isFlat = false;               ///< each triangle by its own normal
    std::optional<bool> drawsEdges{};  ///< default: where triangles are large enough
    double halfEdge = 0.7;             ///< width of edges, finer pixels
    bool isForPrint = false;           ///< softer light, a highlight, darker edges
};

/// Where a picture, or rows of it, lies.
struct Frame {
    Vec3 middle;  ///< of the whole picture
    double mmPerPixel = 1;
    int width = 0, height = 0;  ///< of the whole picture
    int top = 0, rows = 0;      ///< drawn
};

/// Rows of a picture before they are averaged down.
class Raster {
    static constexpr std::uint32_t kNobody = 0xFFFFFFFF;

public:
    Raster(const Frame& frame, const View& view, const Style& style)
        : view_(view),
          style_(style),
          right_(view.right()),
          width_(frame.width * style.finer),
          height_(frame.height * style.finer),
          top_(frame.top * style.finer),
          rows_(frame.rows * style.finer),
          middle_(frame.middle),
          light_(normalized(0.9 * view.toViewer + 0.45 * view.up - 0.35 * right_)),
          highlight_(normalized(light_ + view.toViewer)),
          mmPerPixel_(frame.mmPerPixel / style.finer),
          colors_(static_cast<std::size_t>(width_) * rows_, style.ground),
          depths_(colors_.size(), kFarBehind),
          owners_(colors_.size(), kNobody) {}

    /// Finds the triangle of every pixel, then shades each pixel once.
    void draw(const SceneSurface& surface, const VertexNormals& normals) {
        surface_ = &surface;
        normals_ = &normals;
        drawsEdges_ = style_.drawsEdges ? *style_.drawsEdges : meanTrianglePixels() > 60;
        PixelRange columns{width_, -1}, rows{rows_, -1};
        surface.mesh.forEachTriangle([&](const Triangle& t) {
            const ViewedFace face(corner(t[0]), corner(t[1]), corner(t[2]));
            if (face.area == 0) return;  // edge-on
            const auto across = PixelRange::between(face.a.x, face.b.x, face.c.x, width_);
            const auto down = PixelRange::between(face.a.y, face.b.y, face.c.y, rows_);
            if (across.first > across.last || down.first > down.last) return;
            columns.add(across);
            rows.add(down);
            cover(face, across, down,
                  static_cast<std::uint32_t>(&t - surface.mesh.lps().triangles.data()));
        });
        shadeCovered(columns, rows);
    }

    Rendering finish() const {
        Rendering result{width_ / style_.finer,
                         rows_ / style_.finer,
                         middle_,
                         mmPerPixel_ * style_.finer,
                         {},
                         {},
                         {}};
        for (int y = 0; y < result.height; ++y) {
            for (int x = 0; x < result.width; ++x) averagePixel(x, y, result);
        }
        return result;
    }

private:
    Corner corner(VertexId v) const {
        const Vec3 p = surface_->mesh.point(v) - middle_;
        return {width_ / 2.0 + dot(p, right_) / mmPerPixel_,
                height_ / 2.0 - dot(p, view_.up) / mmPerPixel_ - top_, dot(p, view_.toViewer)};
    }

    double meanTrianglePixels() const {
        const auto count =
            static_cast<double>(std::max<std::int64_t>(surface_->mesh.triangleCount(), 1));
        return surfaceArea(surface_->mesh) / count / (mmPerPixel_ * mmPerPixel_);
    }

    std::size_t pixel(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

    void cover(const ViewedFace& face, const PixelRange& across, const PixelRange& down,
               std::uint32_t triangle) {
        for (int y = down.first; y <= down.last; ++y) {
            PixelRange row = across;
            row.cut(face, face.a, face.b, y);
            row.cut(face, face.b, face.c, y);
            row.cut(face, face.c, face.a, y);
            for (int x = row.first; x <= row.last; ++x) {
                const auto [u, v, w] = face.weights(x, y);
                if (u < 0 || v < 0 || w < 0) continue;
                const double depth = u * face.a.depth + v * face.b.depth + w * face.c.depth;
                const std::size_t n = pixel(x, y);
                if (!(depth > depths_[n])) continue;
                depths_[n] = depth;
                owners_[n] = triangle;
            }
        }
    }

    void shadeCovered(const PixelRange& columns, const PixelRange& rows) {
        const std::vector<Triangle>& triangles = surface_->mesh.lps().triangles;
        const std::span<const double> values = surface_->valuesMm;
        std::uint32_t last = kNobody;
        ViewedFace face;
        Vec3 flat;
        double edgePart = 0;
        for (int y = rows.first; y <= rows.last; ++y) {
            for (int x = columns.first; x <= columns.last; ++x) {
                std::uint32_t& owner = owners_[pixel(x, y)];
                if (owner == kNobody) continue;
                const Triangle& t = triangles[owner];
                if (owner != last) {
                    last = owner;
                    face = ViewedFace(corner(t[0]), corner(t[1]), corner(t[2]));
                    if (style_.isFlat) flat = flatNormal(face.a, face.b, face.c);
                    edgePart = style_.halfEdge * longestEdge(face) / std::abs(face.area);
                }
                owner = kNobody;
                const auto [u, v, w] = face.weights(x, y);
                const auto normal = [&](int n) { return toVec3((*normals_)[t[n]]); };
                const auto value = [&](int n) { return values.empty() ? 0 : values[t[n]]; };
                const bool isEdge = drawsEdges_ && std::min({u, v, w}) < edgePart;
                colors_[pixel(x, y)] =
                    shade(style_.isFlat ? flat : u * normal(0) + v * normal(1) + w * normal(2),
                          u * value(0) + v * value(1) + w * value(2), face.area > 0, isEdge);
            }
        }
    }

    static double longestEdge(const ViewedFace& f) {
        return std::max({std::hypot(f.b.x - f.a.x, f.b.y - f.a.y),
                         std::hypot(f.c.x - f.b.x, f.c.y - f.b.y),
                         std::hypot(f.a.x - f.c.x, f.a.y - f.c.y)});
    }

    Vec3 flatNormal(const Corner& a, const Corner& b, const Corner& c) const {
        const auto inSpace = [this](const Corner& p) {
            return mmPerPixel_ * p.x * right_ - mmPerPixel_ * p.y * view_.up +
                   p.depth * view_.toViewer;
        };
        return areaVector2(inSpace(a), inSpace(b), inSpace(c));
    }

    ReportColor shade(Vec3 normal, double value, bool isBack, bool isEdge) const {
        normal = normalized(normal);
        if (dot(normal, view_.toViewer) < 0) normal = -normal;
        ReportColor color = surface_->color;
        if (!surface_->valuesMm.empty()) color = viridis(value / surface_->largestValueMm);
        if (isBack) color = kBack;
        const double lit = std::max(0.0, dot(normal, light_));
        double light = 0.45 + 0.55 * lit, shine = 0;
        if (style_.isForPrint) {
            light = 0.36 + 0.55 * lit + 0.09 * dot(normal, view_.toViewer);
            const double gleam = std::max(0.0, dot(normal, highlight_)), square = gleam * gleam;
            const double eighth = square * square * square * square;
            shine = 16 * eighth * eighth * eighth;
        }
        if (isEdge) light *= style_.isForPrint ? 0.45 : 0.72;
        for (std::uint8_t& channel : color) {
            channel =
                static_cast<std::uint8_t>(std::lround(std::min(255.0, channel * light + shine)));
        }
        return color;
    }

    void averagePixel(int x, int y, Rendering& result) const {
        std::array<int, 3> sum{};
        int covered = 0;
        double depth = kFarBehind;
        const int finer = style_.finer, samples = finer * finer;
        for (int dy = 0; dy < finer; ++dy) {
            for (int dx = 0; dx < finer; ++dx) {
                const std::size_t n =
                    static_cast<std::size_t>(y * finer + dy) * width_ + x * finer + dx;
                for (std::size_t i = 0; i < 3; ++i) sum[i] += colors_[n][i];
                depth = std::max(depth, depths_[n]);
                covered += int{depths_[n] > kFarBehind};
            }
        }
        const auto mean = [samples](int of) {
            return static_cast<std::uint8_t>((of + samples / 2) / samples);
        };
        result.colors.push_back({mean(sum[0]), mean(sum[1]), mean(sum[2])});
        result.opacity.push_back(mean(255 * covered));
        result.depthMm.push_back(depth);
    }

    const SceneSurface* surface_ = nullptr;  ///< that is drawn
    const VertexNormals* normals_ = nullptr;
    const View& view_;
    const Style& style_;
    Vec3 right_;
    int width_, height_, top_, rows_;  ///< finer pixels
    Vec3 middle_, light_, highlight_;
    double mmPerPixel_;
    bool drawsEdges_ = false;
    std::vector<ReportColor> colors_;
    std::vector<double> depths_;
    std::vector<std::uint32_t> owners_;  ///< triangles of `surface_` that are not shaded yet
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
    return {width / 2.0 + dot(d, view.right()) / mmPerPixel,
            height / 2.0 - dot(d, view.up) / mmPerPixel};
}

bool Rendering::isSeen(const Vec3& p, const View& view, double toleranceMm) const {
    const Pixel at = toPixel(p, view);
    if (!(at.x >= 0 && at.y >= 0 && at.x < width && at.y < height)) return false;
    const double depth = dot(p - middle, view.toViewer);
    const double seen =
        depthMm[static_cast<std::size_t>(at.y) * width + static_cast<std::size_t>(at.x)];
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
    const Vec3 extent = box.size();
    const Style style;
    const double mmPerPixel =
        1.06 * std::max({extent.x, extent.y, extent.z, 1e-9}) / (size * style.finer) * style.finer;
    Raster raster({0.5 * (box.minimum + box.maximum), mmPerPixel, size, size, 0, size}, view,
                  style);
    for (std::size_t n = 0; n < surfaces.size(); ++n) raster.draw(surfaces[n], normals[n]);
    return raster.finish();
}

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

/// Surfaces from six sides, below a line of title.
void drawSixSides(Canvas& canvas, const Scene& scene, std::span<const SceneSurface> surfaces,
                  const BoundingBox& box) {
    std::vector<VertexNormals> normals(surfaces.size());
    parallelForPieces(std::ssize(surfaces), 1, [&](std::int64_t begin, std::int64_t) {
        normals[begin] = vertexNormals(surfaces[begin].mesh);
    });
    std::array<Rendering, 6> renderings;
    parallelForPieces(6, 1, [&](std::int64_t begin, std::int64_t) {
        renderings[begin] = render(surfaces, normals, box, sixViews()[begin], kViewSize);
    });
    const double toleranceMm = 0.02 * norm(box.size());
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
        canvas.text({left + kViewSize / 2.0, base}, view.name, 14, kInk, Anchor::Middle);
        canvas.text({left + 30.0, base}, view.leftSide, 14, kFaint);
        canvas.text({left + kViewSize - 30.0, base}, view.rightSide, 14, kFaint, Anchor::Right);
    }
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

namespace {

View viewFrom(double azimuthDeg, double elevationDeg) {
    constexpr double kRadian = std::numbers::pi / 180;
    const double sa = portable::sin(azimuthDeg * kRadian), ca = portable::cos(azimuthDeg * kRadian),
                 se = portable::sin(elevationDeg * kRadian),
                 ce = portable::cos(elevationDeg * kRadian);
    return {"", {-sa * ce, ca * ce, se}, {sa * se, -ca * se, ce}, "", ""};
}

/// The frame that the surfaces fill but for a margin.
Frame tightFrame(std::span<const SceneSurface> surfaces, const View& view, int width, int height) {
    constexpr double kFilled = 0.94;
    auto box = BoundingBox::empty();  // right, up, towards the viewer
    for (const SceneSurface& surface : surfaces) {
        surface.mesh.forEachTriangle([&](const Triangle& t) {
            for (const VertexId v : t) {
                const Vec3 p = surface.mesh.point(v);
                box.add(Vec3{dot(p, view.right()), dot(p, view.up), dot(p, view.toViewer)});
            }
        });
    }
    if (box.isEmpty()) box = {{-1, -1, -1}, {1, 1, 1}};
    const Vec3 middle = 0.5 * (box.minimum + box.maximum), extent = box.size();
    return {middle.x * view.right() + middle.y * view.up + middle.z * view.toViewer,
            std::max({extent.x / width, extent.y / height, 1e-12}) / kFilled, width, height};
}

/// The normals that the mesh has, else those of vertexNormals().
VertexNormals normalsToShow(const SceneMesh& mesh) {
    const std::vector<Normal>& own = mesh.lps().normals;
    if (std::ssize(own) != mesh.pointCount()) return vertexNormals(mesh);
    VertexNormals normals(own.size());
    std::transform(own.begin(), own.end(), normals.begin(), [](const Normal& n) {
        return Normal{-n.x, -n.y, n.z};
    });
    return normals;
}

}  // namespace

Picture viewPicture(std::vector<SceneSurface> surfaces, const std::string& name,
                    const ViewOptions& options) {
    if (options.color) {
        for (SceneSurface& surface : surfaces) {
            surface.color = *options.color;
            surface.valuesMm = {};
        }
    }
    std::vector<VertexNormals> normals;
    for (const SceneSurface& surface : surfaces) normals.push_back(normalsToShow(surface.mesh));
    const View view = viewFrom(options.azimuthDeg, options.elevationDeg);
    const Frame whole = tightFrame(surfaces, view, options.width, options.height);
    Style style{.finer = 3,
                .ground = options.background.value_or(kBlack),
                .isFlat = options.shading != Shading::Smooth,
                .drawsEdges = options.shading == Shading::Edges,
                .isForPrint = true};
    style.halfEdge = style.finer * std::max(options.width, options.height) / 4000.0;

    constexpr int kFinerPixels = 4'000'000;  // at a time, by each thread
    const int rows = std::max(1, kFinerPixels / (style.finer * style.finer * options.width));
    std::vector<Rendering> bands((options.height + rows - 1) / rows);
    parallelForPieces(std::ssize(bands), 1, [&](std::int64_t begin, std::int64_t) {
        Frame band = whole;
        band.top = static_cast<int>(begin) * rows;
        band.rows = std::min(rows, options.height - band.top);
        Raster raster(band, view, style);
        for (std::size_t n = 0; n < surfaces.size(); ++n) raster.draw(surfaces[n], normals[n]);
        bands[begin] = raster.finish();
        bands[begin].depthMm = {};
    });
    std::vector<ReportColor> colors;
    std::vector<std::uint8_t> opacity;
    for (Rendering& band : bands) {
        colors.insert(colors.end(), band.colors.begin(), band.colors.end());
        opacity.insert(opacity.end(), band.opacity.begin(), band.opacity.end());
        band = {};
    }
    Canvas canvas(options.width, options.height, options.background);
    if (options.background) {
        canvas.image(0, 0, options.width, options.height, colors);
    } else {
        canvas.image(colors, opacity);
    }
    const std::string what = surfaces.size() == 1 ? surfaces[0].name : "all surfaces";
    return {name,         "View of " + what, "The surface of " + what + " from one side.",
            canvas.png(), canvas.width(),    canvas.height()};
}

}  // namespace adaptiso
