#include "Tetrahedra.h"

#include <utility>

#include "Common/Mesher.h"
#include "adaptiso/HeadModel/Tetrahedra.h"

namespace adaptiso {
namespace {

void addCheck(BemModel& model, const TetrahedraCheck& check) {
    model.checks.push_back({"tetrahedra: " + check.name, check.isPassed, check.detail, {}});
    if (check.isPassed) return;
    const Vec3 place = model.meshes.front().points.front();
    model.checks.back().pointMm = place;
    model.findings.push_back({"tetrahedra: " + check.name + ": " + check.detail, place});
}

}  // namespace

void makeTetrahedra(BemRun& run, const BemHooks& hooks) {
    BemModel& model = run.model;
    hooks.stage("tetrahedra", [&] {
        const std::vector<TetrahedraRegion> regions = headRegions(model.meshes);
        BemTetrahedra made;
        made.mesher = run.options.tetrahedra.mesher;
        made.mesh = runMesher(headMesherInput(model.meshes), run.options.tetrahedra);
        takeRegions(made.mesh, regions);
        made.report = checkTetrahedra(made.mesh, regions);
        model.notes.push_back(describeTetrahedra(made.mesh, made.report, made.mesher));
        for (const TetrahedraCheck& check : judgeTetrahedra(made.report, regions)) {
            addCheck(model, check);
        }
        model.tetrahedra = std::move(made);
    });
}

}  // namespace adaptiso
