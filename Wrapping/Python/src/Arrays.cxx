#include "Arrays.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "Calls.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::python {
namespace {

template <class T>
bool holds(const py::array& samples) {
    return py::isinstance<py::array_t<T>>(samples);
}

PixelType pixelTypeOfArray(const py::array& samples) {
    if (holds<std::uint8_t>(samples)) return PixelType::UInt8;
    if (holds<std::int8_t>(samples)) return PixelType::Int8;
    if (holds<std::uint16_t>(samples)) return PixelType::UInt16;
    if (holds<std::int16_t>(samples)) return PixelType::Int16;
    if (holds<std::uint32_t>(samples)) return PixelType::UInt32;
    if (holds<std::int32_t>(samples)) return PixelType::Int32;
    if (holds<std::uint64_t>(samples)) return PixelType::UInt64;
    if (holds<std::int64_t>(samples)) return PixelType::Int64;
    if (holds<float>(samples)) return PixelType::Float32;
    if (holds<double>(samples)) return PixelType::Float64;
    throw InvalidInput("image: samples of this type can't be used");
}

py::dtype dtypeOf(PixelType type) {
    return py::dtype(std::string(toString(type)));
}

/// RAS to LPS and back. Zero stays positive, as the reader has it.
double turned(double value) {
    return value == 0 ? 0 : -value;
}

/// Squares of lengths and volumes must be finite, and the places of voxels distinct.
void requireCountable(const ImageGeometry& geometry) {
    constexpr double kMostMm = 1e30, kMostVoxels = 1e10;
    const Vec3 spacingMm = geometry.spacingMm();
    for (int axis = 0; axis < 3; ++axis) {
        if (spacingMm[axis] <= kMostMm && spacingMm[axis] >= 1 / kMostMm) continue;
        throw InvalidInput("affine: a voxel is " + formatShort(spacingMm[axis]) +
                           " mm long, must be 1e-30 to 1e+30");
    }
    const double leastMm = std::min({spacingMm.x, spacingMm.y, spacingMm.z});
    const double farMm = norm(geometry.originMm);
    if (farMm <= kMostVoxels * leastMm) return;
    throw InvalidInput("affine: the image lies " + formatShort(farMm) +
                       " mm off, must be at most 1e+10 voxels");
}

}  // namespace

AffineTransform transformOf(const py::array_t<double>& matrix, const std::string& name) {
    if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) {
        throw InvalidInput(name + ": must be a 4 x 4 matrix");
    }
    const auto m = matrix.unchecked<2>();
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            if (!std::isfinite(m(row, column))) throw InvalidInput(name + ": is not finite");
        }
    }
    if (m(3, 0) != 0 || m(3, 1) != 0 || m(3, 2) != 0 || m(3, 3) != 1) {
        throw InvalidInput(name + ": its last row must be 0, 0, 0, 1");
    }
    AffineTransform transform;
    for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis) transform.linear.column[axis][row] = m(row, axis);
        transform.offset[row] = m(row, 3);
    }
    const double volume = std::abs(determinant(transform.linear));
    if (!(volume > 0) || !std::isfinite(volume)) {
        throw InvalidInput(name + ": is singular; its axes span no volume");
    }
    return transform;
}

ImageGeometry geometryFromAffine(const Index3& size, const py::array_t<double>& affine) {
    const AffineTransform toRas = transformOf(affine, "affine");
    ImageGeometry geometry;
    geometry.size = size;
    for (int row = 0; row < 3; ++row) {
        const auto lps = [&](double value) { return row < 2 ? turned(value) : value; };
        for (int axis = 0; axis < 3; ++axis) {
            geometry.indexToPhysical.column[axis][row] = lps(toRas.linear.column[axis][row]);
        }
        geometry.originMm[row] = lps(toRas.offset[row]);
    }
    requireCountable(geometry);
    return geometry;
}

py::array_t<double> affineOf(const ImageGeometry& geometry) {
    py::array_t<double> affine({4, 4});
    auto m = affine.mutable_unchecked<2>();
    for (int row = 0; row < 3; ++row) {
        const auto ras = [&](double value) { return row < 2 ? turned(value) : value; };
        for (int axis = 0; axis < 3; ++axis) {
            m(row, axis) = ras(geometry.indexToPhysical.column[axis][row]);
        }
        m(row, 3) = ras(geometry.originMm[row]);
        m(3, row) = 0;
    }
    m(3, 3) = 1;
    return affine;
}

ArrayVolume ArrayVolume::make(const py::array& samples, const py::array_t<double>& affine,
                              const Index3& userShape, const py::array_t<double>& userAffine) {
    if (samples.ndim() != 3) throw InvalidInput("image: must have three axes");
    if ((samples.flags() & py::array::f_style) == 0) {
        throw InvalidInput("image: must be in Fortran order");
    }
    const Index3 size{samples.shape(0), samples.shape(1), samples.shape(2)};
    const ImageGeometry geometry = geometryFromAffine(size, affine);
    return {samples, VolumeView(samples.data(), pixelTypeOfArray(samples), geometry),
            geometryFromAffine(userShape, userAffine)};
}

const ValueRange& ArrayVolume::valueRange(int threads) {
    if (!range) {
        ValueRange found{};
        runUnlocked(threads, [&] { found = adaptiso::valueRange(view); });
        range = found;
    }
    return *range;
}

py::array toArray(const Volume& volume) {
    auto kept = std::make_unique<Volume>(volume);
    const VolumeView& view = kept->view();
    const Index3& size = view.geometry().size;
    const auto bytes = static_cast<py::ssize_t>(bytesPerPixel(view.pixelType()));
    const void* samples = view.samples();
    const PixelType type = view.pixelType();
    const py::capsule owner(kept.release(),
                            [](void* pointer) { delete static_cast<Volume*>(pointer); });
    py::array array(dtypeOf(type), {size[0], size[1], size[2]},
                    {bytes, bytes * size[0], bytes * size[0] * size[1]}, samples, owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

}  // namespace adaptiso::python
