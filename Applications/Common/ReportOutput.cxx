#include "Common/ReportOutput.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "Common/AtomicOutput.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
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
    std::vector<Picture> pictures = drawPictures(report);
    if (!options.pictures.empty()) {
        for (const Picture& picture : pictures) {
            outputs.emplace_back(options.pictures / picture.name).writeText(picture.png);
        }
    }
    if (!options.page.empty()) {
        outputs.emplace_back(options.page).writeText(htmlPage(report, pictures));
    }
    return pictures;
}

constexpr double kNear = 0.06;

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

}  // namespace

void declareReportOptions(CLI::App& app, ReportOptions& options, const std::string& heading) {
    const OptionGroup group(app, heading);
    group.text("--report", "OUT.html", options.page,
               "Write a page to look at: the verdict, numbers, pictures and a viewer, in one "
               "HTML file that needs no network");
    group.text("--pictures", "DIR", options.pictures,
               "Write the report's pictures alone, as PNG files, into the folder DIR");
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

void tellStrict(Report& report, const CommonOptions& common, std::span<const Warning> warnings,
                const std::string& consequence) {
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
    std::stable_sort(clusters_.begin(), clusters_.end(),
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
