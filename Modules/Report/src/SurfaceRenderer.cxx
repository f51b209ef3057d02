#include "SurfaceRenderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso {

namespace {

constexpr ReportColor kBack{214, 69, 65};
constexpr float kFarBehind = -std::numeric_limits<float>::infinity();

/// A corner as the view sees it: pixels, and mm towards the viewer.
struct Corner {
    double x = 0, y = 0, depth = 0;
};

/// A triangle as the view sees it.
struct ViewedFace {
    Corner a, b, c;
    double area;     ///< twice; positive: from its back, as y runs down
    double perArea;  ///< 1 / area

    ViewedFace(const Corner& first, const Corner& second, const Corner& third)
        : a(first),
          b(second),
          c(third),
          area((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)),
          perArea(1 / area) {}

    /// The weights of the corners at a place.
    std::array<double, 3> weights(double x, double y) const {
        const double u = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) * perArea;
        const double v = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) * perArea;
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

/// Points of a surface as a view sees them: finer pixels of the whole picture, and mm towards the
/// viewer from its middle.
using ViewedPoints = std::vector<std::array<float, 3>>;

std::vector<ViewedPoints> viewedPoints(std::span<const SceneSurface> surfaces, const Frame& frame,
                                       const View& view, const Style& style) {
    const Vec3 right = view.right();
    const double perMm = style.finer / frame.mmPerPixel;
    std::vector<ViewedPoints> viewed;
    for (const SceneSurface& surface : surfaces) {
        constexpr std::int64_t kGrain = 1 << 14;
        ViewedPoints& points = viewed.emplace_back(surface.mesh.pointCount());
        parallelForPieces(std::ssize(points), kGrain, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) {
                const Vec3 p = surface.mesh.point(static_cast<VertexId>(v)) - frame.middle;
                points[v] = {
                    static_cast<float>(style.finer * frame.width / 2.0 + perMm * dot(p, right)),
                    static_cast<float>(style.finer * frame.height / 2.0 - perMm * dot(p, view.up)),
                    static_cast<float>(dot(p, view.toViewer))};
            }
        });
    }
    return viewed;
}

/// Rows of a picture, in finer pixels: each shows the triangle nearest to the viewer. A pixel is
/// the mean of its finer ones; each triangle is shaded there once.
class Raster {
    static constexpr std::uint32_t kNobody = 0xFFFFFFFF;
    using Color = std::array<double, 3>;

public:
    /// \param points, normals  of each surface
    Raster(const Frame& frame, const View& view, const Style& style,
           std::span<const SceneSurface> surfaces, std::span<const ViewedPoints> points,
           std::span<const VertexNormals> normals)
        : surfaces_(surfaces),
          points_(points),
          normals_(normals),
          view_(view),
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
          depths_(static_cast<std::size_t>(width_) * rows_, kFarBehind),
          owners_(depths_.size(), kNobody) {}

    Rendering draw() {
        for (const SceneSurface& surface : surfaces_) cover(surface);
        Rendering result{width_ / style_.finer,
                         rows_ / style_.finer,
                         middle_,
                         mmPerPixel_ * style_.finer,
                         {},
                         {},
                         {}};
        for (int y = 0; y < result.height; ++y) {
            for (int x = 0; x < result.width; ++x) shadePixel(x, y, result);
        }
        return result;
    }

private:
    /// Triangles of one surface, among those of all.
    struct Part {
        const SceneSurface* surface;
        const ViewedPoints* points;
        const VertexNormals* normals;
        std::uint32_t first;
        bool drawsEdges;
    };
    /// Finer pixels of one pixel that show one triangle.
    struct Share {
        std::uint32_t owner;
        int count;
        double x, y;  ///< sums of their middles
    };

    ViewedFace viewed(const ViewedPoints& points, const Triangle& t) const {
        const auto corner = [&](VertexId v) {
            return Corner{points[v][0], double{points[v][1]} - top_, points[v][2]};
        };
        return {corner(t[0]), corner(t[1]), corner(t[2])};
    }

    double meanTrianglePixels(const SceneSurface& surface) const {
        const auto count =
            static_cast<double>(std::max<std::int64_t>(surface.mesh.triangleCount(), 1));
        return surfaceArea(surface.mesh) / count / (mmPerPixel_ * mmPerPixel_);
    }

