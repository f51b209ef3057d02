#include "Common/ReportOutput.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {
namespace fs = std::filesystem;

namespace {

std::vector<Picture> writePictures(Report report, const std::string& program,
                                   const ReportOptions& options,
                                   std::vector<AtomicOutput>& outputs) {
    report.program = program;
    report.version = programVersion();
    report.date = reportDate();
    report.leavesOutFaces = options.leavesOutFaces;
    std::vector<Picture> pictures, views;
    parallelInvoke(
        [&] {
            if (options.view) views = drawViews(report, *options.view);
        },
        [&] { pictures = drawPictures(report); });
    const auto write = [&](const Picture& picture) {
        outputs.emplace_back(options.pictures / picture.name, options.pictures)
            .writeText(picture.png);
    };
    if (!options.pictures.empty()) {
        std::for_each(pictures.begin(), pictures.end(), write);
        std::for_each(views.begin(), views.end(), write);
    }
    if (!options.page.empty()) {
        outputs.emplace_back(options.page).writeText(htmlPage(report, pictures));
    }
    return pictures;
}

constexpr double kNear = 0.06;
constexpr int kLeastPixels = 16, kMostPixels = 4096;

/// So near that distances between such points do not overflow.
bool isMeasurable(const Vec3& p) {
    return std::isfinite(squaredNorm(p));
}

double diagonalOf(const TriangleMesh& mesh) {
    TriangleMesh finite;
    std::copy_if(mesh.points.begin(), mesh.points.end(), std::back_inserter(finite.points),
                 isMeasurable);
    if (finite.points.empty()) return 0;
    const BoundingBox box = boundingBox(finite);
    return norm(box.size());
}

constexpr std::array<std::pair<const char*, std::array<double, 2>>, 6> kSides{
    {{"front", {0, 0}},
     {"back", {180, 0}},
     {"left", {90, 0}},
     {"right", {-90, 0}},
     {"top", {180, 90}},
     {"bottom", {0, -90}}}};

/// The two parts of "105,18" or "2400x1800"; empty unless there are two.
std::array<std::string, 2> halves(const std::string& text, char between) {
    const std::size_t at = text.find(between);
    if (at == std::string::npos) return {};
    return {text.substr(0, at), text.substr(at + 1)};
}

void parseView(const std::string& text, ViewOptions& view) {
    for (const auto& [word, angles] : kSides) {
        if (text != word) continue;
        view.azimuthDeg = angles[0];
        view.elevationDeg = angles[1];
        return;
    }
    const auto [first, second] = halves(text, ',');
    const auto azimuth = parseFiniteNumber(first), elevation = parseFiniteNumber(second);
    if (!azimuth || !elevation || std::abs(*azimuth) > 360 || std::abs(*elevation) > 90) {
        refuseValue("--picture-view", text,
                    "front, back, left, right, top, bottom, or two angles in degrees, as 105,18 "
                    "(-360 to 360, -90 to 90)");
    }
    view.azimuthDeg = *azimuth;
    view.elevationDeg = *elevation;
}

void parseSize(const std::string& text, ViewOptions& view) {
    const auto [width, height] = halves(text, 'x');
    const auto side = [&](const std::string& digits) {
        int value = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc{} || end != digits.data() + digits.size() || value < kLeastPixels ||
            value > kMostPixels) {
            refuseValue("--picture-size", text,
                        "width and height in pixels, as 2400x1800, each from 16 to 4096");
        }
        return value;
    };
    view.width = side(width);
    view.height = side(height);
}

/// "#d9c7a0", also without the #, which a shell may take for a comment's.
ReportColor parseColor(const std::string& option, const std::string& text,
                       const std::string& otherwise = "") {
    if (text == "white") return {255, 255, 255};
    if (text == "black") return {0, 0, 0};
    const std::string digits = text.starts_with('#') ? text.substr(1) : text;
    unsigned value = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (digits.size() != 6 || error != std::errc{} || end != digits.data() + digits.size()) {
        refuseValue(option, text, "a colour as '#d9c7a0', white" + otherwise + " or black");
    }
    return {static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
            static_cast<std::uint8_t>(value)};
}

std::string colorWord(ReportColor color) {
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
    return text;
}

const std::vector<std::pair<std::string, Shading>> kShadings{
    {"smooth", Shading::Smooth}, {"flat", Shading::Flat}, {"edges", Shading::Edges}};

void declareViewOptions(CLI::App& app, const OptionGroup& group,
                        std::optional<ViewOptions>& options) {
    const auto declare = [&](const std::string& name, const std::string& valueName,
                             const std::function<void(const std::string&, ViewOptions&)>& take,
                             const std::string& help) {
        group
            .value(
                name, valueName,
                [&options, take](const std::string& text) {
                    if (!options) options.emplace();
                    take(text, *options);
                },
                help)
            ->needs(app.get_option("--pictures"));
    };
    declare("--picture-view", "SIDE|AZ,EL", parseView,
            "Draw view-1.png too, each surface alone, for a paper: from the front, back, left, "
            "right, top or bottom, or from AZ degrees round from the front to the patient's left "
            "and EL above (default with the next four: front)");
    declare("--picture-size", "WxH", parseSize,
            "Size of view-1.png in pixels (default: 2400x1800)");
    declare(
        "--picture-color", "COLOR",
        [](const std::string& text, ViewOptions& view) {
            view.color = parseColor("--picture-color", text);
        },
        "Colour of the surfaces there, as '#d9c7a0' (default: ivory, or as the report has them)");
    declare(
        "--picture-background", "COLOR|transparent",
        [](const std::string& text, ViewOptions& view) {
            view.background.reset();
            if (text == "transparent") return;
            view.background = parseColor("--picture-background", text, ", transparent");
        },
        "Background there (default: white)");
    declare(
        "--picture-shading", "smooth|flat|edges",
        [](const std::string& text, ViewOptions& view) {
            std::vector<std::string> words;
            for (const auto& [word, shading] : kShadings) words.push_back(word);
            view.shading = kShadings[parseChoice("--picture-shading", text, words)].second;
        },
        "Shading there: smooth by the vertices' normals (default), flat by triangles, or flat "
        "with their edges");
}

}  // namespace

