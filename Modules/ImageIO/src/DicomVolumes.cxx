#include "DicomVolumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

namespace adaptiso::detail {
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
