#include "DicomGroups.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "DicomPixels.h"
#include "FileFault.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {

namespace {

constexpr double kSameDirection = 1e-4;  // 0.025 mm across a 250 mm field of view

bool isSame(const std::optional<double>& a, const std::optional<double>& b) {
    return a.has_value() == b.has_value() &&
           (!a || std::abs(*a - *b) <= kSameDirection * std::abs(*a));
}

bool isSame(const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
    return a.has_value() == b.has_value() && (!a || norm(*a - *b) <= kSameDirection);
}

/// All but the UIDs of series, study and frame of reference agrees.
bool isAlike(const DicomGroup& group, const DicomGroup& candidate) {
    if (group.patient != candidate.patient || group.segment != candidate.segment ||
        group.isSegmentation != candidate.isSegmentation) {
        return false;
    }
    if (group.fault.empty() != candidate.fault.empty()) return false;
    if (group.isSecondary != candidate.isSecondary) return false;
    if (group.isScreenshot != candidate.isScreenshot) return false;
    if (group.isLocalizer != candidate.isLocalizer) return false;
    if (!group.fault.empty()) return true;
    const DicomPlane& a = group.planes.front();
    const DicomPlane& b = candidate.planes.front();
    if (group.isSegmentation && a.file != b.file) return false;
    return group.columns == candidate.columns && group.rows == candidate.rows &&
           isSame(a.alongRow, b.alongRow) && isSame(a.alongColumn, b.alongColumn) &&
           isSame(a.columnStepMm, b.columnStepMm) && isSame(a.rowStepMm, b.rowStepMm);
}

bool belongs(const DicomGroup& group, const DicomGroup& candidate) {
    return group.seriesUid == candidate.seriesUid && group.study == candidate.study &&
           group.frameOfReference == candidate.frameOfReference && isAlike(group, candidate);
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

bool isSegmentation(const DicomHeader& header) {
    constexpr std::string_view kSegmentation = "1.2.840.10008.5.1.4.1.1.66.4";
    constexpr std::string_view kLabelMap = "1.2.840.10008.5.1.4.1.1.66.7";
    return header.mediaStorage == kSegmentation || header.mediaStorage == kLabelMap;
}

std::string segmentLabel(const DicomDataset& set, std::int64_t number) {
    const auto segments = set.sequences.find(tag::kSegmentSequence);
    if (segments == set.sequences.end()) return {};
    for (const DicomDataset& segment : segments->second) {
        if (segment.integer(tag::kSegmentNumber) != number) continue;
        return plainDicomText(segment.text(tag::kSegmentLabel).value_or("").substr(0, 80));
    }
    return {};
}

/// One file's planes, each as a group of its own; of a file that can't be read a single one.
std::vector<DicomGroup> groupsOf(const DicomFile& dicom, std::size_t number) {
    const DicomDataset& set = dicom.header.dataset;
    DicomGroup group;
    group.seriesUid = set.text(tag::kSeriesInstanceUid).value_or("");
    group.modality = set.text(tag::kModality).value_or("");
    group.description = dicom.header.seriesDescription;
    group.isSecondary = isSecondary(dicom.header);
    group.isScreenshot = group.isSecondary && !set.text(tag::kImagePosition) &&
                         !set.sequences.contains(tag::kPerFrameFunctionalGroups);
    group.isSegmentation = isSegmentation(dicom.header);
    group.isLocalizer = saysLocalizer(set.text(tag::kImageType).value_or(""));
    const auto digest = [&](DicomTag tag) { return std::string(set.text(tag).value_or("")); };
    group.patient = digest(tag::kPatientId) + "|" + digest(tag::kPatientName) + "|" +
                    digest(tag::kPatientBirthDate);
    group.study = digest(tag::kStudyInstanceUid);
    group.frameOfReference = digest(tag::kFrameOfReferenceUid);
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
            groups.back().segment = plane.segment;
            if (plane.segment) groups.back().segmentLabel = segmentLabel(set, *plane.segment);
            groups.back().planes.push_back(std::move(plane));
        }
    } catch (const FileError& error) {
        group.fault = error.what();
        group.planes.emplace_back().file = number;
        groups = {std::move(group)};
    }
    return groups;
}

