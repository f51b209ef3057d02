#include <algorithm>
#include <cmath>
#include <iomanip>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Info.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::mesher {
namespace {

std::string joined(const Vec3& v, const std::string& separator) {
    return formatShort(v.x) + separator + formatShort(v.y) + separator + formatShort(v.z);
}

std::string joined(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ", ") + formatShort(value);
    return text;
}

/// A bar of up to 40 signs, as long as the logarithm of the count.
std::string bar(std::int64_t count, std::int64_t most) {
    constexpr double kLength = 40;
    if (count == 0) return "";
    const double length =
        kLength * std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most));
    return std::string(static_cast<std::size_t>(std::max(1.0, std::round(length))), '#');
}

/// \param isInteger  bins begin half-way between whole numbers; prints their first whole number
void printHistogram(std::ostream& out, const SampleHistogram& histogram, bool isInteger) {
    constexpr std::size_t kMostRows = 32;
    const std::size_t bins = histogram.counts.size();
    const std::size_t binsPerRow = (bins + kMostRows - 1) / kMostRows;
    std::vector<std::int64_t> rows;
    for (std::size_t first = 0; first < bins; first += binsPerRow) {
        std::int64_t count = 0;
        for (std::size_t bin = first; bin < std::min(first + binsPerRow, bins); ++bin) {
            count += histogram.counts[bin];
        }
        rows.push_back(count);
    }
    const std::int64_t most = *std::max_element(rows.begin(), rows.end());
    out << "histogram   from each value up to the next; bars are logarithmic\n";
    const auto print = [&](const std::string& from, std::int64_t count) {
        out << std::setw(14) << from << "  " << std::setw(15) << formatCount(count) << "  "
            << bar(count, most) << '\n';
    };
    if (histogram.below > 0) print("below", histogram.below);
    for (std::size_t row = 0; row < rows.size(); ++row) {
        print(formatShort(histogram.edge(row * binsPerRow) + (isInteger ? 0.5 : 0)), rows[row]);
    }
    if (histogram.above > 0) print("above", histogram.above);
}

void printAxes(std::ostream& out, const ImageGeometry& geometry) {
    const AxesSummary axes = summarizeAxes(geometry);
    const char* const names[] = {"i", "j", "k"};
    for (int axis = 0; axis < 3; ++axis) {
        out << (axis == 0 ? "axes        " : "            ") << names[axis] << " along "
            << joined(normalized(geometry.indexToPhysical.column[axis]), ", ") << " (to "
            << axes.orientation[static_cast<std::size_t>(axis)] << ")\n";
    }
    out << "            " << (geometry.isMirrored() ? "left-handed (mirrored)" : "right-handed");
    if (axes.isSheared()) {
        out << "; sheared: k is tilted by " << formatFixed(axes.tiltDeg, 2)
            << " degrees, angles jk, ki, ij are " << joined(axes.anglesDeg, ", ");
    } else {
        out << "; at right angles";
    }
    out << '\n';
}

void printValues(std::ostream& out, const ValueSummary& values, bool isInteger) {
    if (values.notFinite > 0) {
        out << "not finite  " << formatCount(values.notFinite) << " voxels (NaN or infinity)\n";
    }
    if (values.percentiles.empty()) return;
    out << "values      " << formatShort(values.percentiles.front()) << " to "
        << formatShort(values.percentiles.back()) << '\n';
    out << "percentiles ";
    for (std::size_t n = 1; n + 1 < values.percentiles.size(); ++n) {
        out << (n == 1   ? ""
                : n == 6 ? "\n            "
                         : ", ")
            << formatShort(kPercents[n]) << " %: " << formatShort(values.percentiles[n]);
    }
    out << '\n';
    for (const std::vector<double>& thresholds : values.otsu) {
        out << (thresholds.size() == 1 ? "Otsu        " : "            ") << thresholds.size() + 1
            << " classes: " << joined(thresholds) << '\n';
    }
    if (values.histogram) printHistogram(out, *values.histogram, isInteger);
}

/// `path` as a shell takes it.
std::string quoted(const std::string& path) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+,:@%";
    if (path.find_first_not_of(kPlain) == std::string::npos) return path;
    std::string text = "'";
    for (const char c : path) text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
}

/// Commands to go on with.
void printNext(std::ostream& out, const std::string& input, const ImageInfo& info) {
    if (!info.refusals.empty() || info.values.otsu.size() < 2) return;
    std::string command = "adaptiso-mesh " + oneLine(quoted(input));
    if (info.series) command += " --series " + std::to_string(info.series->number);
    out << "next        " << command << " --iso auto --largest --fill-cavities\n            "
        << command;
    for (const double threshold : info.values.otsu[1]) out << " --iso " << formatShort(threshold);
    out << " --report try.html\n";
}

