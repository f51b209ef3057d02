#include "adaptiso/SurfaceChecks/Checks.h"

#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Calls.h"
#include "MeshData.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"

namespace adaptiso::python {
namespace {

std::string checkMesh(const MeshData& data, const std::string& profile,
                      std::optional<double> minAngleDeg, std::int64_t maxPairs, int threads) {
    CheckRules rules;
    rules.profile = profileOf(profile);
    rules.minAngleDeg = minAngleDeg;
    rules.maxPairs = maxPairs;
    std::string json;
    runUnlocked(threads, [&] { json = dumped(surfaceVerdict(data.mesh(), rules)); });
    return json;
}

std::string checkNested(const std::vector<std::shared_ptr<MeshData>>& meshes,
                        const std::vector<std::string>& names, const std::string& profile,
                        std::optional<double> minGapMm, std::optional<double> minAngleDeg,
                        std::int64_t maxPairs, int threads) {
    CheckRules rules;
    rules.isNested = true;
    rules.profile = profileOf(profile);
    rules.minGapMm = minGapMm;
    rules.minAngleDeg = minAngleDeg;
    rules.maxPairs = maxPairs;
    std::vector<const TriangleMesh*> asked;
    for (const auto& mesh : meshes) asked.push_back(&mesh->mesh());
    std::string text;
    runUnlocked(threads, [&] { text = dumped(nestedJson(asked, names, {}, rules)); });
    return text;
}

/// adaptiso-compare's entry for one of the two.
Json measuresOf(const TriangleMesh& mesh, const char* name) {
    const double areaMm2 = surfaceArea(mesh);
    if (!(areaMm2 > 0)) {
        throw InvalidInput(std::string(name) +
                           ": its triangles have no area, so there is nothing to measure");
    }
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    const bool isSolid = topology.isClosed() && topology.isOriented();
    const BoundingBox box = boundingBox(mesh);
    return {{"triangles", mesh.triangles.size()},
            {"vertices", mesh.points.size()},
            {"areaMm2", number(areaMm2)},
            {"volumeMm3", isSolid ? number(enclosedVolume(mesh)) : Json(nullptr)},
            {"boundingBoxDiagonalMm", number(norm(box.size()))}};
}

std::string compareMeshes(const MeshData& a, const MeshData& b, std::int64_t samples,
                          bool isSymmetric, int threads, py::object progress) {
    Watcher watcher(std::move(progress));
    std::string text;
    watcher.run(threads, [&] {
        // in LPS, as the program does: where two triangles are equally near the same one counts
        const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {});
        const auto told = [&](const DistanceStatistics& distances) {
            return distances.samples == 0 ? Json(nullptr) : distanceJson(distances, toRas);
        };
        const TriangleMesh meshA = a.lps(), meshB = b.lps();
        const Json measuresA = measuresOf(meshA, "a"), measuresB = measuresOf(meshB, "b");
        const DistanceReport report =
            surfaceDistance(meshA, meshB, {samples, isSymmetric, watcher.callback()});
        text = dumped({{"a", measuresA},
                       {"b", measuresB},
                       {"options", {{"samples", samples}, {"symmetric", isSymmetric}}},
                       {"distances",
                        {{"aToB", told(report.aToB)},
                         {"bToA", told(report.bToA)},
                         {"combined", told(report.combined)}}}});
    });
    return text;
}

}  // namespace

void declareChecks(py::module_& module) {
    module.def("check", &checkMesh, py::arg("mesh"), py::arg("profile"), py::arg("min_angle"),
               py::arg("max_pairs"), py::arg("threads"));
    module.def("check_nested", &checkNested, py::arg("meshes"), py::arg("names"),
               py::arg("profile"), py::arg("min_gap"), py::arg("min_angle"), py::arg("max_pairs"),
               py::arg("threads"));
    module.def("compare", &compareMeshes, py::arg("a"), py::arg("b"), py::arg("samples"),
               py::arg("symmetric"), py::arg("threads"), py::arg("progress"));
}

}  // namespace adaptiso::python