using Kind = std::string DicomPlane::*;

/// Magnitude and phase, ...: where images of several kinds lie at one place, a group for each.
std::vector<DicomGroup> splitByKind(const DicomGroup& group, Kind kind,
                                    const std::vector<DicomFile>& files) {
    if (!group.fault.empty() || !group.isPlaced()) return {group};
    const bool isMixed = std::ranges::any_of(dicomPlaces(group.planes), [&](const auto& place) {
        return std::ranges::any_of(place, [&](std::size_t n) {
            return group.planes[n].*kind != group.planes[place.front()].*kind;
        });
    });
    if (!isMixed) return {group};
    DicomGroup empty = group;
    empty.planes.clear();
    std::map<std::string, DicomGroup> byKind;
    for (const DicomPlane& plane : group.planes) {
        byKind.try_emplace(plane.*kind, empty).first->second.planes.push_back(plane);
        requireFewGroups(byKind.size(), files[plane.file]);
    }
    std::vector<DicomGroup> parts;
    for (auto& [value, part] : byKind) parts.push_back(std::move(part));
    return parts;
}

/// A text of the header, its first 80 characters, where all planes of the group share it.
std::string sharedText(const DicomGroup& group, DicomTag tag, const std::vector<DicomFile>& files) {
    const auto textOf = [&](const DicomPlane& plane) {
        return files[plane.file].header.dataset.text(tag).value_or("");
    };
    const std::string_view first = textOf(group.planes.front());
    const auto isFirst = [&](const DicomPlane& plane) { return textOf(plane) == first; };
    return std::ranges::all_of(group.planes, isFirst) ? plainDicomText(first.substr(0, 80)) : "";
}

bool isLoneSlice(const DicomGroup& group) {
    return group.planes.size() == 1 && group.fault.empty() && group.isPlaced() &&
           !group.isLocalizer && !group.isSecondary && !group.isSegmentation;
}

/// Lone slices that can only be of one series: UIDs differ, all else that separates series
/// agrees.
bool areOneSeries(const DicomGroup& a, const DicomGroup& b, const std::vector<DicomFile>& files) {
    const auto isShared = [&](DicomTag tag) {
        return sharedText(a, tag, files) == sharedText(b, tag, files);
    };
    if (!isLoneSlice(b) || !isAlike(a, b) || a.modality != b.modality ||
        a.planes[0].imageType != b.planes[0].imageType ||
        a.planes[0].kernel != b.planes[0].kernel || !isShared(tag::kSeriesNumber) ||
        !isShared(tag::kEchoTime)) {
        return false;
    }
    if (a.seriesUid == b.seriesUid) return true;
    return a.study == b.study && !a.study.empty() && a.frameOfReference == b.frameOfReference &&
           !a.frameOfReference.empty() && !sharedText(a, tag::kSeriesNumber, files).empty() &&
           a.planes[0].order != b.planes[0].order;
}

/// Some tools write new UIDs of series, study or frame of reference into every slice.
void joinLoneSlices(std::vector<DicomGroup>& groups, const std::vector<DicomFile>& files) {
    constexpr std::size_t kFewest = 3;
    for (std::size_t n = 0; n < groups.size(); ++n) {
        if (!isLoneSlice(groups[n])) continue;
        DicomGroup joined = groups[n];
        std::vector<std::size_t> members{n};
        for (std::size_t other = n + 1; other < groups.size(); ++other) {
            if (!areOneSeries(groups[n], groups[other], files)) continue;
            members.push_back(other);
            joined.planes.push_back(groups[other].planes[0]);
        }
        if (members.size() < kFewest || dicomPlaces(joined.planes).size() < members.size()) {
            continue;
        }
        const bool isSeries = groups[members[1]].seriesUid != joined.seriesUid;
        joined.warnings.push_back(
            {"uids-differ",
             fmt::format("each of its {} slices has a {} of its own: read as one series, for "
                         "patient, series number, kind, size and spacing agree",
                         members.size(),
                         isSeries                                   ? "SeriesInstanceUID"
                         : groups[members[1]].study != joined.study ? "StudyInstanceUID"
                                                                    : "FrameOfReferenceUID")});
        groups[n] = std::move(joined);
        for (std::size_t m = members.size(); m-- > 1;) {
            groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(members[m]));
        }
    }
}

