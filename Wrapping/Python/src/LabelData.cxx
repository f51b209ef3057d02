#include "LabelData.h"

#include <utility>

#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::python {
namespace {

Json regionJson(const RegionMeasure& measure) {
    Json neighbours = Json::array();
    for (const RegionContact& contact : measure.neighbours) {
        neighbours.push_back({{"label", contact.label},
                              {"triangles", contact.triangles},
                              {"areaMm2", number(contact.areaMm2)}});
    }
    return {{"label", measure.label},
            {"volumeMm3", number(measure.volumeMm3)},
            {"areaMm2", number(measure.areaMm2)},
            {"vertices", measure.vertices},
            {"triangles", measure.triangles},
            {"eulerCharacteristic", measure.eulerCharacteristic},
            {"components", measure.components},
            {"neighbours", neighbours}};
}

Json reportJson(const LabelResult& result, const std::vector<Label>& labels) {
    const LabelStatistics& statistics = result.statistics;
    Json regions = Json::array();
    for (const RegionMeasure& measure : measureRegions(result.complex, labels)) {
        regions.push_back(regionJson(measure));
    }
    return {{"walls",
             {{"points", result.complex.points.size()},
              {"triangles", result.complex.triangles.size()},
              {"mapTriangles", statistics.mapTriangles},
              {"fullTriangles", statistics.fullTriangles},
              {"wantedTriangles", orNull(statistics.wantedTriangles)},
              {"errorBoundMm", number(statistics.errorBoundMm)},
              {"cells", statistics.cells},
              {"dividedCells", statistics.dividedCells},
              {"heldVertices", statistics.heldVertices},
              {"mendedCrossings", statistics.mendedCrossings}}},
            {"regions", regions}};
}

}  // namespace

std::shared_ptr<LabelData> LabelData::fromLps(LabelResult result, const ImageGeometry& image,
                                              const std::vector<Label>& labels) {
    auto data = std::make_shared<LabelData>();
    data->report_ = dumped(reportJson(result, labels));
    data->complex_ = std::move(result.complex);
    turnXY(data->complex_.points);
    data->image_ = image;
    return data;
}

std::shared_ptr<LabelData> LabelData::fromArrays(
    const py::array_t<double, py::array::c_style>& points,
    const py::array_t<std::int64_t, py::array::c_style>& faces,
    const py::array_t<Label, py::array::c_style>& labels, const ImageGeometry& image,
    std::string report) {
    const auto mesh = MeshData::fromArrays(points, faces, std::nullopt, CoordinateFrame::Ras,
                                           std::nullopt, false);
    if (labels.ndim() != 2 || labels.shape(1) != 2 || labels.shape(0) != faces.shape(0)) {
        throw InvalidInput("labels: must be two for each face");
    }
    auto data = std::make_shared<LabelData>();
    data->complex_.points = mesh->mesh().points;
    data->complex_.triangles = mesh->mesh().triangles;
    const auto table = labels.unchecked<2>();
    for (py::ssize_t t = 0; t < labels.shape(0); ++t) {
        data->complex_.labels.push_back({table(t, 0), table(t, 1)});
    }
    data->image_ = image;
    data->report_ = std::move(report);
    return data;
}

std::shared_ptr<MeshData> LabelData::region(Label label) const {
    TriangleMesh mesh = regionSurface(complex_, label);
    if (mesh.triangles.empty()) {
        throw InvalidInput("label " + std::to_string(label) + ": has no surface here");
    }
    auto data =
        std::make_shared<MeshData>(MeshData::asStored(std::move(mesh), CoordinateFrame::Ras));
    data->setImage(image_);
    return data;
}

std::shared_ptr<MeshData> LabelData::walls() const {
    auto data = std::make_shared<MeshData>(
        MeshData::asStored({complex_.points, {}, complex_.triangles}, CoordinateFrame::Ras));
    data->setImage(image_);
    return data;
}

std::string LabelData::write(const std::string& path, std::optional<CoordinateFrame> frame) const {
    std::vector<CellArray> arrays{{"label0", {}}, {"label1", {}}};
    for (std::size_t side = 0; side < arrays.size(); ++side) {
        arrays[side].values.reserve(complex_.labels.size());
        for (const auto& labels : complex_.labels) arrays[side].values.push_back(labels[side]);
    }
    return walls()->write(path, frame, std::move(arrays));
}

}  // namespace adaptiso::python
