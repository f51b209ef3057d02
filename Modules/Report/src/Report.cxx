#include "adaptiso/Report/Report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <optional>

#include "Scene.h"
#include "SixSides.h"
#include "Slices.h"
#include "SurfaceRenderer.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {

namespace {

constexpr std::array<ReportColor, 10> kViridis{{{68, 1, 84},
                                                {72, 40, 120},
                                                {62, 73, 137},
                                                {49, 104, 142},
                                                {38, 130, 142},
                                                {31, 158, 137},
                                                {53, 183, 121},
                                                {110, 206, 88},
                                                {181, 222, 43},
                                                {253, 231, 37}}};

constexpr std::array<ReportColor, 6> kSurfaces{{{240, 228, 66},
                                                {86, 180, 233},
                                                {230, 159, 0},
                                                {0, 178, 130},
                                                {230, 140, 190},
                                                {255, 110, 30}}};

}  // namespace

ReportColor viridis(double part) {
    const double place = (part > 0 ? std::min(part, 1.0) : 0.0) * (kViridis.size() - 1);
    const std::size_t below =
        std::min<std::size_t>(static_cast<std::size_t>(place), kViridis.size() - 2);
    const double rest = place - static_cast<double>(below);
    ReportColor color;
    for (std::size_t channel = 0; channel < color.size(); ++channel) {
        const double from = kViridis[below][channel], to = kViridis[below + 1][channel];
        color[channel] = static_cast<std::uint8_t>(std::lround(from + rest * (to - from)));
    }
    return color;
}

ReportColor surfaceColor(std::size_t n) {
    return kSurfaces[n % kSurfaces.size()];
}

TriangleMesh pointMarks(const std::vector<Vec3>& points, double radiusMm) {
    constexpr std::array<Triangle, 8> kFaces{
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    TriangleMesh marks;
    for (const Vec3& point : points) {
        const auto first = static_cast<VertexId>(marks.points.size());
        for (int corner = 0; corner < 6; ++corner) {
            Vec3 at = point;
            at[corner / 2] += corner % 2 == 0 ? radiusMm : -radiusMm;
            marks.points.push_back(at);
        }
        for (const Triangle& t : kFaces) {
            marks.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        }
    }
    return marks;
}

std::vector<ReportFact> imageFacts(const std::string& name, const std::string& format,
                                   const ImageGeometry& geometry) {
    const Vec3 spacing = geometry.spacingMm();
    const auto mm = [](double value) { return formatNumber(std::stod(formatLength(value, 4))); };
    return {{"Image", name + " (" + format + ")"},
            {"Voxels", std::to_string(geometry.size[0]) + " × " + std::to_string(geometry.size[1]) +
                           " × " + std::to_string(geometry.size[2])},
            {"Voxel size", mm(spacing.x) + " × " + mm(spacing.y) + " × " + mm(spacing.z) + " mm"}};
}

std::string reportDate() {
    std::time_t now = std::time(nullptr);
    if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
        char* end = nullptr;
        const long long given = std::strtoll(epoch, &end, 10);
        if (end != epoch && *end == '\0') now = static_cast<std::time_t>(given);
    }
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[64];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
    return text;
}

namespace {

constexpr ReportColor kPlain{226, 205, 190};

bool isDrawn(const Scene& scene) {
    return !scene.isEmpty() && (!scene.face || scene.hasTriangles());
}

}  // namespace

std::vector<Picture> drawPictures(const Report& report) {
    using Draw = std::function<std::optional<Picture>()>;
    std::vector<Draw> draws;
    if (report.histogram) draws.push_back([&] { return histogramPicture(*report.histogram); });
    const Scene scene = makeScene(report);
    if (isDrawn(scene)) {
        draws.push_back([&] { return spotPicture(report, scene); });
        for (const int axis : {2, 1, 0}) {
            draws.push_back([&, axis] { return contourPicture(report, scene, axis); });
        }
        draws.push_back([&] { return alignmentPicture(scene); });
        if (report.areRegions) draws.push_back([&] { return regionsPicture(scene); });
        for (std::size_t n = 0; n < scene.surfaces.size() && !report.areRegions; ++n) {
            if (scene.surfaces[n].areMarks) continue;
            draws.push_back([&, n] { return sixSidesPicture(scene, n); });
        }
    }
    std::vector<std::optional<Picture>> drawn(draws.size());
    parallelForPieces(std::ssize(draws), 1,
                      [&](std::int64_t begin, std::int64_t) { drawn[begin] = draws[begin](); });
    std::vector<Picture> pictures;
    for (std::optional<Picture>& picture : drawn) {
        if (picture) pictures.push_back(std::move(*picture));
    }
    return pictures;
}

std::vector<Picture> drawViews(const Report& report, const ViewOptions& options) {
    const Scene scene = makeScene(report);
    std::vector<Picture> pictures;
    if (!isDrawn(scene)) return pictures;
    if (report.areRegions) return {viewPicture(scene.surfaces, "view-1.png", options)};
    for (std::size_t n = 0; n < scene.surfaces.size(); ++n) {
        if (scene.surfaces[n].areMarks) continue;
        const std::string name = "view-" + std::to_string(pictures.size() + 1) + ".png";
        SceneSurface alone = scene.surfaces[n];
        if (!report.surfaces[n].color) alone.color = kPlain;
        pictures.push_back(viewPicture({alone}, name, options));
    }
    return pictures;
}

}  // namespace adaptiso
