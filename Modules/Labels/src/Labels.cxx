#include "adaptiso/Labels/Labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"

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
    std::vector<Label> labels;
    dispatchPixelType(volume, [&](const auto& view) {
        Label last = 0;
        for (std::int64_t n = 0; n < view.geometry.voxelCount(); ++n) {
            const Label label = toLabel(view.samples[n]);
            if (label == last) continue;
            last = label;
            const auto at = std::lower_bound(labels.begin(), labels.end(), label);
            if (label != 0 && (at == labels.end() || *at != label)) labels.insert(at, label);
        }
    });
    return labels;
}

LabelResult extractLabels(const VolumeView&, const LabelOptions&) {
    throw InternalError("extractLabels: not there yet");
}

}  // namespace adaptiso
