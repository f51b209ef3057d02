#include "adaptiso/Extraction/Simplify.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <utility>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "adaptiso/Extraction/PointTransfer.h"

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
    const auto made = data.alike(std::move(result.mesh));
    made->setErrorBoundMm(result.statistics.errorBoundMm);
    made->setRequestedBoundMm(options.maxErrorMm);
    py::dict found = toDict(result.statistics);
    found["warnings"] = warningsOfBound(options.maxErrorMm, data.mesh());
    return py::make_tuple(made, found);
}

/// Where values at the vertices of `from` are to be read for those of `to`: corners of triangles
/// (n, 3), their weights (n, 3), and of each three the nearest (n).
py::tuple transferOf(const MeshData& to, const MeshData& from) {
    std::optional<PointTransfer> transfer;
    runUnlocked(0, [&] { transfer.emplace(from.mesh(), to.mesh()); });
    const auto count = static_cast<py::ssize_t>(transfer->size());
    py::array_t<std::int64_t> corners({count, py::ssize_t{3}}), nearest(count);
    py::array_t<double> weights({count, py::ssize_t{3}});
    for (py::ssize_t n = 0; n < count; ++n) {
        const auto point = static_cast<std::size_t>(n);
        nearest.mutable_at(n) = transfer->nearestCorner(point);
        for (int c = 0; c < 3; ++c) {
            corners.mutable_at(n, c) = transfer->corners(point)[c];
            weights.mutable_at(n, c) = transfer->weights(point)[c];
        }
    }
    return py::make_tuple(corners, weights, nearest);
}

}  // namespace

void declareSimplify(py::module_& module) {
    module.def("point_transfer", transferOf, py::arg("to"), py::arg("from_"));
    module.def(
        "simplify_mesh",
        [](const MeshData& mesh, const py::dict& options, int threads, py::object progress) {
            SimplifyOptions simplified;
            takeAims(AimedSurface::Mesh, simplified, options);
            take(simplifyOptions(), simplified, options);
            return simplifyMesh(mesh, std::move(simplified), threads, std::move(progress));
        },
        py::arg("mesh"), py::arg("options"), py::arg("threads"), py::arg("progress"));
}

}  // namespace adaptiso::python
