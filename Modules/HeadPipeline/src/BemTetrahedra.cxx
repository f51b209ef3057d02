#include "adaptiso/HeadPipeline/BemTetrahedra.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/Tetrahedra.h"

namespace adaptiso {
namespace {

void addCheck(BemModel& model, const TetrahedraCheck& check) {
    BemCheck kept{"tetrahedra", check.name, check.isPassed, check.detail, {}};
    if (!check.isPassed) kept.pointMm = model.meshes.front().points.front();
    model.addCheck(std::move(kept));
}

/// Notes layers whose elements are longer than asked for: gmsh keeps the surfaces' triangles.
void noteLongElements(BemModel& model, const TetrahedralMesh& mesh,
                      std::span<const TetrahedraRegion> regions, double requestedMm) {
    constexpr double kLonger = 1.5, kNotedShare = 0.1;  // irregular ones are a half longer
    for (const TetrahedraRegion& region : regions) {
        std::int64_t count = 0, longer = 0;
        double longestMm = 0;
        for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
            if (mesh.labels[n] != region.label) continue;
            double mm = 0;
            for (const VertexId a : mesh.tetrahedra[n]) {
                for (const VertexId b : mesh.tetrahedra[n]) {
                    mm = std::max(mm, norm(mesh.points[a] - mesh.points[b]));
                }
            }
            ++count;
            longer += mm > kLonger * requestedMm ? 1 : 0;
            longestMm = std::max(longestMm, mm);
        }
        const double share = static_cast<double>(longer) / static_cast<double>(count);
        if (!(share > kNotedShare)) continue;
        model.notes.push_back(
            region.name + ": " + formatRounded(100 * share) +
            " % of its elements are longer than " + formatShort(kLonger) +
            " times --element-size " + formatShort(requestedMm) + ", up to " +
            formatLength(longestMm, 1) +
            " mm, as the triangles of its surfaces are; more --vertices shorten them");
    }
}

/// Gives elements in holes of the segmentation's skull (a craniotomy) to the scalp, with a note:
/// the surfaces are closed there, as boundary elements need. \pre model.segmented
void openHoles(BemModel& model, TetrahedralMesh& mesh) {
    const std::size_t count = model.meshes.size();
    const std::int32_t skull = tissueWithin(HeadSurface::OuterSkull, count).number;
    std::vector<std::size_t> elements;
    std::vector<Vec3> middlesMm;
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        if (mesh.labels[n] != skull) continue;
        Vec3 sum;
        for (const VertexId v : mesh.tetrahedra[n]) sum += mesh.points[v];
        elements.push_back(n);
        middlesMm.push_back(0.25 * sum);
    }
    const std::vector<bool> areOpen =
        areInHoles(middlesMm, model.meshes[count - 3], *model.skull, *model.segmented);
    std::int64_t opened = 0;
    double mm3 = 0;
    for (std::size_t n = 0; n < elements.size(); ++n) {
        if (!areOpen[n]) continue;
        mesh.labels[elements[n]] = tissueWithin(HeadSurface::OuterSkin, count).number;
        mm3 += volumeOf(mesh, mesh.tetrahedra[elements[n]]);
        ++opened;
    }
    model.segmented.reset();
    model.notes.push_back("tetrahedra: " + formatCount(opened) + " of the skull's (" +
                          formatMeasure(mm3 / 1000) +
                          " cm3), in holes of the segmentation's skull, are scalp");
}

}  // namespace

void takeTetrahedra(TetrahedralMesh mesh, const MesherOptions& options, BemModel& model) {
    const std::vector<TetrahedraRegion> regions = headRegions(model.meshes);
    takeRegions(mesh, regions);
    BemTetrahedra made{options.mesher, std::move(mesh), {}};
    made.report = checkTetrahedra(made.mesh, regions);
    model.notes.push_back(describeTetrahedra(made.mesh, made.report, made.mesher));
    noteLongElements(model, made.mesh, regions, options.elementMm);
    for (const TetrahedraCheck& check : judgeTetrahedra(made.report, regions)) {
        addCheck(model, check);
    }
    if (model.segmented) {
        openHoles(model, made.mesh);
        made.report = checkTetrahedra(made.mesh, regions);
    }
    model.tetrahedra = std::move(made);
}

}  // namespace adaptiso
