#include "LabelGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

namespace {

template <class T>
Label toLabel(T sample) {
    using Limits = std::numeric_limits<Label>;
    bool isLabel = false;
    if constexpr (std::is_floating_point_v<T>) {
        isLabel = sample >= static_cast<T>(Limits::min()) &&
                  sample < -static_cast<T>(Limits::min()) && std::floor(sample) == sample;
    } else {
        isLabel = std::in_range<Label>(sample);
    }
    if (!isLabel) {
        throw NotALabelMap("a label map holds whole numbers of 32 bits, this one " +
                           std::to_string(sample));
    }
    return static_cast<Label>(sample);
}

/// Voxels from `low` to `high`, both of them; empty at first.
struct VoxelBox {
    Index3 low{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max(),
               std::numeric_limits<std::int64_t>::max()};
    Index3 high{-1, -1, -1};

    void include(const Index3& from, const Index3& to) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], from[axis]);
            high[axis] = std::max(high[axis], to[axis]);
        }
    }
};

/// The voxels of chosen labels, and which of these are there.
struct Chosen {
    VoxelBox box;
    std::vector<std::uint8_t> isThere;
};

template <class T>
Chosen findIn(const TypedVolumeView<T>& view, const std::vector<Label>& chosen, std::int64_t k) {
    Chosen found{{}, std::vector<std::uint8_t>(chosen.size(), 0)};
    const Index3& size = view.geometry.size;
    for (std::int64_t j = 0; j < size[1]; ++j) {
        const T* const row = &view.at(0, j, k);
        for (std::int64_t i = 0; i < size[0];) {
            const std::int64_t begin = i;
            const Label label = toLabel(row[i]);
            while (i < size[0] && row[i] == row[begin]) ++i;
            const auto at = std::lower_bound(chosen.begin(), chosen.end(), label);
            if (at == chosen.end() || *at != label) continue;
            found.isThere[at - chosen.begin()] = 1;
            found.box.include({begin, j, k}, {i - 1, j, k});
        }
    }
    return found;
}

Chosen findChosen(const VolumeView& volume, const std::vector<Label>& chosen) {
    const std::int64_t layers = volume.geometry().size[2];
    std::vector<Chosen> found(layers);
    dispatchPixelType(volume, [&](const auto& view) {
        parallelForPieces(
            layers, 1, [&](std::int64_t k, std::int64_t) { found[k] = findIn(view, chosen, k); });
    });
    Chosen all = found.front();
    for (const Chosen& one : found) {
        all.box.include(one.box.low, one.box.high);
        for (std::size_t n = 0; n < chosen.size(); ++n) all.isThere[n] |= one.isThere[n];
    }
    return all;
}

/// The box of the chosen labels and a layer round it. \throws InvalidInput  one is not in the map
VoxelBox boxOf(const VolumeView& volume, const std::vector<Label>& chosen) {
    const Chosen found = findChosen(volume, chosen);
    for (std::size_t n = 0; n < chosen.size(); ++n) {
        const bool isTwice = n > 0 && chosen[n] == chosen[n - 1];
        if (found.isThere[n] != 0 && chosen[n] != 0 && !isTwice) continue;
        throw InvalidInput("label " + std::to_string(chosen[n]) +
                           (isTwice ? " is chosen twice" : " is chosen, but not in the map"));
    }
    VoxelBox box = found.box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::max<std::int64_t>(box.low[axis] - 1, 0);
        box.high[axis] = std::min(box.high[axis] + 1, volume.geometry().size[axis] - 1);
    }
    return box;
}

}  // namespace

std::vector<Label> findLabels(const VolumeView& volume) {
    std::unordered_set<Label> found;  // a map may have tens of thousands
    dispatchPixelType(volume, [&](const auto& view) {
        Label last = 0;
        for (std::int64_t n = 0; n < view.geometry.voxelCount(); ++n) {
            const Label label = toLabel(view.samples[n]);
            if (label != last && label != 0) found.insert(label);
            last = label;
        }
    });
    std::vector<Label> labels(found.begin(), found.end());
    std::sort(labels.begin(), labels.end());
    return labels;
}

namespace detail {

bool LabelGrid::isWanted(Label label) const {
    return chosen.empty() || std::binary_search(chosen.begin(), chosen.end(), label);
}

ImageGeometry LabelGrid::partOf(const ImageGeometry& whole) const {
    ImageGeometry part = whole;
    part.size = {size[0] - 2, size[1] - 2, size[2] - 2};
    part.originMm = whole.toPhysical({static_cast<double>(first[0]), static_cast<double>(first[1]),
                                      static_cast<double>(first[2])});
    return part;
}

LabelGrid makeGrid(const VolumeView& volume, std::vector<Label> chosen) {
    LabelGrid grid;
    std::sort(chosen.begin(), chosen.end());
    VoxelBox box;
    if (chosen.empty()) {
        const Index3& size = volume.geometry().size;
        box.include({0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1});
    } else {
        box = boxOf(volume, chosen);
    }
    grid.chosen = std::move(chosen);
    grid.first = box.low;
    for (int axis = 0; axis < 3; ++axis) grid.size[axis] = box.high[axis] - box.low[axis] + 3;
    grid.labels.assign(static_cast<std::size_t>(grid.size[0] * grid.size[1] * grid.size[2]), 0);
    dispatchPixelType(volume, [&](const auto& view) {
        parallelForPieces(grid.size[2] - 2, 1, [&](std::int64_t k, std::int64_t) {
            for (std::int64_t j = 0; j < grid.size[1] - 2; ++j) {
                const auto* row = &view.at(box.low[0], box.low[1] + j, box.low[2] + k);
                std::transform(row, row + (grid.size[0] - 2),
                               &grid.labels[grid.placeOf(1, j + 1, k + 1)],
                               [](auto sample) { return toLabel(sample); });
            }
        });
    });
    return grid;
}

}  // namespace detail

}  // namespace adaptiso
