#pragma once

#include <pybind11/pybind11.h>

namespace adaptiso::python {

/// simplify_mesh(): a mesh with fewer triangles, and what was found of the mesh.
void declareSimplify(pybind11::module_& module);

}  // namespace adaptiso::python
