#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Report/Page.h"
#include "adaptiso/Report/Report.h"  // IWYU pragma: export

namespace adaptiso {

/// Options of every program that writes a report page.
struct ReportOptions {
    std::filesystem::path page;       ///< an HTML file; empty: none
    std::filesystem::path pictures;   ///< a folder of PNG files; empty: none
    std::optional<ViewOptions> view;  ///< pictures of this kind too; in the same folder
    bool leavesOutFaces = false;

    bool isWanted() const { return !page.empty() || !pictures.empty(); }
};

/// `options.picture` of a report of --json; null unless one is asked for.
Json pictureJson(const std::optional<ViewOptions>& view);

/// Adds --report, --pictures, --picture-view and its like, and --deface-report.
void declareReportOptions(CLI::App& app, ReportOptions& options, const std::string& heading);

/// Checks these outputs before an input is read.
/// \throws FileError
void checkReportOutputs(const ReportOptions& options,
                        std::span<const std::filesystem::path> inputs);

/// The folder of --pictures, made when it is not there; one that was made goes again, unless
/// something was kept in it.
class PictureFolder {
public:
    /// \throws FileError
    explicit PictureFolder(const std::filesystem::path& folder);

private:
    std::shared_ptr<detail::Temporary> made_;
};

/// The result of writing page and pictures.
struct ReportResult {
    std::vector<Picture> pictures;
    std::unique_ptr<PictureFolder> folder;  ///< to be kept until all outputs are in place
    std::string failure;  ///< why there is neither page nor pictures; empty: nothing failed
};

/// Makes the report, draws the pictures and writes them, and the page, under temporary names: what
/// of them is asked for. Program, version and date are filled in.
///
/// A report failure never aborts the run: errors (no memory, no disk, a drawing fault) are
/// returned, not thrown, and `outputs` stays as it was.
ReportResult writeReport(const std::function<Report()>& make, const std::string& program,
                         const ReportOptions& options, std::vector<AtomicOutput>& outputs);

/// Where --strict and warnings make a run fail, the page says so.
/// \param consequence  as strictFailure() takes it
void addStrictVerdict(Report& report, const CommonOptions& common,
                      std::span<const Warning> warnings, const std::string& consequence);

/// The most places of one kind that a page lists.
inline constexpr std::size_t kMostSpotsOfAKind = 12;

/// Groups defects that lie near each other into one place each.
class SpotClusters {
public:
    /// \param mesh  defects nearer than 6 % of the diagonal of its finite points are one place
    explicit SpotClusters(const TriangleMesh& mesh);

    /// A defect at `p`; one that is not finite is left out.
    void add(const Vec3& p);

    /// Adds the places to `spots`: first that of the first defect, which texts name, then that with
    /// the most defects.
    /// \param what  "crossing triangles in a.stl"
    void tell(const std::string& what, bool isFailure, std::vector<ReportSpot>& spots);

private:
    double nearMm_;
    std::vector<std::pair<Vec3, std::int64_t>> clusters_;
};

/// The mean of the triangle's corners.
Vec3 middleOf(const TriangleMesh& mesh, std::int64_t triangle);

}  // namespace adaptiso
