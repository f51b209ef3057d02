#include "adaptiso/SurfaceChecks/Checks.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"
#include "adaptiso/SurfaceChecks/SurfaceSize.h"

namespace adaptiso::python {
namespace {

CheckRules rulesOf(const py::dict& options) {
    CheckRules rules;
    take(ruleOptions(), rules, options);
    rules.measuresWalls = rules.minWallMm.has_value();
    return rules;
}

/// Nothing is wrong with a mesh of no triangle, nor is it a surface: files without are refused too.
void requireTriangles(const MeshData& data, const std::string& name) {
    if (data.mesh().triangles.empty()) throw InvalidInput(name + ": has no triangles");
}

std::string checkMesh(const MeshData& data, const py::dict& options, int threads) {
    const CheckRules rules = rulesOf(options);
    requireTriangles(data, "mesh");
    std::string json;
    runUnlocked(threads, [&] {
        TriangleMesh apart;
        std::vector<Solid> solids;
        if (!data.solids().empty()) solids = separateSolids(apart = data.mesh(), data.solids());
        json = dumped(surfaceVerdict(solids.empty() ? data.mesh() : apart, rules, solids));
    });
    return json;
}

std::string checkNested(const std::vector<std::shared_ptr<MeshData>>& meshes,
                        const std::vector<std::string>& names, const py::dict& options,
                        int threads) {
    CheckRules rules = rulesOf(options);
    rules.isNested = true;
    std::vector<const TriangleMesh*> surfaces;
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        requireTriangles(*meshes[n], names[n]);
        surfaces.push_back(&meshes[n]->mesh());
    }
    std::string text;
    runUnlocked(threads, [&] { text = dumped(nestedJson(surfaces, names, {}, rules)); });
    return text;
}

std::string compareMeshes(const MeshData& a, const MeshData& b, std::int64_t samples,
                          bool isSymmetric, int threads, py::object progress) {
    Watcher watcher(std::move(progress));
    std::string text;
    watcher.run(threads, [&] {
        // in LPS, as the program does: where two triangles are equally near the same one counts
        const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {});
        const auto told = [&](const DistanceStatistics& distances,
                              const HausdorffInterval& hausdorff) {
            Json json = distanceJson(distances, toRas);
            json["hausdorff"] = hausdorffJson(hausdorff, toRas);
            return json;
        };
        const TriangleMesh meshA = a.lps(), meshB = b.lps();
        const SurfaceSize sizeA = measureSize(meshA, "a"), sizeB = measureSize(meshB, "b");
        const DistanceReport report =
            surfaceDistance(meshA, meshB, {samples, isSymmetric, watcher.callback()});
        HausdorffOptions options;
        options.isSymmetric = isSymmetric;
        options.progress = watcher.callback();
        options.farOnA = report.aToB.maxPointMm;
        if (isSymmetric) options.farOnB = report.bToA.maxPointMm;
        const HausdorffReport hausdorff = hausdorffDistance(meshA, meshB, options);
        text = dumped({{"a", sizeJson(sizeA)},
                       {"b", sizeJson(sizeB)},
                       {"options", {{"samples", samples}, {"symmetric", isSymmetric}}},
                       {"distances",
                        {{"aToB", told(report.aToB, hausdorff.aToB)},
                         {"bToA", isSymmetric ? told(report.bToA, *hausdorff.bToA) : Json(nullptr)},
                         {"combined", told(report.combined, hausdorff.combined)}}},
                       {"warnings", roughDistanceWarnings(report.combined, hausdorff.combined)}});
    });
    return text;
}

}  // namespace

void declareChecks(py::module_& module) {
    module.def("check", &checkMesh, py::arg("mesh"), py::arg("options"), py::arg("threads"));
    module.def("check_nested", &checkNested, py::arg("meshes"), py::arg("names"),
               py::arg("options"), py::arg("threads"));
    module.def("compare", &compareMeshes, py::arg("a"), py::arg("b"), py::arg("samples"),
               py::arg("symmetric"), py::arg("threads"), py::arg("progress"));
}

}  // namespace adaptiso::python
