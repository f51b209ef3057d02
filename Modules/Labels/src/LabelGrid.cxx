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
        throw InvalidInput("a label map holds whole numbers of 32 bits, this one " +
                           std::to_string(sample));
    }
    return static_cast<Label>(sample);
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

LabelGrid makeGrid(const VolumeView& volume) {
    const Index3& own = volume.geometry().size;
    LabelGrid grid;
    grid.size = {own[0] + 2, own[1] + 2, own[2] + 2};
    grid.labels.assign(static_cast<std::size_t>(grid.size[0] * grid.size[1] * grid.size[2]), 0);
    dispatchPixelType(volume, [&](const auto& view) {
        parallelForPieces(own[2], 1, [&](std::int64_t k, std::int64_t) {
            for (std::int64_t j = 0; j < own[1]; ++j) {
                const auto* row = &view.at(0, j, k);
                std::transform(row, row + own[0], &grid.labels[grid.placeOf(1, j + 1, k + 1)],
                               [](auto sample) { return toLabel(sample); });
            }
        });
    });
    return grid;
}

}  // namespace detail
}  // namespace adaptiso
