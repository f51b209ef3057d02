#include "LabelIds.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::labels {
namespace {

/// Integers that a Label may not hold; float samples beyond it are refused later.
template <class T>
constexpr bool kMayBeLarge = std::is_integral_v<T> &&
                             (sizeof(T) > sizeof(Label) || std::is_same_v<T, std::uint32_t>);

constexpr Label kLargest = std::numeric_limits<Label>::max();

template <class T>
LabelId idOf(T sample) {
    if constexpr (std::is_unsigned_v<T>) {
        return LabelId::ofUnsigned(sample);
    } else {
        return LabelId(static_cast<std::int64_t>(sample));
    }
}

bool isLabel(const LabelId& id) {
    return LabelId(-kLargest) <= id && id <= LabelId(kLargest);
}

/// The samples of a map, each run looked up once.
template <class To, class View, class F>
std::vector<To> translated(const View& view, const F& f) {
    const std::int64_t count = view.geometry.voxelCount();
    std::vector<To> samples(static_cast<std::size_t>(count));
    constexpr std::int64_t kGrain = 1 << 16;
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        auto last = view.samples[begin];
        To number = f(last);
        for (std::int64_t n = begin; n < end; ++n) {
            if (view.samples[n] != last) number = f(last = view.samples[n]);
            samples[n] = number;
        }
    });
    return samples;
}

}  // namespace

LabelId LabelId::ofUnsigned(std::uint64_t number) {
    LabelId id;
    id.bits = number;
    return id;
}

std::string idText(const LabelId& id) {
    return id.isNotNegative ? std::to_string(id.bits)
                            : std::to_string(static_cast<std::int64_t>(id.bits));
}

bool takeId(std::string_view& text, LabelId& id) {
    const auto take = [&](auto number) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc()) return false;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        id = idOf(number);
        return true;
    };
    return take(std::int64_t{}) || take(std::uint64_t{});
}

LabelIds::LabelIds(const VolumeView& map, const std::vector<LabelId>& more) {
    bool isLarge = std::ranges::any_of(more, [](const LabelId& id) { return !isLabel(id); });
    dispatchPixelType(map, [&]<class T>(const TypedVolumeView<T>& view) {
        if constexpr (kMayBeLarge<T>) {
            std::unordered_set<T> found;
            const T* const end = view.samples + view.geometry.voxelCount();
            for (const T* at = view.samples; at != end;) {
                const T sample = *at;
                found.insert(sample);
                at = std::find_if(at, end, [&](T other) { return other != sample; });
            }
            for (const T sample : found) {
                const LabelId id = idOf(sample);
                isLarge = isLarge || !isLabel(id);
                if (sample != 0) ids_.push_back(id);
            }
        }
    });
    if (!isLarge || ids_.empty()) {
        ids_.clear();
        return;
    }
    ids_.insert(ids_.end(), more.begin(), more.end());
    std::ranges::sort(ids_);
    ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
    if (std::cmp_greater(ids_.size(), kLargest)) {
        throw InvalidInput("has more labels than can be counted");
    }
}

LabelId LabelIds::of(Label label) const {
    if (!areNumbered() || label == 0) return label;
    return ids_.at(static_cast<std::size_t>(label) - 1);
}

std::optional<Label> LabelIds::find(const LabelId& id) const {
    if (id == LabelId(0)) return 0;
    if (!areNumbered()) {
        if (!isLabel(id)) return std::nullopt;
        return static_cast<Label>(static_cast<std::int64_t>(id.bits));
    }
    const auto at = std::ranges::lower_bound(ids_, id);
    if (at == ids_.end() || *at != id) return std::nullopt;
    return static_cast<Label>(at - ids_.begin() + 1);
}

Volume LabelIds::numbered(const VolumeView& map) const {
    return dispatchPixelType(map, [&]<class T>(const TypedVolumeView<T>& view) -> Volume {
        if constexpr (kMayBeLarge<T>) {
            return Volume::fromSamples(
                translated<Label>(view, [&](T sample) { return find(idOf(sample)).value(); }),
                map.geometry());
        }
        throw InternalError("LabelIds::numbered: labels of 32 bits");
    });
}

Volume LabelIds::withIds(Volume map) const {
    if (!areNumbered()) return map;
    const auto numbers = map.view().as<Label>();
    const ImageGeometry& geometry = map.view().geometry();
    if (!ids_.front().isNotNegative) {
        return Volume::fromSamples(
            translated<std::int64_t>(
                numbers, [&](Label n) { return static_cast<std::int64_t>(of(n).bits); }),
            geometry);
    }
    return Volume::fromSamples(
        translated<std::uint64_t>(numbers, [&](Label n) { return of(n).bits; }), geometry);
}

}  // namespace adaptiso::labels
