#include <utility>

#include "Common/Mesher.h"
#include "Regions.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::labels {

void requireFittingLabels(const LabelsRun& run) {
    const bool isMeshed = run.options.tetrahedra.isRequested();
    if (!isMeshed && !run.options.writesLayers) return;
    if (run.ids.areNumbered()) {
        throw InvalidInput(std::string(isMeshed ? "--tetrahedra" : "--layers") +
                           ": the map has labels beyond 2147483647, which the files do not hold");
    }
    for (const Region& region : run.regions) {
        if (!isMeshed || region.label >= 1) continue;
        throw InvalidInput("--tetrahedra: the map has the label " + std::to_string(region.label) +
                           "; Gmsh's numbers of volumes begin with 1");
    }
}

void makeTetrahedra(const LabelComplex& complex, LabelsRun& run) {
    RegionTetrahedra made;
    for (const Region& region : run.regions) {
        made.regions.push_back(
            {region.label, region.name, region.measure.volumeMm3, region.measure.areaMm2});
    }
    made.mesh = runMesher(labelMesherInput(complex, labelsOf(run.regions)), run.options.tetrahedra);
    takeRegions(made.mesh, made.regions);
    made.report = checkTetrahedra(made.mesh, made.regions);
    LabelsCheck all{
        "tetrahedra: each of a region, none flat, each region's volume as within its walls"};
    for (const TetrahedraCheck& check : judgeTetrahedra(made.report, made.regions)) {
        if (check.isPassed) continue;
        all.finding += (all.isPassed ? "" : "; ") + check.name + ": " + check.detail;
        all.isPassed = false;
    }
    run.checks.push_back(std::move(all));
    run.tetrahedra = std::move(made);
}

}  // namespace adaptiso::labels
