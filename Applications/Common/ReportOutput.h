#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "Common/AtomicOutput.h"
#include "Common/CliNames.h"
#include "Common/CommonOptions.h"
#include "Common/Resources.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Report/ImageFacts.h"  // IWYU pragma: export
#include "adaptiso/Report/Pictures.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What every program takes that can show what it did.
struct ReportOptions {
    std::filesystem::path page;      ///< an HTML file; empty: none
    std::filesystem::path pictures;  ///< a folder of PNG files; empty: none
    bool leavesOutFaces = false;

    bool isWanted() const { return !page.empty() || !pictures.empty(); }
};

/// Adds --report, --pictures and --deface-report.
void declareReportOptions(CLI::App& app, ReportOptions& options, const std::string& group);

/// Everything about these outputs that can be told before an input is read.
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

/// What became of the page and the pictures.
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
void tellStrict(Report& report, const CommonOptions& common, std::span<const Warning> warnings,
                const std::string& consequence);

}  // namespace adaptiso
