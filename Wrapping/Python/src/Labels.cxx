#include "adaptiso/Labels/Labels.h"

#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "LabelData.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso::python {
namespace {

/// \param subject  of messages: the file, or "image"
std::shared_ptr<LabelData> makeLabels(const ArrayVolume& volume, LabelOptions options, int threads,
                                      py::object progress, const std::string& subject) {
    Watcher watcher(std::move(progress));
    options.progress = watcher.callback();
    std::shared_ptr<LabelData> data;
    watcher.run(threads, [&] {
        try {
            LabelResult result = extractLabels(volume.view, options);
            watcher.tell("measure", 0);
            data = LabelData::fromLps(std::move(result), volume.geometry, options.labels);
        } catch (const InvalidInput& error) {
            throw InvalidInput(subject + ": " + error.what());
        }
        watcher.tell("measure", 1);
    });
    return data;
}

/// (value, name, abbreviation, colour or None) of every entry
py::list entriesOf(const LabelTable& table) {
    py::list entries;
    for (const LabelEntry& entry : table.entries) {
        entries.append(py::make_tuple(entry.value, entry.name, entry.abbreviation, entry.color));
    }
    return entries;
}

void declareLabelData(py::module_& module) {
    const auto side = [](int n) {
        return [n](const py::object& self) {
            const auto& labels = self.cast<const LabelData&>().complex().labels;
            py::array_t<Label> array({static_cast<py::ssize_t>(labels.size())},
                                     {static_cast<py::ssize_t>(sizeof(labels[0]))},
                                     labels.empty() ? nullptr : &labels[0][n], self);
            array.attr("setflags")(py::arg("write") = false);
            return array;
        };
    };
    py::class_<LabelData, std::shared_ptr<LabelData>>(module, "LabelData")
        .def_static(
            "from_arrays",
            [](const py::array_t<double, py::array::c_style>& points,
               const py::array_t<std::int64_t, py::array::c_style>& faces,
               const py::array_t<Label, py::array::c_style>& labels, const Index3& shape,
               const py::array_t<double>& affine, const std::string& report) {
                return LabelData::fromArrays(points, faces, labels,
                                             geometryFromAffine(shape, affine), report);
            },
            py::arg("vertices"), py::arg("faces"), py::arg("labels"), py::arg("shape"),
            py::arg("affine"), py::arg("report"))
        .def_property_readonly("vertices",
                               [](const py::object& self) {
                                   const auto& complex = self.cast<const LabelData&>().complex();
                                   return viewRows<double>(complex.points, self);
                               })
        .def_property_readonly("faces",
                               [](const py::object& self) {
                                   const auto& complex = self.cast<const LabelData&>().complex();
                                   return viewRows<std::int64_t>(complex.triangles, self);
                               })
        .def_property_readonly("label0", side(0))
        .def_property_readonly("label1", side(1))
        .def_property_readonly("shape", [](const LabelData& self) { return self.image().size; })
        .def_property_readonly("affine",
                               [](const LabelData& self) { return affineOf(self.image()); })
        .def_property_readonly("report", &LabelData::report)
        .def(
            "region",
            [](const LabelData& self, Label label) {
                const Unlocked unlocked;
                return self.region(label);
            },
            py::arg("label"))
        .def("walls", &LabelData::walls)
        .def(
            "write",
            [](const LabelData& self, const std::string& path,
               const std::optional<std::string>& frame) {
                const auto wanted = frameOf(frame);
                const Unlocked unlocked;
                return self.write(path, wanted);
            },
            py::arg("path"), py::arg("frame"));
}

}  // namespace

void declareLabels(py::module_& module) {
    declareLabelData(module);
    module.def(
        "make_labels",
        [](const ArrayVolume& volume, std::optional<double> maxError,
           std::optional<std::int64_t> triangles, std::optional<double> reduction,
           const std::vector<Label>& labels, int threads, py::object progress,
           const std::string& subject) {
            LabelOptions options;
            options.maxErrorMm = maxError;
            options.maxTriangles = triangles;
            options.reduction = reduction;
            options.labels = labels;
            return makeLabels(volume, std::move(options), threads, std::move(progress), subject);
        },
        py::arg("volume"), py::arg("max_error"), py::arg("triangles"), py::arg("reduction"),
        py::arg("labels"), py::arg("threads"), py::arg("progress"), py::arg("subject"));
    module.def(
        "read_label_table",
        [](const std::string& path) {
            const LabelTable table = readLabelTable(path);
            return py::make_tuple(entriesOf(table), table.warnings);
        },
        py::arg("path"));
    module.def(
        "find_label_table",
        [](const std::string& image, std::int64_t volume) {
            const FoundLabelTables found = findLabelTables(image, volume);
            return py::make_tuple(entriesOf(found.table), found.table.warnings);
        },
        py::arg("image"), py::arg("volume") = 0);
    module.def("label_color", &labelColor, py::arg("label"));
}

}  // namespace adaptiso::python
