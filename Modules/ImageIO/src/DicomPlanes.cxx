#include "DicomPlanes.h"

#include <fmt/core.h>

#include <cmath>

#include "FileFault.h"
#include "HeaderText.h"

// Geometry: PS3.3, C.7.6.2.1.1 (classic images), C.7.6.16 (functional groups).
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

std::optional<Vec3> unitVector(const std::vector<double>& numbers, std::size_t from) {
    const Vec3 v{numbers[from], numbers[from + 1], numbers[from + 2]};
    if (!(std::abs(norm(v) - 1) < 1e-3)) return std::nullopt;
    return normalized(v);
}

/// Where the attributes of one plane stand: a functional group's items, or the data set itself;
/// nullptr if missing.
struct PlaneSources {
    const DicomDataset *position, *orientation, *measures, *transformation;
};

DicomPlane placedPlane(const fs::path& path, const PlaneSources& from) {
    const auto numbers = [&](const DicomDataset* set, DicomTag tag) {
        return set ? set->numbers(path, tag) : std::vector<double>{};
    };
    DicomPlane plane;
    if (const auto p = numbers(from.position, tag::kImagePosition); p.size() == 3) {
        plane.position = Vec3{p[0], p[1], p[2]};
    }
    if (const auto o = numbers(from.orientation, tag::kImageOrientation); o.size() == 6) {
        plane.alongRow = unitVector(o, 0);
        plane.alongColumn = unitVector(o, 3);
    }
    if (const auto s = numbers(from.measures, tag::kPixelSpacing); s.size() == 2) {
        plane.rowStepMm = s[0];  // between rows comes first (PS3.3, 10.7.1.3)
        plane.columnStepMm = s[1];
    }
    if (from.measures) {
        const auto apart = from.measures->numbersIfAny(tag::kSpacingBetweenSlices);
        if (apart.size() == 1 && apart[0] != 0) plane.sliceStepMm = std::abs(apart[0]);
    }
    const auto slope = numbers(from.transformation, tag::kRescaleSlope);
    const auto intercept = numbers(from.transformation, tag::kRescaleIntercept);
    if (!slope.empty()) plane.slope = slope.front();
    if (!intercept.empty()) plane.intercept = intercept.front();
    plane.hasRescale = !slope.empty() || !intercept.empty();
    if (from.transformation) {
        plane.rescaleType = from.transformation->text(tag::kRescaleType).value_or("");
    }
    if (plane.slope == 0) {
        refuse(path, "its RescaleSlope is 0: the image would be constant", "get the file again");
    }
    return plane;
}

std::vector<double>& labelOf(DicomPlane& plane, DicomLabel label) {
    return plane.labels[static_cast<std::size_t>(label)];
}

void addNumbers(std::vector<double>& numbers, const DicomDataset* set, DicomTag tag) {
    if (!set) return;
    const std::vector<double> more = set->numbersIfAny(tag);
    numbers.insert(numbers.end(), more.begin(), more.end());
}

std::string imageTypeOf(const DicomDataset& set, DicomTag type) {
    return std::string(set.text(type).value_or("")) + "|" +
           std::string(set.text(tag::kComplexImageComponent).value_or(""));
}

/// "HHMMSS.FFFFFF" in seconds; empty when absent or otherwise written.
std::vector<double> secondsOf(const DicomDataset& set) {
    for (const DicomTag tag : {tag::kAcquisitionTime, tag::kContentTime}) {
        const auto text = set.text(tag);
        const auto value = text && text->size() >= 6 ? parseNumber(*text) : std::nullopt;
        if (!value || !(*value >= 0 && *value < 240000)) continue;
        const double hours = std::floor(*value / 1e4), minutes = std::floor(*value / 100);
        return {3600 * hours + 60 * (minutes - 100 * hours) + (*value - 100 * minutes)};
    }
    return {};
}

DicomPlane classicPlane(const DicomFile& dicom) {
    const DicomDataset& top = dicom.header.dataset;
    DicomPlane plane = placedPlane(dicom.path, {&top, &top, &top, &top});
    plane.imageType = imageTypeOf(top, tag::kImageType);
    addNumbers(labelOf(plane, DicomLabel::Echo), &top, tag::kEchoNumbers);
    addNumbers(labelOf(plane, DicomLabel::Echo), &top, tag::kEchoTime);
    addNumbers(labelOf(plane, DicomLabel::TimePoint), &top, tag::kTemporalPosition);
    addNumbers(labelOf(plane, DicomLabel::CardiacPhase), &top, tag::kTriggerTime);
    addNumbers(labelOf(plane, DicomLabel::Diffusion), &top, tag::kDiffusionBValue);
    addNumbers(labelOf(plane, DicomLabel::Diffusion), &top, tag::kGradientOrientation);
    addNumbers(labelOf(plane, DicomLabel::Acquisition), &top, tag::kAcquisitionNumber);
    addNumbers(plane.order, &top, tag::kInstanceNumber);
    plane.time = secondsOf(top);
    plane.kernel = top.text(tag::kConvolutionKernel).value_or("");
    return plane;
}

