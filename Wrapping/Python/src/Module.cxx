// The C++ half of the Python package: arrays in and out, no algorithm. Arguments are checked and
// named by the Python half (adaptiso/*.py), which documents what users see.
#include <pybind11/pybind11.h>

#include <exception>
#include <new>
#include <utility>

#include "Calls.h"
#include "OptionRows.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

PYBIND11_MODULE(_adaptiso, module) {
    using namespace adaptiso::python;
    module.attr("__version__") = ADAPTISO_VERSION;
    static const py::exception<adaptiso::Error> error(module, "Error", PyExc_ValueError);
    error.attr("__doc__") =
        "What can't be used: a file, an array, an argument. The message is one line.";
    static const py::exception<adaptiso::InternalError> internalError(module, "InternalError",
                                                                      PyExc_RuntimeError);
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const adaptiso::InternalError& fault) {
            PyErr_SetString(internalError.ptr(), adaptiso::withoutControls(fault.what()).c_str());
        } catch (const adaptiso::Error& fault) {
            PyErr_SetString(error.ptr(), adaptiso::withoutControls(fault.what()).c_str());
        } catch (const std::bad_alloc&) {
            PyErr_SetString(PyExc_MemoryError, "adaptiso: there is not enough memory");
        }
    });
    declareOptions(module);
    declareMeshes(module);
    declareSurfaces(module);
    declareReaders(module);
    declareChecks(module);
    declareSimplify(module);
    declareMend(module);
    declareHeadModels(module);
    declareLabels(module);
    module.def("end_calls_of_other_threads", &endCallsOfOtherThreads);
    module.def("before_fork", &beforeFork);
    module.def("after_fork_in_parent", &afterForkInParent);
    module.def("after_fork_in_child", &afterForkInChild);
}
