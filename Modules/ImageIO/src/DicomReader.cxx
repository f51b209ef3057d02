#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "DicomFolder.h"
#include "DicomGroups.h"
#include "DicomPixels.h"
#include "DicomStack.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "Samples.h"
#include "Sandbox.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ListSeries.h"

// A classic series (a file a slice), an enhanced multi-frame file and a mosaic are one thing here:
// a list of planes, each with its own place. itk::ImageSeriesReader is not used: it straightens
// tilt, accepts gaps and takes one slice's rescale for all.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kGiveAll = "give a folder that holds slices at several positions";
constexpr const char* kRepeated =
    "several slices lie at the same position: duplicate files, or volumes that can't be told apart";

[[noreturn]] void refuseRepeated(const fs::path& input, const std::vector<DicomFile>& files,
                                 const DicomGroup& group) {
    const auto places = dicomPlaces(group.planes);
    const auto repeated =
        std::ranges::find_if(places, [](const auto& place) { return place.size() > 1; });
    const auto nameOf = [&](std::size_t n) {
        const fs::path& file = files[group.planes[n].file].path;
        return fileNumber(file, fs::is_directory(input) ? input : input.parent_path());
    };
    const auto count = std::ranges::count_if(places, [](const auto& p) { return p.size() > 1; });
    refuse(input,
           fmt::format("{} ({} of {} positions; first: position {}, {} and {})", kRepeated, count,
                       places.size(), repeated - places.begin() + 1, nameOf((*repeated)[0]),
                       nameOf((*repeated)[1])),
           "keep one volume in the folder");
}

/// The planes of the one volume to read. \param options  null: the first
std::vector<DicomPlane> chosenPlanes(const fs::path& input, const std::vector<DicomFile>& files,
                                     const DicomGroup& group, const ReadOptions* options) {
    if (dicomPlaces(group.planes).size() == 1 && !group.isSegmentation) {
        refuse(input,
               fmt::format("all of its {} slices lie at the same position: no volume",
                           group.planes.size()),
               kGiveAll);
    }
    DicomVolumes split = splitDicomVolumes(group.planes);
    const std::int64_t count = std::ssize(split.volumes);
    if (count == 0) refuseRepeated(input, files, group);
    if (options == nullptr) return std::move(split.volumes.front());
    const std::int64_t chosen =
        chooseVolume(input, count, *options,
                     fmt::format("is a 4-D image: {} volumes at the same position ({}{})", count,
                                 split.kind, group.isMosaic ? "; mosaics" : ""));
    return std::move(split.volumes[static_cast<std::size_t>(chosen)]);
}

/// \param options  null: of the first volume, for a list
DicomStack stackOf(const fs::path& input, const std::vector<DicomFile>& files,
                   const DicomGroup& group, const ReadOptions* options) {
    if (!group.fault.empty()) throw FileError(group.fault);
    if (group.planes.size() == 1 && !group.isSegmentation) {
        refuse(input, "is a single DICOM slice, a surface needs a volume", kGiveAll);
    }
    requirePlacedPlanes(files, group);
    std::vector<DicomPlane> planes = chosenPlanes(input, files, group, options);
    std::vector<Warning> warnings = group.warnings;
    requireAgreement(input, files, planes, warnings);
    requireWholeConcatenation(input, files, planes);
    warnOfFewer(files, group, planes.size(), warnings);
    DicomStack stack = group.isSegmentation ? stackSegmentFrames(input, group, std::move(planes))
                                            : stackDicomPlanes(input, group, std::move(planes),
                                                               options && options->resampleSlices);
    stack.warnings.insert(stack.warnings.end(), warnings.begin(), warnings.end());
    return stack;
}

/// JPEG, JPEG-LS or JPEG 2000 in any of the stack's files: the rest is decoded here.
bool needsGdcm(const std::vector<DicomFile>& files, const DicomStack& stack) {
    return std::ranges::any_of(stack.planes, [&](const DicomPlane& plane) {
        return files[plane.file].header.transferSyntax.starts_with("1.2.840.10008.1.2.4.");
    });
}

/// Of the first slice that is scaled.
std::string scalingOf(const DicomStack& stack) {
    for (const DicomPlane& plane : stack.planes) {
        SampleLayout layout;
        layout.slope = plane.slope;
        layout.intercept = plane.intercept;
        layout.isScaled = plane.slope != 1 || plane.intercept != 0;
        if (layout.isScaled) return layout.scalingText("RescaleSlope", "RescaleIntercept");
    }
    return {};
}

