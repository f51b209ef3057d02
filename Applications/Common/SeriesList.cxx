#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ListSeries.h"

namespace adaptiso {
namespace {

std::string counted(std::int64_t count, const std::string& thing) {
    return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string spacingText(const Vec3& mm) {
    const auto text = [](double value) { return value > 0 ? formatShort(value) : "?"; };
    return text(mm.x) + " x " + text(mm.y) + " x " + text(mm.z) + " mm";
}

void printSeries(std::ostream& out, const DicomSeries& series, bool showsPhi) {
    out << "  " << series.number << ": " << (series.modality.empty() ? "?" : series.modality)
        << ", ";
    if (series.volumes > 1) out << counted(series.volumes, "volume") << " of ";
    out << counted(series.slices, "slice") << " of " << series.columns << " x " << series.rows
        << " voxels, " << spacingText(series.spacingMm) << ", " << series.orientation
        << (series.isLocalizer ? ", localizer" : "");
    if (series.segment) out << ", segment " << *series.segment;
    if (!series.segmentLabel.empty()) out << " '" << oneLine(series.segmentLabel) << "'";
    for (const auto& [keyword, value] : series.details) {
        out << ", " << keyword << ' ' << oneLine(value);
    }
    out << '\n';
    if (showsPhi) {
        out << "     UID " << oneLine(series.uid) << ", description '"
            << oneLine(series.description) << "'\n";
    }
    if (!series.isReadable()) out << "     can't be read: " << series.fault << '\n';
    for (const Warning& warning : series.warnings) out << "     " << warning.line() << '\n';
}

void printList(std::ostream& out, const std::string& name, const DicomListing& listing,
               bool showsPhi) {
    out << oneLine(name) << " holds " << listing.series.size() << " series\n";
    for (const DicomSeries& series : listing.series) printSeries(out, series, showsPhi);
    if (listing.otherFiles > 0) {
        out << "  " << counted(static_cast<std::int64_t>(listing.otherFiles), "DICOM file")
            << " without an image\n";
    }
    for (const Warning& warning : listing.warnings) out << "  " << warning.line() << '\n';
    for (const DicomFault& damaged : listing.damaged) {
        out << "  damaged file" << (showsPhi ? " " + oneLine(damaged.file.string()) : std::string())
            << ": " << damaged.fault << '\n';
    }
}

Json seriesJson(const DicomSeries& series, bool showsPhi) {
    const auto mm = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
    Json details = Json::object();
    for (const auto& [keyword, value] : series.details) details[keyword] = value;
    Json json{
        {"number", series.number},
        {"modality", series.modality},
        {"sizeVoxels", {series.columns, series.rows, series.slices}},
        {"volumes", series.volumes},
        {"spacingMm", {mm(series.spacingMm.x), mm(series.spacingMm.y), mm(series.spacingMm.z)}},
        {"orientation", series.orientation},
        {"localizer", series.isLocalizer},
        {"segment", series.segment ? Json(*series.segment) : Json(nullptr)},
        {"segmentLabel", series.segmentLabel},
        {"details", details},
        {"readable", series.isReadable()},
        {"fault", series.isReadable() ? Json(nullptr) : Json(series.fault)},
        {"warnings", series.warnings}};
    if (showsPhi) {
        json["uid"] = series.uid;
        json["description"] = series.description;
    }
    return json;
}

/// The warnings of all series.
std::vector<Warning> warningsOf(const DicomListing& listing) {
    std::vector<Warning> warnings = listing.warnings;
    for (const DicomSeries& series : listing.series) {
        for (Warning warning : series.warnings) {
            warning.text = "series " + std::to_string(series.number) + ": " + warning.text;
            warnings.push_back(std::move(warning));
        }
    }
    return warnings;
}

std::string listJson(const std::string& program, const std::string& name,
                     const DicomListing& listing, const Verdict& verdict, bool showsPhi) {
    Json series = Json::array(), damaged = Json::array();
    for (const DicomSeries& one : listing.series) series.push_back(seriesJson(one, showsPhi));
    for (const DicomFault& one : listing.damaged) {
        Json json{{"fault", one.fault}};
        if (showsPhi) json["file"] = one.file.string();
        damaged.push_back(json);
    }
    Json report = reportHead("adaptiso-series/1", program, verdict, warningsOf(listing));
    report.update(Json{{"input", {{"file", name}}},
                       {"series", series},
                       {"filesWithoutImage", listing.otherFiles},
                       {"damagedFiles", damaged}});
    return jsonText(report) + "\n";
}

}  // namespace

int runSeriesList(const std::filesystem::path& input, const ImageOptions& options,
                  const CommonOptions& common, const std::string& program) {
    const ThreadLimit threads(common);
    const DicomListing listing = listSeries(input);
    const std::string name = baseName(input);
    Verdict verdict;
    verdict.failStrict(common, warningsOf(listing), "");
    const std::string json =
        common.wantsJson() ? listJson(program, name, listing, verdict, options.showsPhi) : "";
    deliverReport(common, input, json,
                  [&](std::ostream& out) { printList(out, name, listing, options.showsPhi); });
    return printVerdict(program, verdict, "");
}

}  // namespace adaptiso
