#include "DicomGroups.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "DicomPixels.h"
#include "DicomVolumes.h"
#include "FileFault.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace {

constexpr double kSameDirection = 1e-4;  // 0.025 mm across a 250 mm field of view

bool isSame(const std::optional<double>& a, const std::optional<double>& b) {
    return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= kSameDirection * *a);
}

bool isSame(const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
    return a.has_value() == b.has_value() && (!a || norm(*a - *b) <= kSameDirection);
}

bool belongs(const DicomGroup& group, const DicomGroup& candidate) {
    if (group.seriesUid != candidate.seriesUid) return false;
    if (group.fault.empty() != candidate.fault.empty()) return false;
    if (group.isSecondary != candidate.isSecondary) return false;
    if (group.isLocalizer != candidate.isLocalizer) return false;
    if (!group.fault.empty()) return true;
    const DicomPlane& a = group.planes.front();
    const DicomPlane& b = candidate.planes.front();
    return group.columns == candidate.columns && group.rows == candidate.rows &&
           isSame(a.alongRow, b.alongRow) && isSame(a.alongColumn, b.alongColumn) &&
           isSame(a.columnStepMm, b.columnStepMm) && isSame(a.rowStepMm, b.rowStepMm);
}

/// Every image is compared with every group found before it, and groups with one another.
void requireFewGroups(std::size_t count, const DicomFile& at) {
    constexpr std::size_t kMostGroups = 1000;
    if (count <= kMostGroups) return;
    refuse(
        at.path,
        fmt::format("here the images come to differ in more than {} ways (series, size, spacing, "
                    "orientation, kind)",
                    kMostGroups),
        "give the folder of one study");
}

void addTo(std::vector<DicomGroup>& groups, DicomGroup candidate,
           const std::vector<DicomFile>& files) {
    const auto known = std::ranges::find_if(
        groups, [&](const DicomGroup& group) { return belongs(group, candidate); });
    if (known == groups.end()) {
        requireFewGroups(groups.size() + 1, files[candidate.planes.front().file]);
        groups.push_back(std::move(candidate));
    } else {
        known->planes.push_back(std::move(candidate.planes.front()));
    }
}

bool saysLocalizer(std::string_view imageType) {
    for (const std::string_view word : {"LOCALIZER", "SCOUT", "TOPOGRAM", "SURVIEW"}) {
        if (imageType.find(word) != std::string_view::npos) return true;
    }
    return false;
}

bool isSecondary(const DicomHeader& header) {
    const auto photometric = header.dataset.text(tag::kPhotometric).value_or("");
    const bool isCapture = header.mediaStorage.starts_with("1.2.840.10008.5.1.4.1.1.7");
    return !photometric.starts_with("MONOCHROME") ||
           (isCapture && !header.dataset.text(tag::kImagePosition));
}

/// One file's planes, each as a group of its own; of a file that can't be read a single one.
std::vector<DicomGroup> groupsOf(const DicomFile& dicom, std::size_t number) {
    const DicomDataset& set = dicom.header.dataset;
    DicomGroup group;
    group.seriesUid = set.text(tag::kSeriesInstanceUid).value_or("");
    group.modality = set.text(tag::kModality).value_or("");
    group.description = dicom.header.seriesDescription;
    group.isSecondary = isSecondary(dicom.header);
    group.isLocalizer = saysLocalizer(set.text(tag::kImageType).value_or(""));
    group.rows = set.integer(tag::kRows).value_or(0);
    group.columns = set.integer(tag::kColumns).value_or(0);
    std::vector<DicomGroup> groups;
    try {
        const DicomPixelFormat format = dicomPixelFormat(dicom);
        const DicomFrames frames(dicom, format);  // finds out whether they can be read
        DicomFilePlanes found = dicomPlanes(dicom, format);
        group.columns = found.columns;
        group.rows = found.rows;
        group.isMosaic = found.isMosaic;
        for (DicomPlane& plane : found.planes) {
            plane.file = number;
            groups.push_back(group);
            groups.back().isLocalizer |= saysLocalizer(plane.imageType);
            groups.back().planes.push_back(std::move(plane));
        }
    } catch (const FileError& error) {
        group.fault = error.what();
        group.planes.emplace_back().file = number;
        groups = {std::move(group)};
    }
    return groups;
}

