#include "adaptiso/Report/Report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "Scene.h"
#include "Slices.h"
#include "SurfaceRenderer.h"
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
    std::vector<Picture> pictures;
    const auto add = [&](std::optional<Picture> picture) {
        if (picture) pictures.push_back(std::move(*picture));
    };
    if (report.histogram) pictures.push_back(histogramPicture(*report.histogram));
    const Scene scene = makeScene(report);
    if (isDrawn(scene)) {
        add(spotPicture(report, scene));
        for (const int axis : {2, 1, 0}) add(contourPicture(report, scene, axis));
        if (report.areRegions) {
            add(regionsPicture(scene));
        } else {
            for (std::size_t n = 0; n < scene.surfaces.size(); ++n) add(sixSidesPicture(scene, n));
        }
    }
    return pictures;
}

std::vector<Picture> drawViews(const Report& report, const ViewOptions& options) {
    const Scene scene = makeScene(report);
    std::vector<Picture> pictures;
    if (!isDrawn(scene)) return pictures;
    if (report.areRegions) return {viewPicture(scene.surfaces, "view-1.png", options)};
    for (const SceneSurface& surface : scene.surfaces) {
        const std::string name = "view-" + std::to_string(pictures.size() + 1) + ".png";
        SceneSurface alone = surface;
        if (!report.surfaces[pictures.size()].color) alone.color = kPlain;
        pictures.push_back(viewPicture({alone}, name, options));
    }
    return pictures;
}

}  // namespace adaptiso