/// One frame's functional groups, with the shared ones behind them.
class FunctionalGroups {
public:
    FunctionalGroups(const DicomDataset& own, const DicomDataset* shared)
        : own_(own), shared_(shared) {}

    const DicomDataset* operator()(DicomTag tag) const {
        const DicomDataset* found = own_.item(tag);
        return found || !shared_ ? found : shared_->item(tag);
    }

private:
    const DicomDataset& own_;
    const DicomDataset* shared_;
};

DicomPlane framePlane(const DicomFile& dicom, const FunctionalGroups& group) {
    const DicomDataset& top = dicom.header.dataset;
    const DicomDataset* transformation = group(tag::kPixelValueTransformationSequence);
    DicomPlane plane = placedPlane(
        dicom.path, {group(tag::kPlanePositionSequence), group(tag::kPlaneOrientationSequence),
                     group(tag::kPixelMeasuresSequence), transformation ? transformation : &top});
    const DicomDataset* type = group(tag::kMrFrameTypeSequence);
    if (!type) type = group(tag::kCtFrameTypeSequence);
    plane.imageType =
        type ? imageTypeOf(*type, tag::kFrameType) : imageTypeOf(top, tag::kImageType);
    const DicomDataset* diffusion = group(tag::kMrDiffusionSequence);
    addNumbers(labelOf(plane, DicomLabel::Echo), group(tag::kMrEchoSequence),
               tag::kEffectiveEchoTime);
    addNumbers(labelOf(plane, DicomLabel::TimePoint), group(tag::kFrameContentSequence),
               tag::kTemporalPositionIndex);
    addNumbers(labelOf(plane, DicomLabel::CardiacPhase), group(tag::kCardiacSequence),
               tag::kTriggerDelay);
    addNumbers(labelOf(plane, DicomLabel::Diffusion), diffusion, tag::kDiffusionBValue);
    if (diffusion) {
        addNumbers(labelOf(plane, DicomLabel::Diffusion),
                   diffusion->item(tag::kGradientDirectionSequence), tag::kGradientOrientation);
    }
    addNumbers(plane.order, &top, tag::kInstanceNumber);
    if (const DicomDataset* segment = group(tag::kSegmentIdentificationSequence)) {
        plane.segment = segment->integer(tag::kReferencedSegmentNumber);
    }
    return plane;
}

std::vector<DicomPlane> framePlanes(const DicomFile& dicom, const DicomPixelFormat& format,
                                    const std::vector<DicomDataset>& perFrame) {
    if (std::ssize(perFrame) != format.frames) {
        refuse(dicom.path,
               fmt::format("damaged DICOM header: {} frames but {} functional groups",
                           format.frames, perFrame.size()),
               "get the file again");
    }
    const DicomDataset* shared = dicom.header.dataset.item(tag::kSharedFunctionalGroups);
    std::vector<DicomPlane> planes;
    for (const DicomDataset& own : perFrame) {
        planes.push_back(framePlane(dicom, FunctionalGroups(own, shared)));
        planes.back().frame = std::ssize(planes) - 1;
        planes.back().order.push_back(static_cast<double>(planes.size()));
    }
    return planes;
}

}  // namespace

DicomFilePlanes dicomPlanes(const DicomFile& dicom, const DicomPixelFormat& format) {
    const DicomDataset& top = dicom.header.dataset;
    if (top.item(tag::kModalityLutSequence)) {
        refuse(dicom.path, "its values go through a lookup table (Modality LUT)",
               "convert it with a tool that applies the table");
    }
    const auto perFrame = top.sequences.find(tag::kPerFrameFunctionalGroups);
    if (perFrame != top.sequences.end()) {
        return {format.columns, format.rows, false, framePlanes(dicom, format, perFrame->second)};
    }
    if (format.frames > 1) {
        refuse(dicom.path,
               "is multi-frame but does not say where its frames lie (no functional groups)",
               "export it as single slices or enhanced DICOM");
    }
    const DicomPlane plane = classicPlane(dicom);
    if (isSiemensMosaic(dicom.header)) return mosaicPlanes(dicom, format, plane);
    return {format.columns, format.rows, false, {plane}};
}

}  // namespace adaptiso::detail
