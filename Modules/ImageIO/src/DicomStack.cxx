#include "DicomStack.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "FileFault.h"

namespace adaptiso::detail {

namespace fs = std::filesystem;

namespace {

constexpr double kLargestMisplacementMm = 0.05;  // readVolume's promise on physical coordinates

/// The lower one of an even number.
double median(std::vector<double> values) {
    const auto middle = values.begin() + (std::ssize(values) - 1) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<double> stepsBetween(const std::vector<double>& along) {
    std::vector<double> steps;
    for (std::size_t n = 1; n < along.size(); ++n) steps.push_back(along[n] - along[n - 1]);
    return steps;
}

/// "4 mm between slices 3 and 4 where 2 mm is usual": the step that is furthest from the usual one.
std::string describeGap(const std::vector<double>& along) {
    const std::vector<double> steps = stepsBetween(along);
    const double usual = median(steps);
    const auto isOdd = [&](double step) { return std::abs(step - usual) > kLargestMisplacementMm; };
    const auto odd = std::ranges::count_if(steps, isOdd);
    const auto worst =
        std::ranges::max_element(steps, {}, [&](double step) { return std::abs(step - usual); });
    const auto before = worst - steps.begin() + 1;
    const double missing = std::round(*worst / usual) - 1;
    const bool isMissing =
        missing >= 1 && std::abs(*worst - (missing + 1) * usual) < 2 * kLargestMisplacementMm;
    return fmt::format(
        "uneven slice spacing: {} mm between slices {} and {} where {} mm is usual{}{}",
        number(*worst), before, before + 1, number(usual),
        isMissing
            ? fmt::format(" ({} missing there)", missing > 1 ? fmt::format("{} slices are", missing)
                                                             : std::string("a slice is"))
            : std::string(),
        odd > 1 ? fmt::format(", and {} more such steps", odd - 1) : std::string());
}

/// Even steps along the line, from the first plane to the last.
struct EvenSteps {
    std::int64_t count = 0;
    double stepMm = 0;
};

EvenSteps evenSteps(const std::vector<double>& along) {
    const double length = along.back() - along.front();
    const double intervals = std::max(1.0, std::round(length / median(stepsBetween(along))));
    return {static_cast<std::int64_t>(intervals) + 1, length / intervals};
}

/// Why the planes can't be blended onto even steps; empty if they can.
std::string blendFault(const std::vector<double>& along) {
    constexpr double kMostMade = 8;      // slices for each one that is there: else it is no series
    constexpr double kSamePlace = 0.05;  // of the usual step: a blend of both would be a mix
    const std::vector<double> steps = stepsBetween(along);
    const auto least = std::ranges::min_element(steps);
    const double usual = median(steps);
    if ((along.back() - along.front()) / usual > kMostMade * static_cast<double>(along.size())) {
        return "too far apart to be resampled";
    }
    if (*least >= kSamePlace * usual) return {};
    return fmt::format("slices {} and {} lie at nearly the same position",
                       least - steps.begin() + 1, least - steps.begin() + 2);
}

std::vector<SliceBlend> blendsOf(const std::vector<double>& along, const EvenSteps& even) {
    std::vector<SliceBlend> blends;
    std::size_t before = 0;
    for (std::int64_t k = 0; k < even.count; ++k) {
        const double at = along.front() + static_cast<double>(k) * even.stepMm;
        while (before + 2 < along.size() && along[before + 1] <= at) ++before;
        const double weight = (at - along[before]) / (along[before + 1] - along[before]);
        blends.push_back({before, std::clamp(weight, 0.0, 1.0)});
    }
    return blends;
}

/// The line through the places of a segmentation's frames.
struct FrameLine {
    Vec3 origin, direction;
    std::vector<double> along;  ///< from 0, without repeats
};

FrameLine frameLine(const fs::path& input, const DicomGroup& group) {
    const DicomPlane& first = group.planes.front();
    const Vec3 normal = normalized(cross(*first.alongRow, *first.alongColumn));
    const auto height = [&](const Vec3& position) { return dot(position, normal); };
    const auto [low, high] = std::ranges::minmax_element(group.framePositions, {}, height);
    FrameLine line{*low, normalized(*high - *low), {}};
    if (norm(*high - *low) < kLargestMisplacementMm) {
        refuse(input, "its frames all lie at the same position: no volume",
               "give a segmentation of several slices");
    }
    for (const Vec3& position : group.framePositions) {
        const Vec3 from = position - line.origin;
        line.along.push_back(dot(from, line.direction));
        const double beside = norm(from - line.along.back() * line.direction);
        if (beside > kLargestMisplacementMm) {
            refuse(input,
                   fmt::format("a frame lies {} mm beside the line through the others' positions",
                               number(beside)),
                   "export the segmentation with all frames on one line");
        }
    }
    std::ranges::sort(line.along);
    const auto isSame = [](double a, double b) { return b - a < kLargestMisplacementMm; };
    line.along.erase(std::unique(line.along.begin(), line.along.end(), isSame), line.along.end());
    return line;
}

/// \param stated  SpacingBetweenSlices
double frameStep(const std::vector<double>& along, const std::optional<double>& stated) {
    const double least = std::ranges::min(stepsBetween(along));
    if (!stated || *stated < kLargestMisplacementMm) return least;
    constexpr double kSameStep = 0.01;
    const double times = std::round(least / *stated);
    const bool fits = times >= 1 && std::abs(least - times * *stated) <= kSameStep * *stated;
    return fits ? least / times : least;
}

Warning tiltWarning(double tiltRad) {
    return {
        "gantry-tilt",
        fmt::format("the slices are tilted by {:.2f} degrees against their stack (gantry tilt): "
                    "kept as shear",
                    tiltRad * 180 / std::numbers::pi)};
}

}  // namespace

void requirePlacedPlanes(const std::vector<DicomFile>& files, const DicomGroup& group) {
    for (const DicomPlane& plane : group.planes) {
        const char* fault =
            !plane.position                           ? "has no ImagePositionPatient (position)"
            : !plane.alongRow || !plane.alongColumn   ? "has no usable ImageOrientationPatient"
            : !plane.columnStepMm || !plane.rowStepMm ? "has no usable PixelSpacing"
            : !(*plane.columnStepMm > 0 && *plane.rowStepMm > 0) ? "has a PixelSpacing of 0 or less"
            : std::abs(dot(*plane.alongRow, *plane.alongColumn)) > 1e-3
                ? "has an ImageOrientationPatient whose rows and columns are not perpendicular"
                : nullptr;
        if (fault) {
            refuse(files[plane.file].path,
                   fmt::format("the DICOM image {}: where it lies is unknown", fault),
                   "export the series again with its geometry");
        }
    }
}

DicomStack stackSegmentFrames(const fs::path& input, const DicomGroup& group,
                              std::vector<DicomPlane> planes) {
    const DicomPlane first = planes.front();
    const FrameLine line = frameLine(input, group);
    const double length = line.along.back();
    const double step = frameStep(line.along, first.sliceStepMm);
    const double intervals = std::round(length / step);
    constexpr double kMostSlices = 10000;
    if (intervals >= kMostSlices) {
        refuse(input,
               fmt::format("its frames span {} slices, {} mm apart", intervals + 1, number(step)),
               "check SpacingBetweenSlices and the frames' positions");
    }
    DicomStack stack;
    for (const double at : line.along) {
        const double off = at - std::round(at / step) * length / intervals;
        if (std::abs(off) > kLargestMisplacementMm) {
            refuse(input, describeGap(line.along), "export the segmentation with even steps");
        }
    }
    if (std::ranges::min(stepsBetween(line.along)) > 1.5 * step) {
        stack.warnings.push_back(
            {"empty-slices",
             fmt::format("no two frames of the segmentation are neighbours, {} mm apart: slices "
                         "without a frame are empty",
                         number(step))});
    }
    for (const DicomPlane& plane : planes) {
        const double at = dot(*plane.position - line.origin, line.direction);
        stack.slices.push_back(static_cast<std::size_t>(std::llround(at / step)));
    }
    stack.geometry = {
        {group.columns, group.rows, static_cast<std::int64_t>(intervals) + 1},
        line.origin,
        {{{*first.columnStepMm * *first.alongRow, *first.rowStepMm * *first.alongColumn,
           length / intervals * line.direction}}}};
    stack.planes = std::move(planes);
    return stack;
}

DicomStack stackDicomPlanes(const fs::path& input, const DicomGroup& group,
                            std::vector<DicomPlane> planes, bool resamplesSlices) {
    const DicomPlane first = planes.front();
    const Vec3 normal = normalized(cross(*first.alongRow, *first.alongColumn));
    std::ranges::stable_sort(planes, {},
                             [&](const DicomPlane& plane) { return dot(*plane.position, normal); });

    const Vec3 origin = *planes.front().position;
    const double steps = static_cast<double>(planes.size() - 1);
    const Vec3 span = *planes.back().position - origin;
    const Vec3 line = normalized(span);
    std::vector<double> along;  // the line
    bool isEven = true;
    for (std::size_t n = 0; n < planes.size(); ++n) {
        const Vec3 from = *planes[n].position - origin;
        along.push_back(dot(from, line));
        const double beside = norm(from - along.back() * line);
        if (beside > kLargestMisplacementMm) {
            refuse(input,
                   fmt::format("slice {} lies {} mm beside the line through the other slices' "
                               "positions",
                               n + 1, number(beside)),
                   "give one evenly stacked series");
        }
        const Vec3 off = from - static_cast<double>(n) / steps * span;
        if (norm(off) > kLargestMisplacementMm) isEven = false;
    }
    if (const std::string fault = isEven ? "" : blendFault(along); !fault.empty()) {
        refuse(input, describeGap(along) + ", " + fault, "give one complete series of slices");
    }
    if (!isEven && !resamplesSlices) {
        refuse(input, describeGap(along),
               "give the complete series, or let the slices be resampled (--resample-slices)");
    }

    DicomStack stack;
    EvenSteps even{std::ssize(planes), norm(span) / steps};
    if (!isEven) {
        even = evenSteps(along);
        stack.blends = blendsOf(along, even);
        stack.warnings.push_back(
            {"slices-resampled",
             fmt::format("{}: {} slices resampled to {}, {} mm apart", describeGap(along),
                         planes.size(), even.count, number(even.stepMm))});
    }
    const double tilt = std::acos(std::min(1.0, dot(line, normal)));
    if (std::sin(tilt) * norm(span) > kLargestMisplacementMm) {
        stack.warnings.push_back(tiltWarning(tilt));
    }
    stack.geometry = {
        {group.columns, group.rows, even.count},
        origin,
        {{{*first.columnStepMm * *first.alongRow, *first.rowStepMm * *first.alongColumn,
           (isEven ? 1 / steps : even.stepMm / norm(span)) * span}}}};
    stack.planes = std::move(planes);
    return stack;
}

namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedyForMixed = "get the series again, or give its slices of one kind";

/// Counts the slices for each answer.
using Votes = std::map<std::string, std::size_t>;

/// "HU (20 slices) and US (1 slice)"
std::string listOf(const Votes& votes) {
    std::string list;
    for (const auto& [value, count] : votes) {
        list += fmt::format("{}{} ({} slice{})", list.empty() ? "" : " and ", printable(value),
                            count, count > 1 ? "s" : "");
    }
    return list;
}

/// \param say  what a plane's header says, empty where it says nothing
Votes count(const std::vector<DicomPlane>& planes,
            const std::function<std::string_view(const DicomPlane&)>& say) {
    Votes votes;
    for (const DicomPlane& plane : planes) {
        const std::string_view value = say(plane);
        if (!value.empty()) ++votes[std::string(value)];
    }
    return votes;
}

struct ImageCount {
    std::int64_t stated = 0, there = 0;
};

/// Counts the images of the acquisition that lacks some; else of all images that state one number,
/// which may cover several acquisitions, echoes or series.
ImageCount countOfAcquisition(const std::vector<DicomFile>& files, const DicomGroup& group) {
    struct Acquisition {
        std::int64_t number, stated;
        auto operator<=>(const Acquisition&) const = default;
    };
    const auto acquisitionOf = [&](const DicomFile& file) {
        const DicomDataset& set = file.header.dataset;
        return Acquisition{set.integer(tag::kAcquisitionNumber).value_or(-1),
                           set.integer(tag::kImagesInAcquisition).value_or(0)};
    };
    std::map<Acquisition, std::int64_t> images;
    std::map<std::int64_t, std::int64_t> imagesOfStated;
    for (const DicomFile& file : files) {
        const Acquisition acquisition = acquisitionOf(file);
        constexpr std::int64_t kMostFrames = 1'000'000;
        const auto frames = std::clamp<std::int64_t>(
            file.header.dataset.integer(tag::kNumberOfFrames).value_or(1), 0, kMostFrames);
        images[acquisition] += frames;
        imagesOfStated[acquisition.stated] += frames;
    }
    std::set<Acquisition> own;
    for (const DicomPlane& plane : group.planes) own.insert(acquisitionOf(files[plane.file]));
    const auto lacks = [&](const Acquisition& one) { return images[one] < one.stated; };
    const auto incomplete = std::ranges::find_if(own, lacks);
    if (incomplete == own.end()) return {};
    const bool isOnlyOne = !std::ranges::all_of(own, lacks);
    return {incomplete->stated,
            isOnlyOne ? images[*incomplete] : imagesOfStated[incomplete->stated]};
}

bool isRescaled(const DicomPlane& plane) {
    return plane.slope != 1 || plane.intercept != 0;
}

}  // namespace

void requireAgreement(const fs::path& input, const std::vector<DicomFile>& files,
                      const std::vector<DicomPlane>& planes, std::vector<Warning>& warnings) {
    const auto votesOf = [&](DicomTag tag) {
        return count(planes, [&](const DicomPlane& plane) {
            return files[plane.file].header.dataset.text(tag).value_or("");
        });
    };
    const Votes photometric = votesOf(tag::kPhotometric);
    if (photometric.size() > 1) {
        refuse(input,
               fmt::format("mixes slices that store dark as low and as high values: {}",
                           listOf(photometric)),
               kRemedyForMixed);
    }
    const Votes types = count(
        planes, [](const DicomPlane& plane) -> std::string_view { return plane.rescaleType; });
    if (types.size() > 1) {
        refuse(input, fmt::format("its slices are rescaled to several units: {}", listOf(types)),
               kRemedyForMixed);
    }
    const Votes units = votesOf(tag::kUnits);
    if (units.size() > 1) {
        refuse(input, fmt::format("its slices are of several units: {}", listOf(units)),
               kRemedyForMixed);
    }
    const auto silent = std::ranges::count(planes, false, &DicomPlane::hasRescale);
    if (silent > 0 && std::ranges::any_of(planes, isRescaled)) {
        refuse(
            input,
            fmt::format("{} of its {} slices have no RescaleSlope and RescaleIntercept, the others "
                        "are rescaled by theirs",
                        silent, planes.size()),
            kRemedyForMixed);
    }
    const Votes signs = votesOf(tag::kPixelRepresentation);
    if (signs.size() > 1) {
        warnings.push_back({"mixed-signedness",
                            "some slices hold signed samples and some unsigned ones; each was read "
                            "as its own header says"});
    }
}

void requireWholeConcatenation(const fs::path& input, const std::vector<DicomFile>& files,
                               const std::vector<DicomPlane>& planes) {
    struct Concatenation {
        std::set<std::int64_t> parts;
        std::int64_t total = 0;
    };
    std::map<std::string_view, Concatenation> found;
    for (const DicomPlane& plane : planes) {
        const DicomDataset& set = files[plane.file].header.dataset;
        Concatenation& one = found[set.text(tag::kConcatenationUid).value_or("")];
        one.parts.insert(set.integer(tag::kInConcatenationNumber).value_or(0));
        one.total = std::max(one.total, set.integer(tag::kInConcatenationTotal).value_or(0));
    }
    for (const auto& [uid, one] : found) {
        if (std::ssize(one.parts) >= one.total) continue;
        refuse(input,
               fmt::format("holds {} of the {} files of a multi-frame image "
                           "(InConcatenationTotalNumber)",
                           one.parts.size(), one.total),
               "give the folder with all of them");
    }
}

void warnOfFewer(const std::vector<DicomFile>& files, const DicomGroup& group, std::size_t slices,
                 std::vector<Warning>& warnings) {
    const auto largest = [&](DicomTag tag) {
        std::int64_t value = 0;
        for (const DicomPlane& plane : group.planes) {
            value = std::max(value, files[plane.file].header.dataset.integer(tag).value_or(0));
        }
        return value;
    };
    const auto warn = [&](std::int64_t stated, std::int64_t there, std::string_view what,
                          std::string_view keyword) {
        if (stated <= there) return;
        warnings.push_back(
            {"fewer-images",
             fmt::format("its headers count {} {} ({}), {} {} here: {} missing", stated, what,
                         keyword, there, there == 1 ? "is" : "are", stated - there)});
    };
    warn(largest(tag::kNumberOfSlices), static_cast<std::int64_t>(slices), "slices",
         "NumberOfSlices");

    std::set<std::string_view> times;
    for (const DicomPlane& plane : group.planes) {
        times.insert(files[plane.file].header.dataset.text(tag::kTemporalPosition).value_or(""));
    }
    const auto volumes = static_cast<std::int64_t>(group.planes.size() / slices);
    const auto points = times.size() > 1 ? std::ssize(times) : volumes;
    warn(largest(tag::kNumberOfTemporalPositions), points, "time points",
         "NumberOfTemporalPositions");
    const ImageCount images = countOfAcquisition(files, group);
    warn(images.stated, images.there, "images", "ImagesInAcquisition");
}

}  // namespace adaptiso::detail
