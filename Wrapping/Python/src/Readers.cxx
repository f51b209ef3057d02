#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "Arrays.h"
#include "Calls.h"
#include "OptionRows.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::python {

void declareReaders(py::module_& module) {
    module.def(
        "read_image",
        [](const std::string& path, const py::dict& given) {
            ReadOptions options;
            take(readOptions(), options, given);
            std::optional<ReadVolume> read;
            runUnlocked(0, [&] { read = readVolume(path, options); });
            return py::make_tuple(toArray(read->volume), affineOf(read->volume.view().geometry()),
                                  read->format, read->warnings, read->scaling);
        },
        py::arg("path"), py::arg("options"));
}

}  // namespace adaptiso::python