/// The segments of one file share their frames' places.
void addFramePositions(std::vector<DicomGroup>& groups) {
    for (DicomGroup& group : groups) {
        if (!group.isSegmentation || !group.fault.empty() || !group.isPlaced()) continue;
        for (const DicomGroup& other : groups) {
            if (other.planes[0].file != group.planes[0].file || !other.isPlaced()) continue;
            for (const DicomPlane& plane : other.planes) {
                group.framePositions.push_back(*plane.position);
            }
        }
    }
}

/// Each of the groups' values, numbered in the order they come.
std::vector<std::string> numbered(const std::vector<DicomGroup>& groups,
                                  std::string DicomGroup::*value) {
    std::vector<std::string> known, numbers;
    for (const DicomGroup& group : groups) {
        auto it = std::ranges::find(known, group.*value);
        if (it == known.end()) it = known.insert(it, group.*value);
        numbers.push_back(std::to_string(it - known.begin() + 1));
    }
    return numbers;
}

/// Values that differ between the groups; no names, no ids.
void addDetails(std::vector<DicomGroup>& groups, const std::vector<DicomFile>& files) {
    const auto add = [&](const char* keyword, const std::vector<std::string>& values) {
        const auto isFirst = [&](const std::string& value) { return value == values.front(); };
        if (std::ranges::all_of(values, isFirst)) return;
        for (std::size_t n = 0; n < groups.size(); ++n) {
            if (!values[n].empty()) groups[n].details.emplace_back(keyword, values[n]);
        }
    };
    add("Patient", numbered(groups, &DicomGroup::patient));
    add("Study", numbered(groups, &DicomGroup::study));
    add("FrameOfReference", numbered(groups, &DicomGroup::frameOfReference));
    constexpr std::pair<const char*, DicomTag> kTexts[] = {
        {"SeriesNumber", tag::kSeriesNumber},
        {"ImageType", tag::kImageType},
        {"ConvolutionKernel", tag::kConvolutionKernel},
        {"EchoTime", tag::kEchoTime},
        {"DiffusionBValue", tag::kDiffusionBValue},
        {"AcquisitionNumber", tag::kAcquisitionNumber}};
    for (const auto& [keyword, tag] : kTexts) {
        std::vector<std::string> values;
        for (const DicomGroup& group : groups) values.push_back(sharedText(group, tag, files));
        add(keyword, values);
    }
    std::vector<std::string> types;
    for (const DicomGroup& group : groups) {
        const std::string& type = group.planes.front().imageType;
        const bool isOfFrames = files[group.planes.front().file].header.dataset.sequences.contains(
            tag::kPerFrameFunctionalGroups);
        types.push_back(isOfFrames ? plainDicomText(type.substr(0, type.find_last_not_of('|') + 1))
                                   : "");
    }
    add("FrameType", types);
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
        for (const DicomGroup& part : splitByKind(group, &DicomPlane::imageType, files)) {
            for (DicomGroup& one : splitByKind(part, &DicomPlane::kernel, files)) {
                groups.push_back(std::move(one));
            }
        }
        requireFewGroups(groups.size(), files[group.planes.front().file]);
    }
    joinLoneSlices(groups, files);
    markSurveys(groups);
    addFramePositions(groups);
    addDetails(groups, files);
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
    if (group.segment) text += fmt::format(", segment {}", *group.segment);
    if (!group.segmentLabel.empty()) text += fmt::format(" '{}'", group.segmentLabel);
    for (const auto& [keyword, value] : group.details) text += ", " + keyword + " " + value;
    if (!group.fault.empty()) text += ", can't be read";
    return text;
}

