#include "adaptiso/HeadModel/ExportMatlab.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "MatFile.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ConductivityModel.h"

namespace adaptiso {

using namespace headmodel;

namespace {

constexpr const char* kModel = "headmodel";

HeadSurface surfaceAround(const std::string& tissue, std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
        if (tissueWithin(headSurface(n, count), count).name == tissue) return headSurface(n, count);
    }
    throw FileError("it holds an unknown tissue");
}

template <class... Variables>
std::vector<MatVariable> listOf(Variables... variables) {
    std::vector<MatVariable> list;
    (list.push_back(std::move(variables)), ...);
    return list;
}

/// Outermost first.
MatVariable boundariesOf(std::span<const HeadLayer> layers, const std::string& coordsys) {
    std::vector<std::vector<MatVariable>> items;
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
        items.push_back(listOf(matPoints("pos", layer->mesh.points),
                               matTriangles("tri", layer->mesh.triangles), matText("unit", "mm"),
                               matText("coordsys", coordsys)));
    }
    return matStructs("bnd", std::move(items));
}

template <class Read>
auto naming(const std::filesystem::path& path, const Read& read) {
    try {
        return read();
    } catch (const FileError& error) {
        const std::string what = error.what();
        throw FileError(what.starts_with(path.string()) ? what : path.string() + ": " + what);
    }
}

}  // namespace

std::string fieldTripCoordsys(CoordinateFrame frame) {
    switch (frame) {
        case CoordinateFrame::Ras:
            return "scanras";
        case CoordinateFrame::Lps:
            return "scanlps";
        case CoordinateFrame::TkRas:
            return "ras";
        case CoordinateFrame::Voxel:
            break;
    }
    throw InvalidInput("FieldTrip's head models are in mm, not in voxel indices");
}

void writeFieldTripModel(std::span<const HeadLayer> layers, const std::filesystem::path& path,
                         CoordinateFrame frame) {
    if (layers.empty()) throw InvalidInput(path.string() + ": there is no surface to write");
    const std::string coordsys = fieldTripCoordsys(frame);
    std::vector<double> conductivities;
    std::vector<std::string> tissues;
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
        conductivities.push_back(layer->conductivity);
        tissues.emplace_back(tissueWithin(layer->surface, layers.size()).name);
    }
    std::vector<std::vector<MatVariable>> model;
    model.push_back(listOf(boundariesOf(layers, coordsys), matRow("cond", conductivities),
                           matTexts("tissue", tissues), matNumber("skin_surface", 1),
                           matNumber("source", static_cast<double>(layers.size())),
                           matText("type", layers.size() == 1 ? "singleshell" : "openmeeg"),
                           matText("unit", "mm"), matText("coordsys", coordsys)));
    std::vector<MatVariable> file;
    file.push_back(matStructs(kModel, std::move(model)));
    writeMatFile(path, file);
}

std::vector<HeadLayer> readFieldTripModel(const std::filesystem::path& path) {
    return naming(path, [&] {
        const MatVariable model = readMatVariable(path, kModel);
        matvar_t& boundaries = matField(*model, "bnd");
        matvar_t& tissues = matField(*model, "tissue");
        const std::vector<double> conductivities = valuesOf(matField(*model, "cond"));
        std::vector<HeadLayer> layers(conductivities.size());
        for (std::size_t n = 0; n < layers.size(); ++n) {
            HeadLayer& layer = layers[layers.size() - 1 - n];
            layer.conductivity = conductivities[n];
            matvar_t* const tissue = Mat_VarGetCell(&tissues, static_cast<int>(n));
            if (tissue == nullptr) throw FileError("it names fewer tissues than conductivities");
            layer.surface = surfaceAround(textOf(*tissue), layers.size());
            layer.mesh.points = pointsOf(matField(boundaries, "pos", n));
            layer.mesh.triangles =
                trianglesOf(matField(boundaries, "tri", n), layer.mesh.points.size());
        }
        return layers;
    });
}

void writeBrainstormSurface(const TriangleMesh& metres, const std::filesystem::path& path,
                            const std::string& comment) {
    std::vector<Vec3> normals;
    std::transform(metres.normals.begin(), metres.normals.end(), std::back_inserter(normals),
                   [](const Normal& normal) { return toVec3(normal); });
    writeMatFile(path, listOf(matText("Comment", comment), matPoints("Vertices", metres.points),
                              matTriangles("Faces", metres.triangles, true),
                              matPoints("VertNormals", normals)));
}

TriangleMesh readBrainstormSurface(const std::filesystem::path& path) {
    return naming(path, [&] {
        TriangleMesh mesh;
        mesh.points = pointsOf(*readMatVariable(path, "Vertices"));
        mesh.triangles = trianglesOf(*readMatVariable(path, "Faces"), mesh.points.size(), true);
        return mesh;
    });
}

void writeLeadField(const LeadField& field, const std::filesystem::path& path,
                    CoordinateFrame frame) {
    std::vector<std::string> names;
    std::vector<Vec3> places;
    for (const NamedPoint& electrode : field.electrodes) {
        names.push_back(electrode.name);
        places.push_back(electrode.point);
    }
    // gain last, so that reading it back notices what is cut off
    writeMatFile(path, listOf(matText("gain_unit", "V/(A m)"), matText("reference", "none"),
                              matText("solver", field.solver), matTexts("label", names),
                              matPoints("elecpos", places), matPoints("pos", field.places),
                              matPoints("ori", field.directions), matText("unit", "mm"),
                              matText("coordsys", fieldTripCoordsys(frame)),
                              matColumns("gain", names.size(), field.gain)));
}

std::vector<double> readLeadFieldGain(const std::filesystem::path& path) {
    return naming(path, [&] { return valuesOf(*readMatVariable(path, "gain")); });
}

}  // namespace adaptiso
