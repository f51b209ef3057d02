#include "adaptiso/MeshQuality/Shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "Percentile.h"
#include "Triangles.h"

namespace adaptiso {

namespace {

/// Gathers values with the numbers of the triangles that they belong to.
class SpreadMeter {
public:
    explicit SpreadMeter(std::size_t room) { values_.reserve(room); }

    void add(double value, std::int64_t triangle) {
        values_.push_back(value);
        sum_ += value;
        if (value < spread_.minimum || spread_.triangleOfMinimum < 0) {
            spread_.minimum = value;
            spread_.triangleOfMinimum = triangle;
        }
        if (value > spread_.maximum || spread_.triangleOfMaximum < 0) {
            spread_.maximum = value;
            spread_.triangleOfMaximum = triangle;
        }
    }

    Spread spread() {
        if (values_.empty()) return spread_;
        spread_.mean = sum_ / static_cast<double>(values_.size());
        spread_.p1 = percentile(values_, 0.01);
        spread_.p5 = percentile(values_, 0.05);
        spread_.median = percentile(values_, 0.5);
        spread_.p99 = percentile(values_, 0.99);
        return spread_;
    }

private:
    Spread spread_;
    double sum_ = 0;
    std::vector<double> values_;
};

/// The angle opposite the shortest side, degrees. \pre edges[n] is opposite corner n
double smallestAngleDeg(const Corners& t, const std::array<double, 3>& edges, double area2) {
    const auto n = std::min_element(edges.begin(), edges.end()) - edges.begin();
    const Vec3 &apex = t[n], &p = t[(n + 1) % 3], &q = t[(n + 2) % 3];
    return std::atan2(area2, dot(p - apex, q - apex)) * (180 / std::numbers::pi);
}

}  // namespace

ShapeReport measureShape(const TriangleMesh& mesh) {
    requireIndices(mesh, "measureShape");
    const std::size_t room = mesh.triangles.size();
    SpreadMeter angles(room), aspects(room), lengths(3 * room);
    ShapeReport report;
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        const auto& [a, b, c] = mesh.triangles[n];
        const Corners t = cornersOf(mesh, n);
        if (a == b || b == c || c == a || !areFinite(t)) continue;
        ++report.triangles;
        const std::array<double, 3> edges{norm(t[2] - t[1]), norm(t[0] - t[2]), norm(t[1] - t[0])};
        const double area2 = norm(areaVector2(t[0], t[1], t[2]));
        angles.add(smallestAngleDeg(t, edges, area2), n);
        const double longest = *std::max_element(edges.begin(), edges.end());
        aspects.add(area2 > 0 ? longest * (edges[0] + edges[1] + edges[2]) /
                                    (2 * std::numbers::sqrt3 * area2)
                              : std::numeric_limits<double>::infinity(),
                    n);
        for (const double edge : edges) lengths.add(edge, n);
    }
    report.angleDeg = angles.spread();
    report.aspectRatio = aspects.spread();
    report.edgeMm = lengths.spread();
    return report;
}

namespace {

SizeVerdict judge(const Vec3& extent, const SizeLimits& limits) {
    const auto [smallest, largest] = std::minmax({extent.x, extent.y, extent.z});
    if (largest > limits.maxLargestExtentMm) return SizeVerdict::TooLarge;
    const bool isLargeEnough =
        smallest >= limits.minExtentMm && largest >= limits.minLargestExtentMm;
    return isLargeEnough ? SizeVerdict::Plausible : SizeVerdict::TooSmall;
}

}  // namespace

std::string_view toString(LengthUnit unit) {
    constexpr const char* kWords[] = {"metres", "centimetres", "micrometres"};
    return kWords[static_cast<std::size_t>(unit)];
}

SizeReport judgeSize(const TriangleMesh& mesh, const SizeLimits& limits) {
    requireIndices(mesh, "judgeSize");
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        const Corners corners = cornersOf(mesh, n);
        if (!areFinite(corners)) continue;
        for (const Vec3& p : corners) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], p[axis]);
                high[axis] = std::max(high[axis], p[axis]);
            }
        }
    }
    SizeReport report;
    if (!(low.x <= high.x)) return report;
    report.extentMm = high - low;
    report.verdict = judge(report.extentMm, limits);
    if (report.verdict == SizeVerdict::Plausible) return report;
    for (const auto& [unit, mm] : {std::pair{LengthUnit::Metres, 1000.0},
                                   {LengthUnit::Centimetres, 10.0},
                                   {LengthUnit::Micrometres, 0.001}}) {
        if (judge(mm * report.extentMm, limits) != SizeVerdict::Plausible) continue;
        report.guess = unit;
        break;
    }
    return report;
}

}  // namespace adaptiso