Json valuesJson(const ValueSummary& values) {
    Json percentiles = Json::array();
    for (std::size_t n = 0; n < values.percentiles.size(); ++n) {
        percentiles.push_back(
            {{"percent", kPercents[n]}, {"value", number(values.percentiles[n])}});
    }
    Json histogram = nullptr;
    if (values.histogram) {
        histogram = {{"lower", values.histogram->lower},
                     {"upper", values.histogram->upper},
                     {"counts", values.histogram->counts},
                     {"below", values.histogram->below},
                     {"above", values.histogram->above}};
    }
    const bool hasAny = !values.percentiles.empty();
    return {{"finite", values.finite},
            {"notFinite", values.notFinite},
            {"minimum", hasAny ? number(values.percentiles.front()) : Json(nullptr)},
            {"maximum", hasAny ? number(values.percentiles.back()) : Json(nullptr)},
            {"percentiles", percentiles},
            {"otsu", values.otsu},
            {"histogram", histogram}};
}

Json imageJson(const ImageInfo& info) {
    const AxesSummary axes = summarizeAxes(info.geometry);
    Json json = geometryJson(info.geometry);
    json["frame"] = "lps";
    json["orientation"] = axes.orientation;
    json["rightHanded"] = !info.geometry.isMirrored();
    json["sheared"] = axes.isSheared();
    json["tiltDeg"] = axes.tiltDeg;
    json["axisAnglesDeg"] = vector(axes.anglesDeg);
    json["voxelVolumeMm3"] = info.geometry.voxelVolumeMm3();
    json["pixelType"] = toString(info.pixelType);
    return json;
}

Json seriesJson(const DicomSeries& series) {
    return {{"number", series.number},
            {"modality", series.modality},
            {"uid", series.uid},
            {"description", series.description}};
}

}  // namespace

void printInfo(std::ostream& out, const MeshOptions& options, const ImageInfo& info) {
    const ImageGeometry& geometry = info.geometry;
    const Index3& size = geometry.size;
    const Vec3 spacing = geometry.spacingMm();
    const double bytes = static_cast<double>(geometry.voxelCount()) *
                         static_cast<double>(bytesPerPixel(info.pixelType));
    out << oneLine(baseName(options.input)) << ": " << info.format << '\n';
    if (info.series) {
        out << "series      " << info.series->number << ", " << info.series->modality << ", UID "
            << oneLine(info.series->uid) << ", description '" << oneLine(info.series->description)
            << "'\n";
    }
    if (!options.preprocessing.changesNothing()) {
        out << "after       " << preprocessingText(options.preprocessing, info.sizeAsRead) << '\n';
    }
    out << "size        " << size[0] << " x " << size[1] << " x " << size[2] << " voxels, "
        << toString(info.pixelType) << ", " << formatShort(bytes / 1e6) << " MB\n";
    out << "spacing     " << joined(spacing, " x ") << " mm, voxels of "
        << formatShort(geometry.voxelVolumeMm3()) << " mm3\n";
    out << "frame       LPS mm: x to the left, y to the back, z up\n";
    out << "origin      " << joined(geometry.originMm, ", ") << " (the first voxel's centre)\n";
    printAxes(out, geometry);
    printValues(out, info.values, isInteger(info.pixelType));
    for (const std::string& refusal : info.refusals) out << "refused     " << refusal << '\n';
    printNext(out, options.input, info);
}

std::string infoJson(const MeshOptions& options, const ImageInfo& info, const Verdict& verdict) {
    const bool isRead = info.fault.empty();
    const auto ifRead = [&](const auto& make) { return isRead ? Json(make()) : Json(nullptr); };
    Json report =
        reportHead("adaptiso-info/1", "adaptiso-mesh", verdict, namedWarnings(options, info));
    report.update(Json{{"input",
                        {{"file", baseName(options.input)},
                         {"format", isRead ? Json(info.format) : Json(nullptr)},
                         {"readable", isRead},
                         {"fault", isRead ? Json(nullptr) : Json(info.fault)},
                         {"warnings", info.warnings}}},
                       {"preprocessing", ifRead([&] {
                            return preprocessingJson(options.preprocessing, info.sizeAsRead);
                        })},
                       {"image", ifRead([&] { return imageJson(info); })},
                       {"values", ifRead([&] { return valuesJson(info.values); })},
                       {"refusals", info.refusals},
                       {"failedByWarnings", failsStrict(options.common, info.warnings)}});
    if (info.series) report["series"] = seriesJson(*info.series);
    return jsonText(report) + "\n";
}

}  // namespace adaptiso::mesher
