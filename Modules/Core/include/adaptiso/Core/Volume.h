#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso {

enum class PixelType { UInt8, Int8, UInt16, Int16, UInt32, Int32, UInt64, Int64, Float32, Float64 };

/// "uint8", "int16", "float32", ...
std::string_view toString(PixelType type);
std::size_t bytesPerPixel(PixelType type);

template <class T>
constexpr PixelType pixelTypeOf();
template <>
constexpr PixelType pixelTypeOf<std::uint8_t>() {
    return PixelType::UInt8;
}
template <>
constexpr PixelType pixelTypeOf<std::int8_t>() {
    return PixelType::Int8;
}
template <>
constexpr PixelType pixelTypeOf<std::uint16_t>() {
    return PixelType::UInt16;
}
template <>
constexpr PixelType pixelTypeOf<std::int16_t>() {
    return PixelType::Int16;
}
template <>
constexpr PixelType pixelTypeOf<std::uint32_t>() {
    return PixelType::UInt32;
}
template <>
constexpr PixelType pixelTypeOf<std::int32_t>() {
    return PixelType::Int32;
}
template <>
constexpr PixelType pixelTypeOf<std::uint64_t>() {
    return PixelType::UInt64;
}
template <>
constexpr PixelType pixelTypeOf<std::int64_t>() {
    return PixelType::Int64;
}
template <>
constexpr PixelType pixelTypeOf<float>() {
    return PixelType::Float32;
}
template <>
constexpr PixelType pixelTypeOf<double>() {
    return PixelType::Float64;
}

/// The samples of a scalar image in their own type, x (i) fastest, tightly packed. Owns nothing.
template <class T>
struct TypedVolumeView {
    const T* samples = nullptr;
    ImageGeometry geometry;

    std::int64_t strideY() const { return geometry.size[0]; }
    std::int64_t strideZ() const { return geometry.size[0] * geometry.size[1]; }
    const T& at(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return samples[i + j * strideY() + k * strideZ()];
    }
};

/// A view of a scalar image of any pixel type: what every algorithm takes. Owns nothing; the
/// samples must outlive it.
///
/// \pre size >= 1 along every axis, |determinant(indexToPhysical)| > 0 and finite
///      \throws InvalidInput otherwise
class VolumeView {
public:
    template <class T>
    VolumeView(const T* samples, const ImageGeometry& geometry)
        : VolumeView(samples, pixelTypeOf<T>(), geometry) {}
    VolumeView(const void* samples, PixelType type, const ImageGeometry& geometry);

    PixelType pixelType() const { return type_; }
    const ImageGeometry& geometry() const { return geometry_; }
    const void* samples() const { return samples_; }
    std::size_t byteCount() const {
        return static_cast<std::size_t>(geometry_.voxelCount()) * bytesPerPixel(type_);
    }

    /// \pre pixelTypeOf<T>() == pixelType()
    template <class T>
    TypedVolumeView<T> as() const {
        return {static_cast<const T*>(samples_), geometry_};
    }

private:
    const void* samples_;
    PixelType type_;
    ImageGeometry geometry_;
};

/// Calls `f(T{})` with the C++ type of `type`.
template <class F>
decltype(auto) withPixelType(PixelType type, F&& f) {
    switch (type) {
        case PixelType::UInt8:
            return f(std::uint8_t{});
        case PixelType::Int8:
            return f(std::int8_t{});
        case PixelType::UInt16:
            return f(std::uint16_t{});
        case PixelType::Int16:
            return f(std::int16_t{});
        case PixelType::UInt32:
            return f(std::uint32_t{});
        case PixelType::Int32:
            return f(std::int32_t{});
        case PixelType::UInt64:
            return f(std::uint64_t{});
        case PixelType::Int64:
            return f(std::int64_t{});
        case PixelType::Float32:
            return f(float{});
        case PixelType::Float64:
            return f(double{});
    }
    throw InternalError("withPixelType: unknown pixel type");
}

/// Calls `f` with the TypedVolumeView of the volume's own pixel type and returns what it returns.
template <class F>
decltype(auto) dispatchPixelType(const VolumeView& volume, F&& f) {
    return withPixelType(volume.pixelType(),
                         [&]<class T>(T) -> decltype(auto) { return f(volume.as<T>()); });
}

/// An image that owns its samples, whoever allocated them (an ITK image, a vector, a mapped file).
class Volume {
public:
    /// `owner` keeps `view`'s samples alive.
    Volume(VolumeView view, std::shared_ptr<const void> owner)
        : view_(view), owner_(std::move(owner)) {}

    template <class T>
    static Volume fromSamples(std::vector<T> samples, const ImageGeometry& geometry) {
        if (static_cast<std::int64_t>(samples.size()) != geometry.voxelCount()) {
            throw InvalidInput("Volume::fromSamples: the number of samples differs from the size");
        }
        auto owner = std::make_shared<const std::vector<T>>(std::move(samples));
        return Volume(VolumeView(owner->data(), geometry), owner);
    }

    const VolumeView& view() const { return view_; }
    operator const VolumeView&() const { return view_; }  // NOLINT: a Volume is a VolumeView

private:
    VolumeView view_;
    std::shared_ptr<const void> owner_;
};

/// Smallest and largest sample, NaN left aside, as doubles. A volume of NaN alone gives
/// {+inf, -inf}.
struct ValueRange {
    double minimum;
    double maximum;
};
ValueRange valueRange(const VolumeView& volume);

/// The test "sample >= isovalue" in the samples' own type, exact for every type and isovalue.
///
/// For integers the isovalue is rounded up, for floats to the next one not below it, so that one
/// comparison of native values decides, without converting samples.
template <class T>
struct IsovalueTest {
    enum class Kind {
        Some,  ///< compare with `threshold`
        All,   ///< every value of the type reaches the isovalue
        None   ///< no value of the type does
    };
    Kind kind = Kind::Some;
    T threshold{};

    /// \pre isovalue is finite
    explicit IsovalueTest(double isovalue) {
        if constexpr (std::is_floating_point_v<T>) {
            threshold = static_cast<T>(isovalue);
            if (static_cast<double>(threshold) < isovalue) {
                threshold = std::nextafter(threshold, std::numeric_limits<T>::infinity());
            }
        } else {
            // 2^digits is exact in double, max() of a 64-bit type is not
            const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
            const double rounded = std::ceil(isovalue);
            if (rounded >= end) {
                kind = Kind::None;
                threshold = std::numeric_limits<T>::max();
            } else if (rounded <= static_cast<double>(std::numeric_limits<T>::lowest())) {
                kind = Kind::All;
                threshold = std::numeric_limits<T>::lowest();
            } else {
                threshold = static_cast<T>(rounded);
            }
        }
    }

    /// NaN is outside. Kind::None needs no case of its own where the caller has asked before.
    bool operator()(T value) const { return kind != Kind::None && value >= threshold; }
};

}  // namespace adaptiso
