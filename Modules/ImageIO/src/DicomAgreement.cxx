#include "DicomAgreement.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy = "get the series again, or give its slices of one kind";

/// How many slices say what.
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
               kRemedy);
    }
    const Votes types = count(
        planes, [](const DicomPlane& plane) -> std::string_view { return plane.rescaleType; });
    if (types.size() > 1) {
        refuse(input, fmt::format("its slices are rescaled to several units: {}", listOf(types)),
               kRemedy);
    }
    const Votes units = votesOf(tag::kUnits);
    if (units.size() > 1) {
        refuse(input, fmt::format("its slices are of several units: {}", listOf(units)), kRemedy);
    }
    const auto silent = std::ranges::count(planes, false, &DicomPlane::hasRescale);
    if (silent > 0 && std::ranges::any_of(planes, isRescaled)) {
        refuse(
            input,
            fmt::format("{} of its {} slices have no RescaleSlope and RescaleIntercept, the others "
                        "are rescaled by theirs",
                        silent, planes.size()),
            kRemedy);
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
