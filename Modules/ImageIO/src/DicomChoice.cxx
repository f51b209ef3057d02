#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "DicomGroups.h"
#include "DicomHeader.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// \throws ChoiceNeeded
[[noreturn]] void refuseSeries(const fs::path& input, const std::string& fault,
                               const std::vector<DicomGroup>& groups) {
    refuseChoice(input, fault,
                 "choose one by its number (--series; adaptiso-mesh --list-series prints what is "
                 "known of each)",
                 ChoiceNeeded::Among::Series, std::ssize(groups));
}

std::string listOf(const std::vector<DicomGroup>& groups) {
    constexpr std::size_t kMost = 12;
    std::string list;
    for (std::size_t n = 0; n < groups.size() && n < kMost; ++n) {
        const std::string modality = plainDicomText(groups[n].modality);
        list += fmt::format("{}{}: {}{}", n ? "; " : "", n + 1,
                            modality.empty() ? "" : modality + ", ", describeDicomGroup(groups[n]));
    }
    if (groups.size() > kMost) list += fmt::format("; and {} more", groups.size() - kMost);
    return list;
}

/// More than a stray image: a volume, or files that may be one.
bool isVolumeLike(const DicomGroup& group) {
    if (group.isSegmentation) return true;
    if (group.isLocalizer || group.isSecondary || group.planes.size() < 2) return false;
    return !group.fault.empty() || (group.isPlaced() && dicomPlaces(group.planes).size() > 1);
}

/// `group` can't be a part of the volume that `chosen` is.
bool isStray(const DicomGroup& group, const DicomGroup& chosen) {
    if (group.seriesUid != chosen.seriesUid || group.isLocalizer || group.isScreenshot) return true;
    if (group.isSegmentation != chosen.isSegmentation) return true;
    return group.isPlaced() && chosen.isPlaced() && !areParallelPlanes(group, chosen);
}

std::size_t namedGroup(const fs::path& input, const std::vector<DicomGroup>& groups,
                       const std::string& series) {
    const auto wanted = parseInteger(series);
    if (wanted && *wanted >= 1 && *wanted <= std::ssize(groups)) {
        return static_cast<std::size_t>(*wanted - 1);
    }
    const auto isNamed = [&](const DicomGroup& group) { return group.seriesUid == series; };
    const auto named = std::ranges::count_if(groups, isNamed);
    if (named == 1) {
        return static_cast<std::size_t>(std::ranges::find_if(groups, isNamed) - groups.begin());
    }
    if (named > 1) {
        refuseSeries(input,
                     fmt::format("the asked-for series holds {} groups of slices ({})", named,
                                 listOf(groups)),
                     groups);
    }
    refuseSeries(input, fmt::format("the asked-for series is not one of these: {}", listOf(groups)),
                 groups);
}

/// "a SeriesInstanceUID": differs in each of three or more parallel slices. Empty if none does.
std::string uidOfEachSlice(const std::vector<DicomGroup>& groups) {
    const auto isSlice = [&](const DicomGroup& group) {
        return group.planes.size() == 1 && group.isPlaced() && !group.isLocalizer &&
               areParallelPlanes(group, groups[0]);
    };
    if (groups.size() < 3 || !std::ranges::all_of(groups, isSlice)) return {};
    const auto allDiffer = [&](std::string DicomGroup::*uid) {
        std::set<std::string> uids;
        for (const DicomGroup& group : groups) uids.insert(group.*uid);
        return uids.size() == groups.size();
    };
    return allDiffer(&DicomGroup::seriesUid)          ? "a SeriesInstanceUID"
           : allDiffer(&DicomGroup::study)            ? "a StudyInstanceUID"
           : allDiffer(&DicomGroup::frameOfReference) ? "a FrameOfReferenceUID"
                                                      : "";
}

[[noreturn]] void refuseWithoutVolume(const fs::path& input,
                                      const std::vector<DicomGroup>& groups) {
    for (const DicomGroup& group : groups) {
        if (!group.fault.empty()) throw FileError(group.fault);
    }
    const std::string ownUid = uidOfEachSlice(groups);
    if (!ownUid.empty()) {
        refuse(input,
               fmt::format("each of its {} slices has {} of its own, and their headers do not "
                           "agree enough to join them",
                           groups.size(), ownUid),
               "export the series again, with the same UIDs in all of its slices");
    }
    refuse(input,
           fmt::format("holds no volume, only single images or localizers ({})", listOf(groups)),
           "give a folder that holds all slices of a series");
}

/// The first volume: an image, else a segmentation.
std::vector<DicomGroup>::const_iterator firstVolume(const std::vector<DicomGroup>& groups) {
    const auto isImage = [](const DicomGroup& group) {
        return isVolumeLike(group) && !group.isSegmentation;
    };
    const auto image = std::ranges::find_if(groups, isImage);
    return image != groups.end() ? image : std::ranges::find_if(groups, isVolumeLike);
}

}  // namespace

std::size_t chooseDicomGroup(const fs::path& input, const std::vector<DicomGroup>& groups,
                             const std::optional<std::string>& series,
                             std::vector<Warning>& warnings) {
    if (series) return namedGroup(input, groups, *series);
    if (groups.size() == 1) return 0;
    const auto first = firstVolume(groups);
    if (first == groups.end()) refuseWithoutVolume(input, groups);
    const auto chosen = static_cast<std::size_t>(first - groups.begin());
    const bool isOnly =
        std::ranges::count_if(groups, [&](const DicomGroup& group) {
            return isVolumeLike(group) && group.isSegmentation == first->isSegmentation;
        }) == 1;
    for (std::size_t n = 0; n < groups.size(); ++n) {
        if (n == chosen) continue;
        const DicomGroup& group = groups[n];
        if (isOnly && isStray(group, groups[chosen])) {
            warnings.push_back({"series-left-aside", "left aside: " + describeDicomGroup(group)});
            continue;
        }
        if (isOnly && !group.fault.empty()) throw FileError(group.fault);
        refuseSeries(input,
                     fmt::format("holds {} groups of slices that differ in series, size, spacing, "
                                 "orientation, kind, patient or frame of reference ({})",
                                 groups.size(), listOf(groups)),
                     groups);
    }
    return chosen;
}

}  // namespace adaptiso::detail
