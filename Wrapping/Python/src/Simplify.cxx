#include "adaptiso/Extraction/Simplify.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::python {
namespace {

py::dict toDict(const SimplifyStatistics& statistics) {
    py::dict found;
    found["degenerate_triangles"] = statistics.degenerateTriangles;
    found["duplicate_triangles"] = statistics.duplicateTriangles;
    found["border_edges"] = statistics.borderEdges;
    found["non_manifold_vertices"] = statistics.nonManifoldVertices;
    found["crossing_triangles"] = statistics.crossingTriangles;
    found["undecided_triangles"] = statistics.undecidedTriangles;
    found["wanted_triangles"] = statistics.wantedTriangles;
    return found;
}

py::tuple simplifyMesh(const MeshData& data, SimplifyOptions options, int threads,
                       py::object progress) {
    Watcher watcher(std::move(progress));
    options.progress = watcher.callback();
    Simplified result;
    watcher.run(threads, [&] { result = simplify(data.mesh(), options); });
    auto made =
        std::make_shared<MeshData>(MeshData::asStored(std::move(result.mesh), data.frame()));
    if (data.image()) made->setImage(*data.image());
    made->setFrameKnown(data.isFrameKnown());
    made->setErrorBoundMm(result.statistics.errorBoundMm);
    made->setAskedBoundMm(options.maxErrorMm);
    py::dict found = toDict(result.statistics);
    std::vector<Warning> warnings;
    if (options.maxErrorMm && !data.mesh().points.empty()) {
        const auto warning = boundOverSize("max_error", *options.maxErrorMm,
                                           norm(boundingBox(data.mesh()).size()), {});
        if (warning) warnings.push_back(*warning);
    }
    found["warnings"] = warnings;
    return py::make_tuple(std::move(made), found);
}

/// Nearest point of `onto` for each vertex of `mesh`: triangles (n) and corners' weights (n, 3).
py::tuple nearestOf(const MeshData& mesh, const MeshData& onto) {
    std::vector<SurfacePoint> places;
    runUnlocked(0, [&] { places = nearestPoints(mesh.mesh(), onto.mesh()); });
    const auto count = static_cast<py::ssize_t>(places.size());
    py::array_t<std::int64_t> triangles(count);
    py::array_t<double> weights({count, py::ssize_t{3}});
    for (py::ssize_t n = 0; n < count; ++n) {
        const SurfacePoint& place = places[static_cast<std::size_t>(n)];
        triangles.mutable_at(n) = place.triangle;
        for (int c = 0; c < 3; ++c) weights.mutable_at(n, c) = place.weight[c];
    }
    return py::make_tuple(triangles, weights);
}

}  // namespace

void declareSimplify(py::module_& module) {
    module.def("nearest_points", nearestOf, py::arg("mesh"), py::arg("onto"));
    module.def(
        "simplify_mesh",
        [](const MeshData& mesh, const py::dict& options, int threads, py::object progress) {
            SimplifyOptions simplified;
            take(aimOptions(AimedSurface::Mesh), simplified, options);
            take(borderOptions(), simplified, options);
            return simplifyMesh(mesh, std::move(simplified), threads, std::move(progress));
        },
        py::arg("mesh"), py::arg("options"), py::arg("threads"), py::arg("progress"));
}

}  // namespace adaptiso::python