namespace {

constexpr double kSamePlaceMm = 1e-3;

using Places = std::vector<std::vector<std::size_t>>;
/// The planes of each volume, by place.
using Volumes = std::vector<std::vector<std::size_t>>;
using Numbers = std::vector<double>;
using Key = std::function<Numbers(const DicomPlane&)>;

constexpr std::array<std::string_view, kDicomLabels> kLabelNames = {
    "echoes", "time points", "cardiac phases", "diffusion weightings", "acquisitions"};

Numbers allLabels(const DicomPlane& plane) {
    Numbers all;
    for (const auto& label : plane.labels) {
        all.push_back(static_cast<double>(label.size()));
        all.insert(all.end(), label.begin(), label.end());
    }
    return all;
}

/// Volume n takes the plane with the n-th key of every place.
/// \return none unless the keys at every place differ
Volumes sortedBy(const std::vector<DicomPlane>& planes, const Places& places, const Key& key) {
    Volumes volumes(places.front().size());
    for (const auto& place : places) {
        std::vector<std::pair<Numbers, std::size_t>> keyed;
        for (const std::size_t n : place) keyed.emplace_back(key(planes[n]), n);
        std::ranges::sort(keyed);
        const auto isSame = [](const auto& a, const auto& b) { return a.first == b.first; };
        if (std::ranges::adjacent_find(keyed, isSame) != keyed.end()) return {};
        for (std::size_t v = 0; v < keyed.size(); ++v) volumes[v].push_back(keyed[v].second);
    }
    return volumes;
}

/// Every volume has one key.
Volumes splitByLabel(const std::vector<DicomPlane>& planes, const Places& places, const Key& key) {
    Volumes volumes = sortedBy(planes, places, key);
    for (const auto& volume : volumes) {
        const Numbers first = key(planes[volume.front()]);
        const auto isFirst = [&](std::size_t n) { return key(planes[n]) == first; };
        if (!std::ranges::all_of(volume, isFirst)) return {};
    }
    return volumes;
}

/// Numbers that begin anew tell no pass.
bool repeatsNumber(const std::vector<DicomPlane>& planes) {
    std::map<Numbers, std::size_t> files;
    return std::ranges::any_of(planes, [&](const DicomPlane& plane) {
        return files.try_emplace(plane.order, plane.file).first->second != plane.file;
    });
}

bool isMonotonic(const std::vector<Numbers>& keys) {
    return std::ranges::is_sorted(keys) || std::ranges::is_sorted(keys, std::greater<>());
}

/// From place to place both go the same steps.
bool areParallel(const std::vector<Numbers>& a, const std::vector<Numbers>& b) {
    constexpr double kSameStep = 1e-6;
    for (std::size_t p = 0; p < a.size(); ++p) {
        if (a[p].size() != a[0].size() || b[p].size() != a[0].size()) return false;
        for (std::size_t n = 0; n < a[p].size(); ++n) {
            if (!(std::abs((a[p][n] - a[0][n]) - (b[p][n] - b[0][n])) <= kSameStep)) return false;
        }
    }
    return true;
}

enum class PassOrder { OneAfterTheOther, OrInterleaved };

struct Passes {
    Volumes volumes;
    bool areOrdered = true;  ///< each goes up or down the places
};

/// Every volume is one pass over the places, one after the other or all with the same steps. Unless
/// passes are ordered too, halves of two may look like one.
Passes splitByPass(const std::vector<DicomPlane>& planes, const Places& places, const Key& key,
                   PassOrder order) {
    Passes passes{sortedBy(planes, places, key)};
    std::vector<std::vector<Numbers>> keys;
    for (const auto& volume : passes.volumes) {
        auto& own = keys.emplace_back();
        for (const std::size_t n : volume) own.push_back(key(planes[n]));
    }
    bool areInterleaved = order == PassOrder::OrInterleaved, areBlocks = true;
    for (std::size_t v = 0; v < keys.size(); ++v) {
        passes.areOrdered = passes.areOrdered && isMonotonic(keys[v]);
        areInterleaved = areInterleaved && areParallel(keys[0], keys[v]);
        areBlocks =
            areBlocks && (v == 0 || std::ranges::max(keys[v - 1]) < std::ranges::min(keys[v]));
    }
    if (!areInterleaved && !areBlocks) passes.volumes.clear();
    return passes;
}

bool isSamePartition(Volumes a, Volumes b) {
    std::ranges::sort(a);
    std::ranges::sort(b);
    return a == b;
}

}  // namespace