    void cover(const SceneSurface& surface) {
        const std::vector<Triangle>& triangles = surface.mesh.lps().triangles;
        const std::uint32_t first = end_;
        end_ += static_cast<std::uint32_t>(triangles.size());
        const ViewedPoints& points = points_[parts_.size()];
        parts_.push_back(
            {&surface, &points, &normals_[parts_.size()], first,
             style_.drawsEdges ? *style_.drawsEdges : meanTrianglePixels(surface) > 60});
        surface.mesh.forEachTriangle([&](const Triangle& t) {
            const auto y = std::minmax({points[t[0]][1], points[t[1]][1], points[t[2]][1]});
            if (y.second < static_cast<float>(top_) || y.first > static_cast<float>(top_ + rows_))
                return;
            const ViewedFace face = viewed(points, t);
            if (face.area == 0) return;  // edge-on
            const auto across = PixelRange::between(face.a.x, face.b.x, face.c.x, width_);
            const auto down = PixelRange::between(face.a.y, face.b.y, face.c.y, rows_);
            if (across.first > across.last || down.first > down.last) return;
            cover(face, across, down, first + static_cast<std::uint32_t>(&t - triangles.data()));
        });
    }

    void cover(const ViewedFace& face, const PixelRange& across, const PixelRange& down,
               std::uint32_t owner) {
        for (int y = down.first; y <= down.last; ++y) {
            PixelRange row = across;
            row.cut(face, face.a, face.b, y);
            row.cut(face, face.b, face.c, y);
            row.cut(face, face.c, face.a, y);
            for (int x = row.first; x <= row.last; ++x) {
                const auto [u, v, w] = face.weights(x + 0.5, y + 0.5);
                if (u < 0 || v < 0 || w < 0) continue;
                const auto depth =
                    static_cast<float>(u * face.a.depth + v * face.b.depth + w * face.c.depth);
                const std::size_t n = static_cast<std::size_t>(y) * width_ + x;
                if (!(depth > depths_[n])) continue;
                depths_[n] = depth;
                owners_[n] = owner;
            }
        }
    }

    /// Calls body(n, x, y) for the finer pixels of a pixel that show a triangle.
    template <class Body>
    void forEachCovered(int x, int y, const Body& body) const {
        const int finer = style_.finer;
        for (int dy = y * finer; dy < (y + 1) * finer; ++dy) {
            for (int dx = x * finer; dx < (x + 1) * finer; ++dx) {
                const std::size_t n = static_cast<std::size_t>(dy) * width_ + dx;
                if (owners_[n] != kNobody) body(n, dx + 0.5, dy + 0.5);
            }
        }
    }

    void shadePixel(int x, int y, Rendering& result) {
        const int all = style_.finer * style_.finer;
        int covered = 0;
        float depth = kFarBehind;
        shares_.clear();
        forEachCovered(x, y, [&](std::size_t n, double px, double py) {
            ++covered;
            depth = std::max(depth, depths_[n]);
            auto share = std::ranges::find(shares_, owners_[n], &Share::owner);
            if (share == shares_.end()) share = shares_.insert(share, {owners_[n], 0, 0, 0});
            ++share->count;
            share->x += px;
            share->y += py;
        });
        Color sum{};
        for (const Share& share : shares_) addColor(share, x, y, sum);
        ReportColor color;
        for (std::size_t i = 0; i < color.size(); ++i) {
            const double mean = (sum[i] + (all - covered) * style_.ground[i]) / all;
            color[i] = static_cast<std::uint8_t>(mean + 0.5);
        }
        result.colors.push_back(color);
        result.opacity.push_back(static_cast<std::uint8_t>((255 * covered + all / 2) / all));
        result.depthMm.push_back(depth);
    }

