#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::python {

namespace py = pybind11;

/// p -> matrix * p. \param matrix  4 x 4 floats \param name  of it, in refusals
/// \throws InvalidInput  not finite, not affine, singular
AffineTransform transformOf(const py::array_t<double>& matrix, const std::string& name);

/// The geometry that a matrix of voxel indices to scanner RAS mm gives, as nibabel's affine is.
/// \param affine  4 x 4 floats  \throws InvalidInput  not finite, not affine, singular
ImageGeometry geometryFromAffine(const Index3& size, const py::array_t<double>& affine);

/// Voxel indices to scanner RAS mm, 4 x 4.
py::array_t<double> affineOf(const ImageGeometry& geometry);

/// The samples of an array, where they lie. The array is kept.
struct ArrayVolume {
    py::array samples;
    VolumeView view;         ///< i fastest, whatever the user's order of axes is
    ImageGeometry geometry;  ///< of the user's axes
    std::optional<ValueRange> range{};

    /// \param samples  3-D, of a type that PixelType has, in native byte order; in Fortran order
    ///                 and tightly packed
    /// \param affine   of the axes of `samples`; `userAffine` of the user's, who has `userShape`
    static ArrayVolume make(const py::array& samples, const py::array_t<double>& affine,
                            const Index3& userShape, const py::array_t<double>& userAffine);

    /// Computed once, without the interpreter's lock.
    const ValueRange& valueRange(int threads);
};

/// The samples that `volume` holds as an array, which keeps them: i, j, k, in Fortran order,
/// read-only.
py::array toArray(const Volume& volume);

/// Rows of three numbers that `owner` keeps; read-only.
template <class Value, class Row>
py::array viewRows(const std::vector<Row>& rows, const py::object& owner) {
    static_assert(sizeof(Row) == 3 * sizeof(Value));
    py::array array(
        py::dtype::of<Value>(), {static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}},
        {static_cast<py::ssize_t>(sizeof(Row)), static_cast<py::ssize_t>(sizeof(Value))},
        rows.data(), owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

}  // namespace adaptiso::python

/// A Warning is an adaptiso._arguments.Warned in Python, which is a str; any str is a Warning.
template <>
struct pybind11::detail::type_caster<adaptiso::Warning> {
    PYBIND11_TYPE_CASTER(adaptiso::Warning, const_name("str"));

    bool load(handle from, bool) {
        if (!PyUnicode_Check(from.ptr())) return false;
        const bool isWarned = hasattr(from, "code");
        value.text = (isWarned ? from.attr("text") : from).cast<std::string>();
        if (!isWarned) return true;
        value.code = from.attr("code").cast<std::string>();
        value.file = from.attr("file").cast<std::string>();
        return true;
    }
    static handle cast(const adaptiso::Warning& from, return_value_policy, handle) {
        const module_ module = module_::import("adaptiso._arguments");
        return module.attr("Warned")(from.text, from.code, from.file).release();
    }
};
