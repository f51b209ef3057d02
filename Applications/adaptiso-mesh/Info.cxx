#include "Info.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iomanip>
#include <numbers>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/ProgramRun.h"
#include "Common/RunApp.h"
#include "InfoPage.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"
#include "adaptiso/Preprocessing/LabelValues.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::mesher {

bool isInteger(PixelType type) {
    return type != PixelType::Float32 && type != PixelType::Float64;
}

namespace {

/// Content of the --info report.
struct ImageInfo {
    std::string fault;  ///< why the image is refused, its path left out; the rest is empty then
    std::string format;
    std::vector<Warning> warnings;
    Index3 sizeAsRead{};
    ImageGeometry geometry;  ///< as preprocessed, like all that follows
    PixelType pixelType{};
    ValueSummary values;
    bool looksLikeLabels = false;
    std::vector<std::string> refusals;  ///< reasons to refuse a surface
    std::optional<DicomSeries> series;  ///< with --show-phi, of DICOM
    std::optional<Volume> volume;       ///< for the page
};

double angleDeg(const Vec3& a, const Vec3& b) {
    return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

/// The anatomical directions nearest to i, j and k, each taken once.
std::string orientationOf(const Mat3& axes) {
    constexpr std::array<const char*, 3> kPositive{"L", "P", "S"}, kNegative{"R", "A", "I"};
    std::string code(3, '?');
    std::array<bool, 3> isTaken{};
    for (int n = 0; n < 3; ++n) {
        int bestAxis = -1, bestRow = -1;
        double best = -1;
        for (int axis = 0; axis < 3; ++axis) {
            for (int row = 0; row < 3; ++row) {
                const double along = std::abs(normalized(axes.column[axis])[row]);
                if (code[axis] != '?' || isTaken[row] || along <= best) continue;
                best = along;
                bestAxis = axis;
                bestRow = row;
            }
        }
        isTaken[bestRow] = true;
        const bool isPositive = axes.column[bestAxis][bestRow] > 0;
        code[bestAxis] = (isPositive ? kPositive : kNegative)[bestRow][0];
    }
    return code;
}

/// Where the samples lie but for a thousandth on both sides; whole numbers fill whole bins.
SampleHistogram histogramOf(const VolumeView& volume, double low, double high) {
    constexpr double kBins = 256;
    if (!isInteger(volume.pixelType())) return sampleHistogram(volume, low, high, 256);
    const double width = std::ceil((high - low + 1) / kBins);
    const double bins = std::ceil((high - low + 1) / width);
    return sampleHistogram(volume, low - 0.5, low - 0.5 + bins * width,
                           static_cast<std::size_t>(bins));
}

double percentile(const ValueSummary& values, double percent) {
    const auto* const place = std::find(std::begin(kPercents), std::end(kPercents), percent);
    return values.percentiles[static_cast<std::size_t>(place - std::begin(kPercents))];
}

}  // namespace

bool AxesSummary::isSheared() const {
    constexpr double kHeadersRoundDeg = 0.01;  // DICOM's six digits of a cosine: 0.0001
    return std::max({std::abs(anglesDeg.x - 90), std::abs(anglesDeg.y - 90),
                     std::abs(anglesDeg.z - 90)}) > kHeadersRoundDeg;
}

AxesSummary summarizeAxes(const ImageGeometry& geometry) {
    const auto& [i, j, k] = geometry.indexToPhysical.column;
    const double fromNormal = angleDeg(k, cross(i, j));
    return {orientationOf(geometry.indexToPhysical),
            {angleDeg(j, k), angleDeg(k, i), angleDeg(i, j)},
            std::min(fromNormal, 180 - fromNormal)};
}

ValueSummary summarizeValues(const VolumeView& volume) {
    ValueSummary values;
    values.finite = countFinite(volume);
    values.notFinite = volume.geometry().voxelCount() - values.finite;
    values.percentiles = percentiles(volume, kPercents);
    if (values.percentiles.empty()) return values;
    const double minimum = percentile(values, 0), maximum = percentile(values, 100);
    if (!(minimum < maximum) || !std::isfinite(maximum - minimum)) return values;
    const double low = percentile(values, 0.1), high = percentile(values, 99.9);
    values.histogram =
        low < high ? histogramOf(volume, low, high) : histogramOf(volume, minimum, maximum);
    values.otsu = otsuThresholds(volume, 3);
    return values;
}

namespace {

std::vector<Warning> namedWarnings(const MeshOptions& options, const ImageInfo& info) {
    std::vector<Warning> warnings;
    addWarnings(warnings, info.warnings, baseName(options.input));
    return warnings;
}

std::vector<std::string> refusalsOf(const ValueSummary& values) {
    if (values.percentiles.empty()) return {"any isovalue: no voxel holds a finite number"};
    const double low = percentile(values, 0), high = percentile(values, 100);
    if (low < high) return {};
    return {"any isovalue: all voxels hold " + formatShort(low)};
}

/// An error's message without the folders that the input lies in.
std::string withoutPath(const std::string& message, const std::filesystem::path& input) {
    const std::string prefix = input.string() + ": ";
    return message.rfind(prefix, 0) == 0 ? message.substr(prefix.size()) : message;
}

/// The series that readVolume() has read: the one asked for, or the only one there is to read.
std::optional<DicomSeries> seriesOf(const MeshOptions& options) {
    std::vector<DicomSeries> fitting;
    for (DicomSeries& series : listSeries(options.input).series) {
        const auto& asked = options.image.read.series;
        const bool fits = asked ? *asked == series.uid || *asked == std::to_string(series.number)
                                : series.isReadable() && !series.isLocalizer;
        if (fits) fitting.push_back(std::move(series));
    }
    if (fitting.size() != 1) return std::nullopt;
    return fitting.front();
}

ImageInfo gather(const MeshOptions& options, ProgressLine& progress) {
    progress.show("read");
    ReadVolume read = readImage(options.input, options.image.read);
    ImageInfo info;
    info.format = read.format;
    info.warnings = std::move(read.warnings);
    info.sizeAsRead = read.volume.view().geometry().size;
    if (!options.preprocessing.changesNothing()) progress.show("preprocess");
    Preprocessed prepared =
        preprocessImage(std::move(read.volume), options.preprocessing, options.input);
    addWarnings(info.warnings, prepared.warnings);
    const VolumeView& volume = prepared.volume.view();
    info.geometry = volume.geometry();
    info.pixelType = volume.pixelType();
    progress.show("values");
    info.values = summarizeValues(volume);
    info.looksLikeLabels = findLabelValues(volume).has_value();
    info.refusals = refusalsOf(info.values);
    if (options.report.isWanted()) info.volume = std::move(prepared.volume);
    if (options.image.showsPhi && info.format == "DICOM") info.series = seriesOf(options);
    return info;
}

std::string vectorText(const Vec3& v, const std::string& separator) {
    return formatShort(v.x) + separator + formatShort(v.y) + separator + formatShort(v.z);
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
            << vectorText(normalized(geometry.indexToPhysical.column[axis]), ", ") << " (to "
            << axes.orientation[static_cast<std::size_t>(axis)] << ")\n";
    }
    out << "            " << (geometry.isMirrored() ? "left-handed (mirrored)" : "right-handed");
    if (axes.isSheared()) {
        out << "; sheared: k is tilted by " << formatFixed(axes.tiltDeg, 2)
            << " degrees, angles jk, ki, ij are " << vectorText(axes.anglesDeg, ", ");
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
            << " classes: " << joined(thresholds, formatShort) << '\n';
    }
    if (values.histogram) printHistogram(out, *values.histogram, isInteger);
}

/// A command to go on with: the options given but for those of --info, `words` and the input.
/// \param input  without folders on a page
std::string commandWith(const MeshOptions& options, const std::string& words,
                        const std::string& input) {
    std::string command = "adaptiso-mesh";
    for (const std::string& option : options.batch.runOptions) {
        const bool isOfInfo = option == "--info" || option == "--show-phi" ||
                              option == "--deface-report" || option.starts_with("--report=") ||
                              option.starts_with("--picture");
        if (!isOfInfo) command += " " + shellQuoted(option);
    }
    return oneLine(command + " " + words + (input.starts_with('-') ? " -- " : " ") +
                   shellQuoted(input));
}

/// Commands to go on with, of isovalues to try.
void printNext(std::ostream& out, const MeshOptions& options, const ImageInfo& info) {
    if (!info.refusals.empty() || info.values.otsu.empty()) return;
    const std::string input = options.input.string();
    if (info.looksLikeLabels) {
        out << "next        adaptiso-labels " << (input.starts_with('-') ? "-- " : "")
            << oneLine(shellQuoted(input)) << '\n';
        return;
    }
    if (info.values.otsu.size() == 1) {  // a mask
        out << "next        " << commandWith(options, "--iso auto", input) << '\n';
        return;
    }
    std::string isovalues;
    for (const double threshold : info.values.otsu[1]) {
        isovalues += "--iso " + formatShort(threshold) + " ";
    }
    const auto command = [&](const std::string& words) {
        return commandWith(options, words, options.input.string());
    };
    out << "next        " << command("--iso auto --largest --fill-cavities") << "\n            "
        << command(isovalues + "--report try.html") << '\n';
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
    out << "spacing     " << vectorText(spacing, " x ") << " mm, voxels of "
        << formatShort(geometry.voxelVolumeMm3()) << " mm3\n";
    out << "frame       LPS mm: x to the left, y to the back, z up\n";
    out << "origin      " << vectorText(geometry.originMm, ", ") << " (the first voxel's centre)\n";
    printAxes(out, geometry);
    printValues(out, info.values, isInteger(info.pixelType));
    for (const std::string& refusal : info.refusals) out << "refused     " << refusal << '\n';
    printNext(out, options, info);
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

Report makePage(const MeshOptions& options, const ImageInfo& info) {
    if (!info.values.histogram) throw InvalidInput("its values leave no isovalue to choose");
    return infoReport(baseName(options.input), info.format, info.volume->view(), info.values,
                      [&](const std::string& words) {
                          return commandWith(options, words, baseName(options.input));
                      });
}

}  // namespace

int runInfo(const MeshOptions& options) {
    ProgramRun run("adaptiso-mesh", options.common, options.report, "");
    OutputPlan(std::span(&options.input, 1)).check(options.common, options.report);
    ImageInfo info;
    try {
        info = gather(options, run.progress);
    } catch (const InternalError&) {
        throw;
    } catch (const Error& error) {
        run.progress.clear();
        info.fault = withoutPath(error.what(), options.input);
        run.verdict = verdictOf(std::current_exception());
        deliverReport(options.common, options.input, infoJson(options, info, run.verdict),
                      [](auto&) {});
        markReported();
        throw;
    }
    run.warnings = namedWarnings(options, info);
    run.printNewWarnings();
    if (options.report.isWanted()) run.writePage([&] { return makePage(options, info); });
    run.deliver([&] { return infoJson(options, info, run.verdict); },
                [&](std::ostream& out) { printInfo(out, options, info); });
    return run.end(baseName(options.input) + " was read");
}

}  // namespace adaptiso::mesher
