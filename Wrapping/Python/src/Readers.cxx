#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>

#include "Arrays.h"
#include "Calls.h"
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
        [](const std::string& path, std::optional<std::string> series,
           std::optional<std::int64_t> volumeIndex, std::optional<std::int64_t> level,
           std::optional<std::int64_t> channel, std::optional<std::int64_t> time, bool allChunks,
           bool resampleSlices) {
            ReadOptions options;
            options.series = std::move(series);
            options.volumeIndex = volumeIndex;
            options.level = level;
            options.channel = channel;
            options.timePoint = time;
            options.refusesMissingChunks = allChunks;
            options.resampleSlices = resampleSlices;
            return readImage(path, options);
        },
        py::arg("path"), py::arg("series"), py::arg("volume_index"), py::arg("level"),
        py::arg("channel"), py::arg("time"), py::arg("all_chunks"), py::arg("resample_slices"));
}
#else
void declareReaders(py::module_&) {}  // the Python half reads by nibabel
#endif

}  // namespace adaptiso::python
