#include "Info.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>

#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso::mesher {
namespace {

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
    const Preprocessed prepared =
        preprocessImage(std::move(read.volume), options.preprocessing, options.input);
    addWarnings(info.warnings, prepared.warnings);
    const VolumeView& volume = prepared.volume.view();
    info.geometry = volume.geometry();
    info.pixelType = volume.pixelType();
    progress.show("values");
    info.values = summarizeValues(volume);
    info.refusals = refusalsOf(info.values);
    if (options.image.showsPhi && info.format == "DICOM") info.series = seriesOf(options);
    return info;
}

}  // namespace

bool isInteger(PixelType type) {
    return type != PixelType::Float32 && type != PixelType::Float64;
}

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

std::vector<Warning> namedWarnings(const MeshOptions& options, const ImageInfo& info) {
    std::vector<Warning> warnings;
    addWarnings(warnings, info.warnings, baseName(options.input));
    return warnings;
}

int runInfo(const MeshOptions& options) {
    const ThreadLimit threads(options.common);
    checkReportFile(options.common, options.input);
    ProgressLine progress(options.common.isQuiet);
    ImageInfo info;
    try {
        info = gather(options, progress);
    } catch (const InternalError&) {
        throw;
    } catch (const Error& error) {
        progress.clear();
        info.fault = withoutPath(error.what(), options.input);
        const Verdict verdict = verdictOf(std::current_exception());
        deliverReport(options.common, options.input, infoJson(options, info, verdict),
                      [](auto&) {});
        markReported();
        throw;
    }
    progress.clear();
    const std::vector<Warning> warnings = namedWarnings(options, info);
    printWarnings("adaptiso-mesh", options.common, warnings);
    Verdict verdict;
    verdict.failStrict(options.common, warnings, "");
    deliverReport(options.common, options.input, infoJson(options, info, verdict),
                  [&](std::ostream& out) { printInfo(out, options, info); });
    return printVerdict("adaptiso-mesh", verdict, "");
}

}  // namespace adaptiso::mesher
