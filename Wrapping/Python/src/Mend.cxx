#include "adaptiso/Extraction/Mend.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadModel/NestSurfaces.h"

namespace adaptiso::python {
namespace {

py::list toList(const std::vector<MendedPlace>& places) {
    py::list list;
    for (const MendedPlace& place : places) {
        py::dict each;
        each["middle"] = py::make_tuple(place.middleMm.x, place.middleMm.y, place.middleMm.z);
        each["span"] = place.spanMm;
        each["area"] = place.areaMm2;
        list.append(each);
    }
    return list;
}

py::dict toDict(const MendStatistics& statistics) {
    py::dict found;
    found["was_sound"] = statistics.wasSound;
    found["degenerate_triangles"] = statistics.degenerateTriangles;
    found["duplicate_triangles"] = statistics.duplicateTriangles;
    found["merged_points"] = statistics.mergedPoints;
    found["flipped_triangles"] = statistics.flippedTriangles;
    found["border_edges"] = statistics.borderEdges;
    found["bad_edges"] = statistics.badEdges;
    found["bad_vertices"] = statistics.badVertices;
    found["crossing_triangles"] = statistics.crossingTriangles;
    found["handles"] = statistics.handles;
    found["kept_triangles"] = statistics.keptTriangles;
    found["cut_triangles"] = statistics.cutTriangles;
    found["filled"] = toList(statistics.filled);
    found["left_open"] = toList(statistics.leftOpen);
    found["inner"] = toList(statistics.inner);
    found["thin"] = toList(statistics.thin);
    found["cut_handles"] = toList(statistics.cutHandles);
    found["filled_handles"] = toList(statistics.filledHandles);
    found["max_error"] = statistics.maxErrorMm;
    found["result_to_input"] = statistics.resultToInputMm;
    found["input_to_result"] = statistics.inputToResultMm;
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
    auto made =
        std::make_shared<MeshData>(MeshData::asStored(std::move(result.mesh), data.frame()));
    if (data.image()) made->setImage(*data.image());
    made->setFrameKnown(data.isFrameKnown());
    result.statistics.resultToInputMm += nested.move.maximumMm;
    result.statistics.inputToResultMm += nested.move.maximumMm;
    py::dict found = toDict(result.statistics);
    found["gap"] = around.fixed == nullptr ? py::object(py::none()) : py::cast(nested.gap.mm);
    found["moved_vertices"] = nested.move.movedVertices;
    found["largest_move"] = nested.move.maximumMm;
    std::vector<Warning> warnings;
    if (options.maxErrorMm) {
        const auto warning = boundOverSize("max_error", *options.maxErrorMm,
                                           norm(boundingBox(data.mesh()).size()), {});
        if (warning) warnings.push_back(*warning);
    }
    found["warnings"] = warnings;
    return py::make_tuple(std::move(made), found);
}

}  // namespace

void declareMend(py::module_& module) {
    module.def(
        "mend_mesh",
        [](const MeshData& mesh, const py::dict& options, const MeshData* around, double gap,
           int threads, py::object progress) {
            MendOptions mended;
            take(mendOptions(), mended, options);
            return mendMesh(mesh, std::move(mended), {around, gap}, threads, std::move(progress));
        },
        py::arg("mesh"), py::arg("options"), py::arg("around"), py::arg("gap"), py::arg("threads"),
        py::arg("progress"));
}

}  // namespace adaptiso::python