    /// Adds the color of a triangle, times its share of a pixel.
    void addColor(const Share& share, int x, int y, Color& sum) const {
        const auto after = std::upper_bound(
            parts_.begin(), parts_.end(), share.owner,
            [](std::uint32_t owner, const Part& part) { return owner < part.first; });
        const Part& part = *std::prev(after);
        const SceneSurface& surface = *part.surface;
        const Triangle& t = surface.mesh.lps().triangles[share.owner - part.first];
        const ViewedFace face = viewed(*part.points, t);
        const auto [u, v, w] = face.weights(share.x / share.count, share.y / share.count);
        Vec3 normal;
        if (style_.isFlat) {
            normal = flatNormal(face.a, face.b, face.c);
        } else {
            const auto at = [&](int n) { return toVec3((*part.normals)[t[n]]); };
            normal = u * at(0) + v * at(1) + w * at(2);
        }
        double value = 0;
        if (const auto& values = surface.valuesMm; !values.empty()) {
            value = u * values[t[0]] + v * values[t[1]] + w * values[t[2]];
        }
        int edges = 0;
        if (part.drawsEdges) {
            const double near = style_.halfEdge * longestEdge(face) / std::abs(face.area);
            forEachCovered(x, y, [&](std::size_t n, double px, double py) {
                if (owners_[n] != share.owner) return;
                edges += std::ranges::min(face.weights(px, py)) < near ? 1 : 0;
            });
        }
        const bool isBack = face.area > 0;
        if (edges > 0) add(edges, shade(surface, normal, value, isBack, true), sum);
        if (edges < share.count) {
            add(share.count - edges, shade(surface, normal, value, isBack, false), sum);
        }
    }
    static void add(int times, const Color& color, Color& sum) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += times * color[i];
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

    Color shade(const SceneSurface& surface, Vec3 normal, double value, bool isBack,
                bool isEdge) const {
        normal = normalized(normal);
        if (dot(normal, view_.toViewer) < 0) normal = -normal;
        ReportColor color = surface.color;
        if (!surface.valuesMm.empty()) color = viridis(value / surface.largestValueMm);
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
        Color result;
        for (std::size_t i = 0; i < result.size(); ++i) {
            result[i] = std::min(255.0, color[i] * light + shine);
        }
        return result;
    }

    std::span<const SceneSurface> surfaces_;
    std::span<const ViewedPoints> points_;
    std::span<const VertexNormals> normals_;
    const View& view_;
    const Style& style_;
    Vec3 right_;
    int width_, height_, top_, rows_;  ///< finer pixels
    Vec3 middle_, light_, highlight_;
    double mmPerPixel_;
    std::vector<float> depths_;
    std::vector<std::uint32_t> owners_;
    std::vector<Part> parts_;
    std::uint32_t end_ = 0;      ///< triangles of all parts
    std::vector<Share> shares_;  ///< of one pixel
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
                 const BoundingBox& box, const View& view, int size,
                 std::optional<bool> drawsEdges) {
    const Vec3 extent = box.size();
    const Style style{.drawsEdges = drawsEdges};
    const double mmPerPixel =
        1.06 * std::max({extent.x, extent.y, extent.z, 1e-9}) / (size * style.finer) * style.finer;
    const Frame frame{0.5 * (box.minimum + box.maximum), mmPerPixel, size, size, 0, size};
    const std::vector<ViewedPoints> points = viewedPoints(surfaces, frame, view, style);
    return Raster(frame, view, style, surfaces, points, normals).draw();
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
    // a large picture is seen smaller than its pixels
    constexpr int kLarge = 2'000'000;
    Style style{.finer = options.width * options.height > kLarge ? 2 : 3,
                .ground = options.background.value_or(kBlack),
                .isFlat = options.shading != Shading::Smooth,
                .drawsEdges = options.shading == Shading::Edges,
                .isForPrint = true};
    style.halfEdge = style.finer * std::max(options.width, options.height) / 4000.0;

    const std::vector<ViewedPoints> points = viewedPoints(surfaces, whole, view, style);
    constexpr int kFinerPixels = 500'000;  // at a time, by each thread: few enough for its cache
    const int rows = std::max(1, kFinerPixels / (style.finer * style.finer * options.width));
    std::vector<Rendering> bands((options.height + rows - 1) / rows);
    parallelForPieces(std::ssize(bands), 1, [&](std::int64_t begin, std::int64_t) {
        Frame band = whole;
        band.top = static_cast<int>(begin) * rows;
        band.rows = std::min(rows, options.height - band.top);
        bands[begin] = Raster(band, view, style, surfaces, points, normals).draw();
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
