#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::python {
namespace {

/// Python's word for the frame of a mesh whose file does not name one.
constexpr std::string_view kUnknownFrame = "unknown";

std::optional<ImageGeometry> imageOf(const std::optional<std::vector<std::int64_t>>& shape,
                                     const std::optional<py::array_t<double>>& affine) {
    if (!shape || !affine) return std::nullopt;
    if (shape->size() != 3) throw InvalidInput("shape: must be three counts of voxels");
    return geometryFromAffine({(*shape)[0], (*shape)[1], (*shape)[2]}, *affine);
}

}  // namespace

void declareMeshes(py::module_& module) {
    py::class_<MeshData, std::shared_ptr<MeshData>>(module, "MeshData")
        .def_static(
            "from_arrays",
            [](const py::array_t<double, py::array::c_style>& points,
               const py::array_t<std::int64_t, py::array::c_style>& faces,
               const std::optional<py::array_t<float, py::array::c_style>>& normals,
               const std::string& frame, const std::optional<std::vector<std::int64_t>>& shape,
               const std::optional<py::array_t<double>>& affine, bool keepsFaults) {
                const bool isKnown = frame != kUnknownFrame;
                auto data = MeshData::fromArrays(points, faces, normals,
                                                 isKnown ? frameOf(frame) : CoordinateFrame::Ras,
                                                 imageOf(shape, affine), keepsFaults);
                data->setFrameKnown(isKnown);
                return data;
            },
            py::arg("vertices"), py::arg("faces"), py::arg("normals") = py::none(),
            py::arg("frame") = "ras", py::arg("shape") = py::none(), py::arg("affine") = py::none(),
            py::arg("keeps_faults") = false)
        .def_property_readonly("vertices",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<double>(mesh.points, self);
                               })
        .def_property_readonly("faces",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<std::int64_t>(mesh.triangles, self);
                               })
        .def_property_readonly("normals",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<float>(mesh.normals, self);
                               })
        .def_property("error_bound", &MeshData::errorBoundMm, &MeshData::setErrorBoundMm)
        .def_property("report", &MeshData::report, &MeshData::setReport)
        .def_property_readonly("frame",
                               [](const MeshData& self) {
                                   return self.isFrameKnown() ? frameWord(self.frame())
                                                              : kUnknownFrame;
                               })
        .def_property_readonly("shape",
                               [](const MeshData& self) -> py::object {
                                   if (!self.image()) return py::none();
                                   const Index3& size = self.image()->size;
                                   return py::make_tuple(size[0], size[1], size[2]);
                               })
        .def_property_readonly("affine",
                               [](const MeshData& self) -> py::object {
                                   if (!self.image()) return py::none();
                                   return affineOf(*self.image());
                               })
        .def(
            "write",
            [](const MeshData& self, const std::string& path,
               const std::optional<std::string>& frame) {
                const auto wanted = frameOf(frame);
                const Unlocked unlocked;
                return self.write(path, wanted);
            },
            py::arg("path"), py::arg("frame") = py::none())
        .def(
            "in_frame",
            [](const MeshData& self, const std::string& frame) {
                // tkRAS of the image, as files of FreeSurfer hold it
                const CoordinateFrame wanted = frameOf(frame);
                if (!self.image()) throw InvalidInput("the mesh does not know its image");
                TriangleMesh lps = fromFrame(self.mesh(), CoordinateFrame::Ras);
                return std::make_shared<MeshData>(MeshData::asStored(
                    toFrame(lps, wanted, frameVolume(wanted, *self.image())), wanted));
            },
            py::arg("frame"))
        .def_property_readonly(
            "frame_volume",
            [](const MeshData& self) -> py::object {
                if (!self.image()) return py::none();
                const ImageGeometry volume = frameVolume(CoordinateFrame::TkRas, *self.image());
                return py::make_tuple(
                    py::make_tuple(volume.size[0], volume.size[1], volume.size[2]),
                    affineOf(volume));
            })
        .def(
            "notebook",
            [](const MeshData& self, const std::string& title) {
                std::string html;
                runUnlocked(0, [&] { html = self.notebook(title); });
                return html;
            },
            py::arg("title"))
        .def_property_readonly("area",
                               [](const MeshData& self) { return surfaceArea(self.mesh()); })
        .def_property_readonly("volume",
                               [](const MeshData& self) { return enclosedVolume(self.mesh()); })
        .def_property_readonly("bytes", [](const MeshData& self) {
            const TriangleMesh& mesh = self.mesh();
            return mesh.points.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Normal) +
                   mesh.triangles.size() * sizeof(Triangle);
        });
    module.def(
        "read_mesh",
        [](const std::string& path, const std::optional<std::vector<std::int64_t>>& shape,
           const std::optional<py::array_t<double>>& affine, bool keepsFaults,
           const std::optional<std::string>& stated) {
            const std::optional<ImageGeometry> image = imageOf(shape, affine);
            const auto frame = frameOf(stated);
            const Unlocked unlocked;
            return readMeshData(path, image, keepsFaults, frame);
        },
        py::arg("path"), py::arg("shape"), py::arg("affine"), py::arg("keeps_faults"),
        py::arg("input_coordinates"));
}

}  // namespace adaptiso::python
