#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "MeshData.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::python {

namespace py = pybind11;

/// The walls of a label map whose arrays Python looks at, in scanner RAS mm: LPS with the signs of
/// x and y turned in place.
class LabelData {
public:
    /// \param result  LPS mm \param labels  of regions that are whole; empty: all are
    static std::shared_ptr<LabelData> fromLps(LabelResult result, const ImageGeometry& image,
                                              const std::vector<Label>& labels);

    /// \param points  n x 3, RAS mm \param faces  m x 3 \param labels  m x 2; all are copied
    /// \throws InvalidInput  shapes, faces out of range
    static std::shared_ptr<LabelData> fromArrays(
        const py::array_t<double, py::array::c_style>& points,
        const py::array_t<std::int64_t, py::array::c_style>& faces,
        const py::array_t<Label, py::array::c_style>& labels, const ImageGeometry& image,
        std::string report);

    const LabelComplex& complex() const { return complex_; }
    const ImageGeometry& image() const { return image_; }

    /// The surface of one region: closed, outward, its points those of the walls, to the bit.
    std::shared_ptr<MeshData> region(Label label) const;

    /// All walls as one mesh.
    std::shared_ptr<MeshData> walls() const;

    /// Bound, statistics, and the measures of the regions; JSON.
    const std::string& report() const { return report_; }

    /// walls.vtp of adaptiso-labels. \return as MeshData::write()
    std::string write(const std::string& path, std::optional<CoordinateFrame> frame) const;

private:
    LabelComplex complex_;
    ImageGeometry image_;
    std::string report_;
};

}  // namespace adaptiso::python
