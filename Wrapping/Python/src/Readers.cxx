#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>

#include "Arrays.h"
#include "Calls.h"
#include "OptionRows.h"
#ifdef ADAPTISO_PYTHON_READERS
#include "adaptiso/ImageIO/ReadVolume.h"
#endif

namespace adaptiso::python {
#ifdef ADAPTISO_PYTHON_READERS
namespace {

py::tuple readImage(const std::string& path, const ReadOptions& options) {
    std::optional<ReadVolume> read;
    runUnlocked(0, [&] { read = readVolume(path, options); });
    return py::make_tuple(toArray(read->volume), affineOf(read->volume.view().geometry()),
                          read->format, read->warnings, read->scaling);
}

}  // namespace

void declareReaders(py::module_& module) {
    module.def(
        "read_image",
        [](const std::string& path, const py::dict& given) {
            ReadOptions options;
            take(readOptions(), options, given);
            return readImage(path, options);
        },
        py::arg("path"), py::arg("options"));
}
#else
void declareReaders(py::module_&) {}  // the Python half reads by nibabel
#endif

}  // namespace adaptiso::python