std::vector<std::vector<std::size_t>> dicomPlaces(const std::vector<DicomPlane>& planes) {
    const Vec3 normal = normalized(cross(*planes.front().alongRow, *planes.front().alongColumn));
    const auto place = [&](std::size_t n) { return dot(*planes[n].position, normal); };
    std::vector<std::size_t> sorted(planes.size());
    std::iota(sorted.begin(), sorted.end(), std::size_t{0});
    std::ranges::stable_sort(sorted, {}, place);
    Places places;
    for (const std::size_t n : sorted) {
        if (places.empty() || place(n) - place(places.back().front()) >= kSamePlaceMm) {
            places.emplace_back();
        }
        places.back().push_back(n);
    }
    return places;
}

DicomVolumes splitDicomVolumes(const std::vector<DicomPlane>& planes) {
    const Places places = dicomPlaces(planes);
    const std::size_t count = places.front().size();
    const bool isEven =
        std::ranges::all_of(places, [&](const auto& place) { return place.size() == count; });
    if (!isEven) return {};
    struct Split {
        Volumes volumes;
        std::string_view kind;
    };
    std::vector<Split> found;
    std::vector<Volumes> witnesses;  // against labels
    const auto add = [&](Volumes volumes, std::string_view kind) {
        if (!volumes.empty()) found.push_back({std::move(volumes), kind});
    };
    if (count == 1) {
        add(sortedBy(planes, places, allLabels), "");
    } else {
        for (std::size_t label = 0; label < kDicomLabels; ++label) {
            const Key key = [label](const DicomPlane& plane) { return plane.labels[label]; };
            add(splitByLabel(planes, places, key), kLabelNames[label]);
        }
        constexpr std::string_view kUnnamed = "images at every position";
        if (found.empty()) add(splitByLabel(planes, places, allLabels), kUnnamed);
        const bool hasLabels = !found.empty();
        const auto addPasses = [&](Passes passes, std::string_view kind) {
            if (passes.areOrdered) {
                add(std::move(passes.volumes), kind);
            } else if (hasLabels && !passes.volumes.empty()) {
                witnesses.push_back(std::move(passes.volumes));
            }
        };
        const auto time = [](const DicomPlane& plane) { return plane.time; };
        addPasses(splitByPass(planes, places, time, PassOrder::OneAfterTheOther),
                  "acquisition times");
        const auto number = [](const DicomPlane& plane) { return plane.order; };
        if (!repeatsNumber(planes)) {
            addPasses(splitByPass(planes, places, number, PassOrder::OrInterleaved), kUnnamed);
        }
    }
    if (found.empty()) return {};
    for (const Split& split : found) witnesses.push_back(split.volumes);
    for (const Volumes& witness : witnesses) {
        if (!isSamePartition(witness, found.front().volumes)) return {};
    }
    DicomVolumes split{{}, found.front().kind};
    for (const auto& volume : found.front().volumes) {
        auto& taken = split.volumes.emplace_back();
        for (const std::size_t n : volume) taken.push_back(planes[n]);
    }
    return split;
}

}  // namespace adaptiso::detail
