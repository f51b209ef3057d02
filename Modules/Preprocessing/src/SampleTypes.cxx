#include "SampleTypes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <type_traits>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = std::int64_t{1} << 18;

}  // namespace

PixelType blendedType(PixelType stored) {
    const bool fits = bytesPerPixel(stored) <= 2 || stored == PixelType::Float32;
    return fits ? PixelType::Float32 : PixelType::Float64;
}

template <class F>
std::shared_ptr<const F> samplesAs(const VolumeView& volume) {
    return dispatchPixelType(
        volume, []<class T>(const TypedVolumeView<T>& view) -> std::shared_ptr<const F> {
            if constexpr (std::is_same_v<T, F>) {
                return {view.samples, [](const F*) {}};  // the caller's
            } else {
                const std::int64_t count = view.geometry.voxelCount();
                const std::shared_ptr<F> copy(new F[static_cast<std::size_t>(count)],
                                              std::default_delete<F[]>());
                parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
                    std::transform(view.samples + begin, view.samples + end, copy.get() + begin,
                                   [](T sample) { return static_cast<F>(sample); });
                });
                return copy;
            }
        });
}

template std::shared_ptr<const float> samplesAs(const VolumeView&);
template std::shared_ptr<const double> samplesAs(const VolumeView&);

void requireFinite(const VolumeView& volume) {
    dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        if constexpr (std::is_floating_point_v<T>) {
            std::atomic<std::int64_t> odd{0};
            parallelForPieces(
                view.geometry.voxelCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
                    odd += std::count_if(view.samples + begin, view.samples + end,
                                         [](T sample) { return !std::isfinite(sample); });
                });
            if (odd == 0) return;
            throw InvalidInput(std::to_string(odd) +
                               " voxels hold no finite number (NaN or infinity), which blending "
                               "would spread; give them a value first");
        }
    });
}

}  // namespace adaptiso::detail