/// Magnitude and phase, ...: where images of several kinds lie at one place, a group for each.
std::vector<DicomGroup> splitByImageType(const DicomGroup& group,
                                         const std::vector<DicomFile>& files) {
    if (!group.fault.empty() || !group.isPlaced()) return {group};
    const bool isMixed = std::ranges::any_of(dicomPlaces(group.planes), [&](const auto& place) {
        return std::ranges::any_of(place, [&](std::size_t n) {
            return group.planes[n].imageType != group.planes[place.front()].imageType;
        });
    });
    if (!isMixed) return {group};
    DicomGroup empty = group;
    empty.planes.clear();
    std::map<std::string, DicomGroup> byType;
    for (const DicomPlane& plane : group.planes) {
        byType.try_emplace(plane.imageType, empty).first->second.planes.push_back(plane);
        requireFewGroups(byType.size(), files[plane.file]);
    }
    std::vector<DicomGroup> parts;
    for (auto& [type, part] : byType) parts.push_back(std::move(part));
    return parts;
}

/// A series of few slices in each of several directions is there to plan other scans.
void markSurveys(std::vector<DicomGroup>& groups) {
    constexpr std::size_t kMostSlices = 30;
    for (DicomGroup& group : groups) {
        if (!group.fault.empty() || !group.isPlaced()) continue;
        std::size_t slices = 0, most = 0;
        bool hasDirections = false;
        for (const DicomGroup& other : groups) {
            if (other.seriesUid != group.seriesUid) continue;
            if (!other.fault.empty() || !other.isPlaced()) continue;
            slices += other.planes.size();
            most = std::max(most, other.planes.size());
            hasDirections |= !areParallelPlanes(group, other);
        }
        if (hasDirections && most <= kMostSlices && 4 * most < 3 * slices) {
            group.isLocalizer = true;
        }
    }
}

}  // namespace

bool DicomGroup::isPlaced() const {
    return std::ranges::all_of(planes, [](const DicomPlane& plane) {
        return plane.position && plane.alongRow && plane.alongColumn && plane.columnStepMm &&
               plane.rowStepMm && norm(cross(*plane.alongRow, *plane.alongColumn)) > 0.5;
    });
}

bool areParallelPlanes(const DicomGroup& a, const DicomGroup& b) {
    constexpr double kCosine5Deg = 0.9962;
    const auto normal = [](const DicomGroup& group) {
        const DicomPlane& plane = group.planes.front();
        return normalized(cross(*plane.alongRow, *plane.alongColumn));
    };
    return std::abs(dot(normal(a), normal(b))) > kCosine5Deg;
}

std::vector<DicomGroup> groupDicomPlanes(const std::vector<DicomFile>& files) {
    std::vector<DicomGroup> byGeometry, groups;
    for (std::size_t n = 0; n < files.size(); ++n) {
        for (DicomGroup& plane : groupsOf(files[n], n)) addTo(byGeometry, std::move(plane), files);
    }
    for (const DicomGroup& group : byGeometry) {
        for (DicomGroup& part : splitByImageType(group, files)) groups.push_back(std::move(part));
        requireFewGroups(groups.size(), files[group.planes.front().file]);
    }
    markSurveys(groups);
    return groups;
}

std::string_view orientationName(const DicomGroup& group) {
    const DicomPlane& plane = group.planes.front();
    if (!plane.alongRow || !plane.alongColumn) return "unknown";
    const Vec3 normal = cross(*plane.alongRow, *plane.alongColumn);
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    return x >= y && x >= z ? "sagittal" : y >= z ? "coronal" : "axial";
}

std::string describeDicomGroup(const DicomGroup& group) {
    const DicomPlane& first = group.planes.front();
    const std::size_t count = group.planes.size();
    std::string text =
        fmt::format("{} slice{} of {} x {} voxels, {} orientation", count, count > 1 ? "s" : "",
                    group.columns, group.rows, orientationName(group));
    if (first.columnStepMm) {
        text += fmt::format(", {} x {} mm", number(*first.columnStepMm), number(*first.rowStepMm));
    }
    if (group.isLocalizer) text += ", localizer";
    if (group.isSecondary) text += ", screenshot or colour";
    if (!group.fault.empty()) text += ", can't be read";
    return text;
}

}  // namespace adaptiso::detail
