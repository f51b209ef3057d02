#include "Charts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "Canvas.h"

namespace adaptiso {
namespace {

constexpr int kBins = 48;

struct Panel {
    std::string title, unit;
    std::vector<double> values;
    ReportColor color{};
    std::optional<double> axisEnd{};  ///< none: where all but 0.5 % of the values lie
};

std::string shortNumber(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value == 0 ? 0.0 : value);
    return text;
}

/// 1, 2 or 5 times a power of ten: about five ticks over `range`.
double tickStep(double range) {
    const double rough = range / 5, power = std::pow(10, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= rough) return factor * power;
    }
    return 10 * power;
}

std::vector<double> triangleAreas(const SceneMesh& mesh) {
    std::vector<double> areas;
    areas.reserve(static_cast<std::size_t>(mesh.triangleCount()));
    mesh.forEachTriangle([&](const Triangle& t) {
        const Vec3 vector = areaVector2(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2]));
        areas.push_back(0.5 * norm(vector));
    });
    return areas;
}

/// Degrees; 0 where an edge has no length.
std::vector<double> smallestAngles(const SceneMesh& mesh) {
    std::vector<double> angles;
    angles.reserve(static_cast<std::size_t>(mesh.triangleCount()));
    mesh.forEachTriangle([&](const Triangle& t) {
        double smallest = std::numbers::pi;
        for (int n = 0; n < 3; ++n) {
            const Vec3 p = mesh.point(t[n]);
            const Vec3 a = mesh.point(t[(n + 1) % 3]) - p, b = mesh.point(t[(n + 2) % 3]) - p;
            smallest = std::min(smallest, std::atan2(norm(cross(a, b)), dot(a, b)));
        }
        angles.push_back(smallest * 180 / std::numbers::pi);
    });
    return angles;
}

