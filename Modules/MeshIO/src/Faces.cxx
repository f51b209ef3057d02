#include "Faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "Bytes.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/PolygonTriangulation.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::meshio {
namespace {

using Indices = std::array<std::uint32_t, 3>;

[[noreturn]] void refuse(std::int64_t number, const std::string& fault) {
    unsupported("polygon " + std::to_string(number) + " " + fault,
                "mend it in the program that made it, or cut it into triangles there");
}

/// Cuts polygons of a mesh, one after the other.
class PolygonCutter {
public:
    PolygonCutter(const std::vector<Vec3>& points, bool keepsFaults)
        : points_(points), keepsFaults_(keepsFaults) {}

    /// The triangles of a polygon, as indices of its corners.
    std::vector<Indices> cut(std::int64_t number, std::span<const VertexId> corners) {
        requirePlausible(number, corners);
        if (!areThere(number, corners)) return fan(corners.size());
        std::vector<Indices> triangles;
        if (flatten(corners)) triangles = triangulatePolygon(flat_);
        if (triangles.empty()) {
            if (!areOnALine() && crossing_++ == 0) firstCrossing_ = number;
            triangles = fan(corners.size());
        }
        return triangles;
    }

    /// Polygons that cross themselves, or have parts without width, and the first of them.
    std::int64_t crossing() const { return crossing_; }
    std::int64_t firstCrossing() const { return firstCrossing_; }

    /// The largest distance of a corner from its polygon's plane, but for that of rounding.
    double largestDistance() const { return largestDistance_; }

private:
    /// They lie on a line, but for rounding. \pre flatten()
    bool areOnALine() const {
        constexpr double kRounding = 3e-5;  // of coordinates with five digits
        Vec3 farthest;
        for (const Vec3& p : local_) {
            if (squaredNorm(p) > squaredNorm(farthest)) farthest = p;
        }
        return std::ranges::all_of(local_, [&](const Vec3& p) {
            return norm(cross(farthest, p)) <= kRounding * squaredNorm(farthest);
        });
    }

    static void requirePlausible(std::int64_t number, std::span<const VertexId> corners) {
        constexpr std::size_t kMostCorners = std::size_t{1} << 14;  // time grows with the square
        if (corners.size() > kMostCorners) {
            refuse(number, "has " + std::to_string(corners.size()) + " corners, must have " +
                               std::to_string(kMostCorners) + " at most");
        }
    }

    /// Whether all corners name points with finite coordinates; what is not finite is reported by
    /// decodeMesh().
    bool areThere(std::int64_t number, std::span<const VertexId> corners) const {
        for (const VertexId corner : corners) {
            if (corner >= 0 && corner < std::ssize(points_)) continue;
            if (keepsFaults_) return false;
            refuse(number, "uses point " + std::to_string(corner) + ", must be 0 to " +
                               std::to_string(std::ssize(points_) - 1));
        }
        return std::ranges::all_of(corners, [&](VertexId corner) {
            const Vec3& p = points_[static_cast<std::size_t>(corner)];
            return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        });
    }

    static std::vector<Indices> fan(std::size_t size) {
        std::vector<Indices> triangles;
        for (std::uint32_t i = 2; i < size; ++i) triangles.push_back({0, i - 1, i});
        return triangles;
    }

    /// Sets flat_ to the polygon in the plane of best fit, by Newell's normal. Exact where the
    /// plane is one of the axes, so that corners on a line stay on it. \return  it has an area
    bool flatten(std::span<const VertexId> corners) {
        const Vec3 origin = points_[static_cast<std::size_t>(corners.front())];
        local_.clear();
        double extent = 0, magnitude = 0;
        for (const VertexId corner : corners) {
            const Vec3& p = points_[static_cast<std::size_t>(corner)];
            local_.push_back(p - origin);
            for (int axis = 0; axis < 3; ++axis) {
                extent = std::max(extent, std::abs(local_.back()[axis]));
                magnitude = std::max(magnitude, std::abs(p[axis]));
            }
        }
        if (!(extent > 0) || !std::isfinite(extent)) return false;
        // By a power of 2: exact, and products of the very large and small stay in range.
        const int exponent = std::ilogb(extent);
        Vec3 normal, sum;
        for (Vec3& p : local_)
            p = {scaled(p.x, exponent), scaled(p.y, exponent), scaled(p.z, exponent)};
        for (std::size_t i = 0; i < local_.size(); ++i) {
            normal += cross(local_[i], local_[(i + 1) % local_.size()]);
            sum += local_[i];
        }
        if (!(squaredNorm(normal) > 0)) return false;
        normal = normalized(normal);
        int across = 0;  // the axis that leans the least on the normal
        for (int axis = 1; axis < 3; ++axis) {
            if (std::abs(normal[axis]) < std::abs(normal[across])) across = axis;
        }
        Vec3 axis;
        axis[across] = 1;
        const Vec3 u = normalized(cross(axis, normal)), v = cross(normal, u);
        flat_.clear();
        double distance = 0;
        const double mean = dot(normal, sum) / static_cast<double>(local_.size());
        for (const Vec3& p : local_) {
            flat_.push_back({dot(u, p), dot(v, p)});
            distance = std::max(distance, std::abs(dot(normal, p) - mean));
        }
        constexpr double kRounding = 1e-6;  // of coordinates kept as float, with a margin
        distance = std::scalbn(distance, exponent);
        if (distance > kRounding * magnitude)
            largestDistance_ = std::max(largestDistance_, distance);
        return true;
    }

