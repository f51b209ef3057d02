#include <fmt/core.h>

#include <algorithm>

#include "DicomGroups.h"
#include "DicomVolumes.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kChoose = "choose one by its number (--series)";

std::string listOf(const std::vector<DicomGroup>& groups) {
    constexpr std::size_t kMost = 12;
    std::string list;
    for (std::size_t n = 0; n < groups.size() && n < kMost; ++n) {
        list += fmt::format("{}{}: {}", n ? "; " : "", n + 1, describeDicomGroup(groups[n]));
    }
    if (groups.size() > kMost) list += fmt::format("; and {} more", groups.size() - kMost);
    return list;
}

/// More than a stray image: a volume, or files that may be one.
bool isVolumeLike(const DicomGroup& group) {
    if (group.isLocalizer || group.isSecondary || group.planes.size() < 2) return false;
    return !group.fault.empty() || (group.isPlaced() && dicomPlaces(group.planes).size() > 1);
}

/// `group` can't be a part of the volume that `chosen` is.
bool isStray(const DicomGroup& group, const DicomGroup& chosen) {
    if (group.seriesUid != chosen.seriesUid || group.isLocalizer) return true;
    return group.isPlaced() && chosen.isPlaced() && !areParallelPlanes(group, chosen);
}

std::size_t namedGroup(const fs::path& input, const std::vector<DicomGroup>& groups,
                       const std::string& series) {
    const auto wanted = parseInteger(series);
    if (wanted && *wanted >= 1 && *wanted <= std::ssize(groups)) {
        return static_cast<std::size_t>(*wanted - 1);
    }
    const auto hasUid = [&](const DicomGroup& group) { return group.seriesUid == series; };
    if (std::ranges::count_if(groups, hasUid) == 1) {
        return static_cast<std::size_t>(std::ranges::find_if(groups, hasUid) - groups.begin());
    }
    refuse(input, fmt::format("the asked-for series is not one of these: {}", listOf(groups)),
           kChoose);
}

[[noreturn]] void refuseWithoutVolume(const fs::path& input,
                                      const std::vector<DicomGroup>& groups) {
    for (const DicomGroup& group : groups) {
        if (!group.fault.empty()) throw FileError(group.fault);
    }
    refuse(input,
           fmt::format("holds no volume, only single images or localizers ({})", listOf(groups)),
           "give the folder with all slices of the series");
}

}  // namespace

std::size_t chooseDicomGroup(const fs::path& input, const std::vector<DicomGroup>& groups,
                             const std::optional<std::string>& series,
                             std::vector<Warning>& warnings) {
    if (series) return namedGroup(input, groups, *series);
    if (groups.size() == 1) return 0;
    const auto first = std::ranges::find_if(groups, isVolumeLike);
    if (first == groups.end()) refuseWithoutVolume(input, groups);
    const auto chosen = static_cast<std::size_t>(first - groups.begin());
    const bool isOnly = std::ranges::count_if(groups, isVolumeLike) == 1;
    for (std::size_t n = 0; n < groups.size(); ++n) {
        if (n == chosen) continue;
        const DicomGroup& group = groups[n];
        if (isOnly && isStray(group, groups[chosen])) {
            warnings.push_back({"series-left-aside", "left aside: " + describeDicomGroup(group)});
            continue;
        }
        if (isOnly && !group.fault.empty()) throw FileError(group.fault);
        refuse(input,
               fmt::format("holds {} groups of slices that differ in series, size, spacing, "
                           "orientation or kind ({})",
                           groups.size(), listOf(groups)),
               kChoose);
    }
    return chosen;
}

}  // namespace adaptiso::detail
