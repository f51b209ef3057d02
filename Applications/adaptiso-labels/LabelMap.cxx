#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "Regions.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::labels {
namespace {

using std::int64_t;

struct Count {
    int64_t voxels = 0, runs = 0;
};
using Counts = std::unordered_map<Label, Count>;

constexpr Label kLargestLabel = std::numeric_limits<Label>::max();

template <class T>
bool isLabel(T value) {
    if constexpr (std::is_floating_point_v<T>) {
        constexpr T kEnd = T(2147483648);  // kLargestLabel is no float
        return value == std::floor(value) && std::abs(value) < kEnd;
    } else {
        return std::cmp_less_equal(value, kLargestLabel) &&
               std::cmp_greater_equal(value, -kLargestLabel);
    }
}

template <class T>
std::string faultText(const TypedVolumeView<T>& view, const Index3& at,
                      const std::string& scaling) {
    const T value = view.at(at[0], at[1], at[2]);
    std::string text = "voxel (" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " +
                       std::to_string(at[2]) + ") holds ";
    const auto number = static_cast<double>(value);
    const bool isWhole = std::isfinite(number) && number == std::floor(number);
    text += isWhole ? formatNumber(number) : formatApart({number, std::round(number)}).front();
    text += isWhole ? ", beyond the labels that are read, -2147483647 to 2147483647"
                    : ", which is no whole number, so this is no label map";
    if (scaling.empty()) return text;
    return text + "; its header scales the stored values (" + scaling +
           "): save a label map as integers, without scaling";
}

/// The census of one layer.
template <class T>
void countLayer(const TypedVolumeView<T>& view, int64_t k, const std::string& scaling,
                Counts& counts) {
    const Index3& size = view.geometry.size;
    for (int64_t j = 0; j < size[1]; ++j) {
        for (int64_t i = 0; i < size[0];) {
            const T value = view.at(i, j, k);
            if (!isLabel(value)) throw InvalidInput(faultText(view, {i, j, k}, scaling));
            const int64_t begin = i;
            while (i < size[0] && view.at(i, j, k) == value) ++i;
            if (value == T(0)) continue;
            Count& count = counts[static_cast<Label>(value)];
            count.voxels += i - begin;
            ++count.runs;
        }
    }
}

}  // namespace

bool LabelCensus::looksLikeAnImage() const {
    constexpr std::size_t kFew = 32;  // noise of a few labels is a map that someone made
    constexpr double kShort = 1.3;
    return voxels.size() > kFew && medianRun < kShort;
}

LabelCensus countLabels(const VolumeView& image, const std::string& scaling) {
    Counts all;
    dispatchPixelType(image, [&](const auto& view) {
        const int64_t layers = view.geometry.size[2];
        for (int64_t k = 0; k < layers; ++k) countLayer(view, k, scaling, all);
    });
    LabelCensus census;
    std::vector<double> runs;
    for (const auto& [label, count] : all) {
        census.voxels[label] = count.voxels;
        runs.push_back(static_cast<double>(count.voxels) / static_cast<double>(count.runs));
    }
    if (!runs.empty()) {
        const auto middle = runs.begin() + std::ssize(runs) / 2;
        std::nth_element(runs.begin(), middle, runs.end());
        census.medianRun = *middle;
    }
    return census;
}

LabelId mergedId(const LabelId& id, const std::vector<LabelMerge>& merges) {
    for (const LabelMerge& merge : merges) {
        if (merge.contains(id)) return merge.number();
    }
    return id;
}

namespace {

Label mergedNumber(Label label, const std::vector<LabelMerge>& merges, const LabelIds& ids) {
    return ids.find(mergedId(ids.of(label), merges)).value();
}

}  // namespace

Volume mergeLabels(Volume map, const std::vector<LabelMerge>& merges, const LabelIds& ids) {
    if (merges.empty()) return map;
    const ImageGeometry& geometry = map.view().geometry();
    std::vector<Label> samples(static_cast<std::size_t>(geometry.voxelCount()));
    dispatchPixelType(map, [&](const auto& view) {
        constexpr int64_t kGrain = 1 << 16;
        parallelForPieces(geometry.voxelCount(), kGrain, [&](int64_t begin, int64_t end) {
            auto last = view.samples[begin];
            Label number = mergedNumber(static_cast<Label>(last), merges, ids);
            for (int64_t n = begin; n < end; ++n) {
                if (view.samples[n] != last) {
                    last = view.samples[n];
                    number = mergedNumber(static_cast<Label>(last), merges, ids);
                }
                samples[n] = number;
            }
        });
    });
    return Volume::fromSamples(std::move(samples), geometry);
}

LabelCensus mergeCounts(LabelCensus census, const std::vector<LabelMerge>& merges,
                        const LabelIds& ids) {
    std::map<Label, int64_t> merged;
    for (const auto& [label, count] : census.voxels) {
        merged[mergedNumber(label, merges, ids)] += count;
    }
    census.voxels = std::move(merged);
    return census;
}

}  // namespace adaptiso::labels