Json pictureJson(const std::optional<ViewOptions>& view) {
    if (!view) return nullptr;
    const auto shading =
        std::ranges::find(kShadings, view->shading, &std::pair<std::string, Shading>::second);
    return {{"viewDeg", {view->azimuthDeg, view->elevationDeg}},
            {"sizePixels", {view->width, view->height}},
            {"color", view->color ? Json(colorWord(*view->color)) : Json(nullptr)},
            {"background", view->background ? colorWord(*view->background) : "transparent"},
            {"shading", shading->first}};
}

void declareReportOptions(CLI::App& app, ReportOptions& options, const std::string& heading) {
    const OptionGroup group(app, heading);
    group.text("--report", "OUT.html", options.page,
               "Write a page to look at: the verdict, numbers, pictures and a viewer, in one "
               "HTML file that needs no network");
    const auto takeFolder = [&options](const std::string& text) {
        options.pictures = text;
        // "pictures/" and "pictures" are one folder, in the same parent
        if (!options.pictures.has_filename()) options.pictures = options.pictures.parent_path();
    };
    group.value("--pictures", "DIR", takeFolder,
                "Write the report's pictures alone, as PNG files, into the folder DIR");
    declareViewOptions(app, group, options.view);
    group.flag(
        "--deface-report", options.leavesOutFaces,
        "Leave the face out of the page and the pictures: what lies in front of and below the "
        "brain, of the image and of the surfaces");
}

void checkReportOutputs(const ReportOptions& options, std::span<const fs::path> inputs) {
    if (options.leavesOutFaces && !options.isWanted()) {
        throw UsageError("--deface-report: needs --report or --pictures");
    }
    if (!options.page.empty()) {
        for (const fs::path& input : inputs) checkNotInput(options.page, input);
        checkOutput(options.page);
    }
    if (options.pictures.empty()) return;
    std::error_code error;
    if (fs::exists(options.pictures, error) && !fs::is_directory(options.pictures, error)) {
        throw FileError(options.pictures.string() + ": is not a folder");
    }
    if (!fs::exists(options.pictures, error)) checkOutput(options.pictures);  // its folder is there
}

PictureFolder::PictureFolder(const fs::path& folder) {
    if (folder.empty()) return;
    const detail::SignalsWait untilItIsRecorded;
    std::error_code error;
    const bool isMade = fs::create_directory(folder, error);
    if (error) throw FileError(folder.string() + ": can't be made: " + error.message());
    if (isMade) made_ = detail::removedAtEnd(folder);
}

ReportResult writeReport(const std::function<Report()>& make, const std::string& program,
                         const ReportOptions& options, std::vector<AtomicOutput>& outputs) {
    ReportResult result;
    const std::size_t before = outputs.size();
    try {
        result.folder = std::make_unique<PictureFolder>(options.pictures);
        result.pictures = writePictures(make(), program, options, outputs);
        return result;
    } catch (const std::bad_alloc&) {
        result.failure = "not enough memory";
    } catch (const std::exception& error) {
        result.failure = error.what();
    }
    // JSON reports hold no folders
    for (const fs::path& path : {options.page, options.pictures}) {
        const std::string folder = path.parent_path().string() + "/";
        const std::size_t at = result.failure.find(folder);
        if (!path.has_parent_path() || at == std::string::npos) continue;
        result.failure.erase(at, folder.size());
    }
    while (outputs.size() > before) outputs.pop_back();
    result.pictures.clear();
    result.folder.reset();
    return result;
}

void addStrictVerdict(Report& report, const CommonOptions& common,
                      std::span<const Warning> warnings, const std::string& consequence) {
    if (!failsStrict(common, warnings)) return;
    const std::string text = strictFailure(common, warnings, consequence) + ".";
    const bool hasFailed = report.verdict == ReportVerdict::Failed;
    report.headline = hasFailed ? report.headline + " " + text : text;
    report.verdict = ReportVerdict::Failed;
}

SpotClusters::SpotClusters(const TriangleMesh& mesh) : nearMm_(kNear * diagonalOf(mesh)) {}

void SpotClusters::add(const Vec3& p) {
    if (!isMeasurable(p)) return;
    for (auto& [middle, count] : clusters_) {
        if (norm(middle - p) > nearMm_) continue;
        ++count;
        return;
    }
    clusters_.push_back({p, 1});
}

void SpotClusters::tell(const std::string& what, bool isFailure, std::vector<ReportSpot>& spots) {
    if (clusters_.empty()) return;
    std::stable_sort(clusters_.begin() + 1, clusters_.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (std::size_t n = 0; n < std::min(clusters_.size(), kMostSpotsOfAKind); ++n) {
        const auto& [middle, count] = clusters_[n];
        spots.push_back({count > 1 ? what + " (" + formatCount(count) + " here)" : what, middle,
                         isFailure, static_cast<int>(n)});
    }
}

Vec3 middleOf(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
    return (1.0 / 3) * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
}

}  // namespace adaptiso
