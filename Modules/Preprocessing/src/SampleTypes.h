#pragma once

#include <memory>
#include <string_view>

#include "adaptiso/Core/Volume.h"

namespace adaptiso::detail {

/// Blended samples of this type: float32 where it holds every value of `stored`, else float64.
PixelType blendedType(PixelType stored);

/// The samples as F, which must hold them: themselves if they are F already, else a copy. The
/// result lives as long as the view's samples do.
template <class F>
std::shared_ptr<const F> samplesAs(const VolumeView& volume);
extern template std::shared_ptr<const float> samplesAs(const VolumeView&);
extern template std::shared_ptr<const double> samplesAs(const VolumeView&);

/// Calls f(F{}) with the C++ type of blendedType().
template <class Function>
decltype(auto) withBlendedType(PixelType stored, Function&& f) {
    if (blendedType(stored) == PixelType::Float32) return f(float{});
    return f(double{});
}

/// \throws InvalidInput when a sample is NaN or infinite
void requireFinite(const VolumeView& volume);

}  // namespace adaptiso::detail
