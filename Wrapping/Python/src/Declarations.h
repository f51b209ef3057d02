#pragma once

#include <pybind11/pybind11.h>

namespace adaptiso::python {

namespace py = pybind11;

/// What `_adaptiso` offers, by subject; Module.cxx puts it together. Classes come before the
/// functions that take them.

void declareMeshes(py::module_& module);    ///< MeshData, read_mesh
void declareSurfaces(py::module_& module);  ///< ArrayVolume, ArrayIndex, build_index, make_surface
void declareReaders(py::module_& module);   ///< read_image
void declareChecks(py::module_& module);    ///< check, check_nested, compare
void declareSimplify(py::module_& module);  ///< simplify_mesh
void declareHeadModels(py::module_& module);  ///< HeadModelData, make_bem
void declareLabels(py::module_& module);      ///< LabelData, make_labels

}  // namespace adaptiso::python