/// From 0 (or the least, below it) to where all but one in 200 lie.
std::pair<double, double> axisRange(Panel& panel) {
    std::vector<double>& values = panel.values;  // in any order: of a large surface a copy is dear
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>(0.995 * double(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    const double least = std::min(0.0, *std::min_element(values.begin(), values.end()));
    double end = panel.axisEnd.value_or(*nth);
    if (!(end > least)) end = least + 1;
    return {least, end};
}

void drawAxis(Canvas& canvas, const Panel& panel, Pixel corner, double width, double bottom,
              std::pair<double, double> range) {
    const auto [least, end] = range;
    canvas.segments({{{corner.x, bottom}, {corner.x + width, bottom}}}, kInk, 1);
    const double step = tickStep(end - least);
    for (double tick = std::ceil(least / step) * step; tick <= end * (1 + 1e-9); tick += step) {
        const double x = corner.x + width * (tick - least) / (end - least);
        canvas.segments({{{x, bottom}, {x, bottom + 5}}}, kInk, 1);
        canvas.text({x, bottom + 20}, shortNumber(tick), 13, kInk, Anchor::Middle);
    }
    canvas.text({corner.x + width, bottom + 38}, panel.unit, 13, kInk, Anchor::Right);
}

void drawPanel(Canvas& canvas, Panel panel, Pixel corner, double width, double height) {
    const std::pair<double, double> range = axisRange(panel);
    const auto [least, end] = range;
    std::vector<double> counts(kBins);
    std::int64_t beyond = 0;
    for (const double value : panel.values) {
        if (value > end) {
            ++beyond;
        } else {
            const int bin = static_cast<int>(kBins * (value - least) / (end - least));
            ++counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
        }
    }
    const double top = corner.y + 46, bottom = corner.y + height - 46;
    const double most = *std::max_element(counts.begin(), counts.end());
    canvas.text({corner.x, corner.y + 18}, panel.title, 15, kInk, Anchor::Left, true);
    std::vector<double>& values = panel.values;
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    const auto [low, high] = std::minmax_element(panel.values.begin(), panel.values.end());
    canvas.text({corner.x, corner.y + 37},
                "smallest " + shortNumber(*low) + ", median " + shortNumber(*middle) +
                    ", largest " + shortNumber(*high) + (beyond > 0 ? " (not all shown)" : ""),
                13, kInk);
    for (int bin = 0; bin < kBins; ++bin) {
        const double tall = most > 0 ? (bottom - top - 6) * counts[bin] / most : 0;
        canvas.rectangle({corner.x + width * bin / kBins, bottom - tall}, width / kBins - 1, tall,
                         panel.color);
    }
    drawAxis(canvas, panel, corner, width, bottom, range);
}

/// Darker than on black, for white paper.
ReportColor onPaper(ReportColor color) {
    for (std::uint8_t& channel : color) channel = static_cast<std::uint8_t>(channel * 0.78);
    return color;
}

/// More surfaces than that share one row: a picture for each of hundreds is read by nobody, and
/// Cairo refuses one of 32,768 pixels.
constexpr std::size_t kMostRows = 24;

struct TriangleRow {
    std::string name;
    ReportColor color;
    std::vector<double> areas, angles;
};

std::vector<TriangleRow> triangleRows(const Scene& scene) {
    std::vector<TriangleRow> rows;
    const bool areJoined = scene.surfaces.size() > kMostRows;
    for (const SceneSurface& surface : scene.surfaces) {
        if (surface.mesh.isEmpty()) continue;
        if (!areJoined) {
            rows.push_back({surface.name, surface.color, {}, {}});
        } else if (rows.empty()) {
            rows.push_back({"all surfaces", surfaceColor(0), {}, {}});
        }
        const auto append = [](std::vector<double>& to, const std::vector<double>& values) {
            to.insert(to.end(), values.begin(), values.end());
        };
        append(rows.back().areas, triangleAreas(surface.mesh));
        append(rows.back().angles, smallestAngles(surface.mesh));
    }
    return rows;
}

}  // namespace

std::optional<Picture> trianglePicture(const Scene& scene) {
    constexpr int kWidth = 460, kHeight = 250, kMargin = 20;
    const std::vector<TriangleRow> rows = triangleRows(scene);
    if (rows.empty()) return std::nullopt;
    Canvas canvas(2 * (kWidth + kMargin) + kMargin,
                  static_cast<int>(rows.size()) * (kHeight + kMargin) + kMargin, kWhite);
    Pixel corner{kMargin, kMargin};
    for (const TriangleRow& row : rows) {
        const ReportColor color = onPaper(row.color);
        drawPanel(canvas, {row.name + ": area of triangles", "mm²", row.areas, color}, corner,
                  kWidth, kHeight);
        drawPanel(canvas,
                  {row.name + ": smallest angle of triangles", "degrees", row.angles, color, 60.0},
                  {corner.x + kWidth + kMargin, corner.y}, kWidth, kHeight);
        corner.y += kHeight + kMargin;
    }
    return Picture{"triangles.png",
                   "Size and shape of the triangles",
                   "Histograms of the area and of the smallest angle of the triangles of " +
                       std::string(scene.surfaces.size() > kMostRows ? "all surfaces together"
                                                                     : "every surface") +
                       "; the tables hold the numbers.",
                   canvas.png(),
                   canvas.width(),
                   canvas.height()};
}

std::optional<Picture> histogramPicture(const Report& report, std::size_t n) {
    constexpr int kWidth = 800, kHeight = 290, kMargin = 20;
    const ReportHistogram& histogram = report.histograms[n];
    Panel panel{histogram.title, histogram.unit, {}, onPaper(surfaceColor(1))};
    std::copy_if(histogram.values.begin(), histogram.values.end(), std::back_inserter(panel.values),
                 [](double v) { return std::isfinite(v); });
    if (panel.values.empty()) return std::nullopt;
    Canvas canvas(kWidth + 2 * kMargin, kHeight + 2 * kMargin, kWhite);
    drawPanel(canvas, std::move(panel), {kMargin, kMargin}, kWidth, kHeight);
    return Picture{"histogram-" + std::to_string(n + 1) + ".png",
                   histogram.title,
                   "Histogram: " + histogram.title + ", in " + histogram.unit + ".",
                   canvas.png(),
                   canvas.width(),
                   canvas.height()};
}

std::optional<Picture> timesPicture(const Report& report) {
    if (report.stageSeconds.empty()) return std::nullopt;
    constexpr int kWidth = 800, kRow = 28, kMargin = 20, kName = 150, kNumber = 90;
    const int rows = static_cast<int>(report.stageSeconds.size());
    Canvas canvas(kWidth, rows * kRow + 2 * kMargin, kWhite);
    double longest = 1e-9;
    for (const auto& [stage, seconds] : report.stageSeconds) longest = std::max(longest, seconds);
    double y = kMargin;
    for (const auto& [stage, seconds] : report.stageSeconds) {
        const double wide = (kWidth - kName - kNumber - 2 * kMargin) * seconds / longest;
        canvas.text({kMargin + kName - 12.0, y + 19}, stage, 14, kInk, Anchor::Right);
        canvas.rectangle({double(kMargin + kName), y + 4}, std::max(wide, 1.0), kRow - 8,
                         onPaper(surfaceColor(1)));
        char text[32];
        std::snprintf(text, sizeof text, "%.2f s", seconds);
        canvas.text({kMargin + kName + wide + 10, y + 19}, text, 14, kInk);
        y += kRow;
    }
    return Picture{"times.png",
                   "Time by stage",
                   "Bars of the wall-clock seconds of every stage; the table holds the numbers.",
                   canvas.png(),
                   canvas.width(),
                   canvas.height()};
}

}  // namespace adaptiso
