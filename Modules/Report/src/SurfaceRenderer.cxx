#include "SurfaceRenderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace adaptiso