    static double scaled(double value, int exponent) { return std::scalbn(value, -exponent); }

    const std::vector<Vec3>& points_;
    bool keepsFaults_;
    double largestDistance_ = 0;
    std::int64_t crossing_ = 0, firstCrossing_ = 0;
    std::vector<Vec3> local_;
    std::vector<Point2> flat_;
};

}  // namespace

void Faces::add(std::span<const VertexId> corners) {
    const std::size_t begin = corners_.size();
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const bool isRepeated =
            corners.size() > 3 && corners[n] == corners[(n + 1) % corners.size()];
        if (!isRepeated) corners_.push_back(corners[n]);
    }
    const std::size_t size = corners_.size() - begin;
    if (size > 3) {
        polygons_.push_back({count_, triangles_.size(), begin, size});
    } else {
        if (size == 3) {
            triangles_.push_back({corners_[begin], corners_[begin + 1], corners_[begin + 2]});
        } else {
            ++lines_;
        }
        corners_.resize(begin);
    }
    ++count_;
}

void Faces::addStrip(std::span<const VertexId> corners) {
    if (corners.size() < 3) {
        malformed("strip " + std::to_string(count_) + " has " + std::to_string(corners.size()) +
                  " corners");
    }
    const std::size_t before = triangles_.size();
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        const std::size_t odd = i % 2;
        const VertexId a = corners[i + odd], b = corners[i + 1 - odd], c = corners[i + 2];
        if (a != b && b != c && c != a) triangles_.push_back({a, b, c});
    }
    ++count_;
    ++strips_;
    stripTriangles_ += static_cast<std::int64_t>(triangles_.size() - before);
}

void Faces::moveTo(MeshFile& file, bool keepsFaults, std::int64_t lines) && {
    noteLinesLeftOut(lines + lines_, file.warnings);
    if (strips_ > 0) {
        file.warnings.push_back(
            {"polygons-cut", counted(strips_, "triangle strip was", "triangle strips were") +
                                 " cut into " + counted(stripTriangles_, "triangle")});
    }
    if (polygons_.empty()) {
        file.mesh.triangles = std::move(triangles_);
        return;
    }
    PolygonCutter cutter(file.mesh.points, keepsFaults);
    std::vector<Triangle>& merged = file.mesh.triangles;
    merged.clear();
    merged.reserve(triangles_.size() + corners_.size() - 2 * polygons_.size());
    auto next = triangles_.begin();
    for (const Polygon& polygon : polygons_) {
        const auto own = triangles_.begin() + static_cast<std::ptrdiff_t>(polygon.triangle);
        merged.insert(merged.end(), next, own);
        next = own;
        const auto corners = std::span(corners_).subspan(polygon.corner, polygon.size);
        for (const auto& [a, b, c] : cutter.cut(polygon.number, corners)) {
            const Triangle t{corners[a], corners[b], corners[c]};
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) merged.push_back(t);
        }
    }
    const std::size_t made = merged.size() - static_cast<std::size_t>(next - triangles_.begin());
    merged.insert(merged.end(), next, triangles_.end());
    std::string text = counted(std::ssize(polygons_), "polygon was", "polygons were") +
                       " cut into " + counted(static_cast<std::int64_t>(made), "triangle");
    if (cutter.largestDistance() > 0) {
        text += "; corners lie up to " + formatShort(cutter.largestDistance()) +
                " mm off the plane of their polygon";
    }
    file.warnings.push_back({"polygons-cut", std::move(text)});
    if (cutter.crossing() > 0) {
        file.warnings.push_back(
            {"polygons-cross",
             counted(cutter.crossing(), "polygon crosses itself or has a part without width",
                     "polygons cross themselves or have parts without width") +
                 "; first: polygon " + std::to_string(cutter.firstCrossing())});
    }
}

void noteLinesLeftOut(std::int64_t count, std::vector<Warning>& warnings) {
    if (count == 0) return;
    warnings.push_back({"lines-left-out", counted(count, "line or point", "lines or points") +
                                              " beside the polygons of the surface " +
                                              (count == 1 ? "was" : "were") + " left out"});
}

}  // namespace adaptiso::meshio
