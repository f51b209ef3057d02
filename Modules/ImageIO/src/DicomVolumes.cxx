#include "DicomVolumes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace adaptiso::detail {
namespace {

constexpr double kSamePlaceMm = 1e-3;

using Places = std::vector<std::vector<std::size_t>>;
using Key = std::function<std::vector<double>(const DicomPlane&)>;

constexpr std::array<std::string_view, kDicomLabels> kLabelNames = {
    "echoes", "time points", "cardiac phases", "diffusion weightings", "acquisitions"};

std::vector<double> allLabels(const DicomPlane& plane) {
    std::vector<double> all;
    for (const auto& label : plane.labels) {
        all.push_back(static_cast<double>(label.size()));
        all.insert(all.end(), label.begin(), label.end());
    }
    return all;
}

/// Volume n takes the plane with the n-th key of every place.
/// \param sameKeys  the keys must be the same at every place, not only different
/// \return none unless the keys at every place differ
std::vector<std::vector<DicomPlane>> splitBy(const std::vector<DicomPlane>& planes,
                                             const Places& places, const Key& key, bool sameKeys) {
    std::vector<std::vector<DicomPlane>> volumes(places.front().size());
    std::vector<std::vector<double>> firstKeys;
    for (const auto& place : places) {
        std::vector<std::pair<std::vector<double>, std::size_t>> keyed;
        for (const std::size_t n : place) keyed.emplace_back(key(planes[n]), n);
        std::ranges::sort(keyed);
        std::vector<std::vector<double>> keys;
        for (const auto& [value, n] : keyed) keys.push_back(value);
        if (std::ranges::adjacent_find(keys) != keys.end()) return {};
        if (firstKeys.empty()) firstKeys = keys;
        if (sameKeys && keys != firstKeys) return {};
        for (std::size_t v = 0; v < keyed.size(); ++v) {
            volumes[v].push_back(planes[keyed[v].second]);
        }
    }
    return volumes;
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
    if (count == 1) return {splitBy(planes, places, allLabels, false), ""};
    for (std::size_t label = 0; label < kDicomLabels; ++label) {
        const Key key = [label](const DicomPlane& plane) { return plane.labels[label]; };
        auto volumes = splitBy(planes, places, key, true);
        if (!volumes.empty()) return {std::move(volumes), kLabelNames[label]};
    }
    auto volumes = splitBy(planes, places, allLabels, true);
    if (volumes.empty()) {
        const Key number = [](const DicomPlane& plane) { return plane.order; };
        volumes = splitBy(planes, places, number, false);
    }
    return {std::move(volumes), "images at every position"};
}

}  // namespace adaptiso::detail
