#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "Common/AtomicOutput.h"
#include "Common/CommonOptions.h"
#include "Common/Resources.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Report/Pictures.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// What every program takes that can show what it did.
struct ReportOptions {
    std::filesystem::path page;      ///< an HTML file; empty: none
    std::filesystem::path pictures;  ///< a folder of PNG files; empty: none

    bool isWanted() const { return !page.empty() || !pictures.empty(); }
};

/// Adds --report and --pictures.
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
    ~PictureFolder();
    PictureFolder(const PictureFolder&) = delete;
    PictureFolder& operator=(const PictureFolder&) = delete;

private:
    std::filesystem::path folder_;
    bool isMine_ = false;
};

/// Draws the pictures and writes them, and the page, under temporary names: what of them is asked
/// for. Program, version and date are filled in. The folder of --pictures must be there
/// (PictureFolder).
/// \return the pictures  \throws FileError
std::vector<Picture> writeReport(Report& report, const std::string& program,
                                 const ReportOptions& options, std::vector<AtomicOutput>& outputs);

/// Where --strict and warnings make a run fail, the page says so.
/// \param consequence  as strictFailure() takes it
void tellStrict(Report& report, const CommonOptions& common, std::span<const std::string> warnings,
                const std::string& consequence);

/// Size, voxel and format of an image, in words.
std::vector<ReportFact> imageFacts(const std::string& name, const std::string& format,
                                   const ImageGeometry& geometry);

}  // namespace adaptiso