ReadVolume readImages(const fs::path& input, DicomInput images, const ReadOptions& options) {
    std::vector<Warning> warnings = std::move(images.warnings);
    const std::vector<DicomGroup> groups = groupDicomPlanes(images.files);
    const DicomGroup& group = groups[chooseDicomGroup(input, groups, options.series, warnings)];
    const DicomStack stack = stackOf(input, images.files, group, &options);
    requireUsableGeometry(input, stack.geometry);
    warnings.insert(warnings.end(), stack.warnings.begin(), stack.warnings.end());
    const auto decode = [&] {
        std::vector<Warning> all = warnings;
        Volume volume = decodeDicomStack(input, images.files, stack, all);
        return ReadVolume{std::move(volume), "DICOM", std::move(all), scalingOf(stack)};
    };
    const bool isSandboxed = options.sandbox && needsGdcm(images.files, stack);
    return isSandboxed ? readInSandbox(input, sandboxLimitsFor(input), decode) : decode();
}

// ---- the list

/// Fills in what reading the group would give, or why it can't be read.
void tryGroup(const fs::path& input, const std::vector<DicomFile>& files, const DicomGroup& group,
              DicomSeries& series) {
    if (group.fault.empty() && group.isPlaced() && dicomPlaces(group.planes).size() > 1) {
        series.volumes = std::ssize(splitDicomVolumes(group.planes).volumes);
    }
    try {
        const DicomStack stack = stackOf(input, files, group, nullptr);
        series.slices = stack.geometry.size[2];
        series.spacingMm[2] = norm(stack.geometry.indexToPhysical.column[2]);
        series.warnings = stack.warnings;
    } catch (const FileError& error) {
        series.fault = series.volumes == 0 ? kRepeated : withoutName(error.what(), input);
        for (const DicomPlane& plane : group.planes) {
            series.fault = withoutName(series.fault, files[plane.file].path);
        }
    }
}

DicomSeries seriesOf(const fs::path& input, const std::vector<DicomFile>& files,
                     const DicomGroup& group, std::int64_t number) {
    const DicomPlane& first = group.planes.front();
    DicomSeries series;
    series.number = number;
    series.uid = group.seriesUid;
    series.description = plainDicomText(group.description);
    series.modality = plainDicomText(group.modality);
    series.orientation = orientationName(group);
    series.columns = group.columns;
    series.rows = group.rows;
    series.slices = std::ssize(group.planes);
    series.spacingMm = {first.columnStepMm.value_or(0), first.rowStepMm.value_or(0), 0};
    series.isLocalizer = group.isLocalizer;
    series.segment = group.segment;
    series.segmentLabel = group.segmentLabel;
    series.details = group.details;
    tryGroup(input, files, group, series);
    return series;
}

DicomListing listImages(const fs::path& input, const DicomInput& images) {
    DicomListing listing{{}, images.otherFiles, images.warnings, images.damaged};
    for (const DicomGroup& group : groupDicomPlanes(images.files)) {
        listing.series.push_back(
            seriesOf(input, images.files, group, std::ssize(listing.series) + 1));
    }
    return listing;
}

}  // namespace

ReadVolume readDicomFile(const fs::path& file, const ReadOptions& options) {
    const auto read = [&] {
        return readImages(file, readDicomFileHeaders(file, DamagedFiles::Refuse, false), options);
    };
    const bool isDirectory = lowerCase(file.filename().string()).starts_with("dicomdir");
    return isDirectory ? numberingFiles(file, file.parent_path(), read) : read();
}

ReadVolume readDicomFolder(const fs::path& folder, const ReadOptions& options) {
    return numberingFiles(folder, folder, [&] {
        return readImages(folder, readDicomHeaders(folder, DamagedFiles::Refuse, false), options);
    });
}

}  // namespace adaptiso::detail

namespace adaptiso {

DicomListing listSeries(const std::filesystem::path& input) {
    std::error_code error;
    if (std::filesystem::is_directory(input, error)) {
        return detail::listImages(
            input, detail::readDicomHeaders(input, detail::DamagedFiles::List, true));
    }
    constexpr std::size_t kMagicEnd = 132;
    detail::requireRegularFile(input);
    if (!detail::looksLikeDicom(detail::readHead(input, kMagicEnd))) {
        detail::refuse(input, "is no DICOM file, and only DICOM holds series",
                       "give a DICOM folder or file");
    }
    return detail::listImages(
        input, detail::readDicomFileHeaders(input, detail::DamagedFiles::List, true));
}

}  // namespace adaptiso
