#include "adaptiso/Mending/Mend.h"

#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <utility>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/Mending/MendJson.h"

namespace adaptiso::python {
namespace {

/// Keys as adaptiso-mend's report has them.
Json foundJson(const MendStatistics& statistics, const NestedAround& nested, bool isAround) {
    const double movedMm = nested.move.maximumMm;
    Json found{{"wasSound", statistics.wasSound}};
    found.update(mendFaultsJson(statistics));
    found.update(mendPlacesJson(statistics));
    found.update({{"keptTriangles", statistics.keptTriangles},
                  {"cutTriangles", statistics.cutTriangles},
                  {"maxErrorMm", statistics.maxErrorMm},
                  {"resultToInputMm", statistics.resultToInputMm + movedMm},
                  {"inputToResultMm", statistics.inputToResultMm + movedMm},
                  {"gapMm", isAround ? Json(nested.gap.mm) : Json()},
                  {"movedVertices", nested.move.movedVertices},
                  {"largestMoveMm", movedMm}});
    return found;
}

/// What mend() says, by Python's names.
std::string inWordsOfArguments(std::string text) {
    constexpr std::pair<std::string_view, std::string_view> kNames[] = {
        {"maxHoleMm", "max_hole"},
        {"maxErrorMm", "max_error"},
        {"removesHandles", "ball"},
        {"leavesHolesOpen", "open"}};
    for (const auto& [ours, theirs] : kNames) {
        const std::size_t at = text.find(ours);
        if (at != std::string::npos) text.replace(at, ours.size(), theirs);
    }
    return text;
}

/// A surface to lie around, in the frame of the mesh to mend, and how far away.
struct Around {
    const MeshData* fixed;  ///< null: none
    double gap;
};

py::tuple mendMesh(const MeshData& data, MendOptions options, const Around& around, int threads,
                   py::object progress) {
    Watcher watcher(std::move(progress));
    options.progress = watcher.callback();
    Mended result;
    NestedAround nested;
    try {
        watcher.run(threads, [&] {
            result = mend(data.mesh(), options);
            if (around.fixed == nullptr) return;
            try {
                nested = nestAround(result.mesh, around.fixed->mesh(), around.gap);
            } catch (const InvalidInput& refusal) {
                throw InvalidInput(std::string("around: ") + refusal.what());
            }
            result.mesh.points = nested.points;
            if (nested.move.movedVertices > 0) result.mesh.normals.clear();
        });
    } catch (const InvalidInput& refusal) {
        throw InvalidInput(inWordsOfArguments(refusal.what()));
    }
    const Json found = foundJson(result.statistics, nested, around.fixed != nullptr);
    auto warnings = warningsOfBound(options.maxErrorMm, data.mesh());
    const auto warning = mendWarning(result.statistics, surfaceArea(data.mesh()), {});
    if (warning) warnings.push_back(*warning);
    return py::make_tuple(data.alike(std::move(result.mesh)), dumped(found), warnings);
}

}  // namespace

void declareMend(py::module_& module) {
    module.def(
        "mend_mesh",
        [](const MeshData& mesh, const py::dict& options, const MeshData* around, double gap,
           int threads, py::object progress) {
            MendOptions mended;
            take(mendOptions(), mended, options);
            take(pieceOptions(), mended.pieces, options);
            return mendMesh(mesh, std::move(mended), {around, gap}, threads, std::move(progress));
        },
        py::arg("mesh"), py::arg("options"), py::arg("around"), py::arg("gap"), py::arg("threads"),
        py::arg("progress"));
}

}  // namespace adaptiso::python
