#include "adaptiso/LabelPipeline/LabelsJson.h"

namespace adaptiso {

Json wallsJson(std::int64_t points, std::int64_t triangles, double errorBoundMm,
               const LabelStatistics& statistics) {
    return {{"points", points},
            {"triangles", triangles},
            {"mapTriangles", triangles},
            {"fullTriangles", statistics.fullTriangles},
            {"wantedTriangles", orNull(statistics.wantedTriangles)},
            {"errorBoundMm", number(errorBoundMm)},
            {"cells", statistics.cells},
            {"dividedCells", statistics.dividedCells},
            {"heldVertices", statistics.heldVertices},
            {"mendedCrossings", statistics.mendedCrossings}};
}

Json measureJson(Json begin, const RegionMeasure& measure) {
    Json neighbours = Json::array();
    for (const RegionContact& contact : measure.neighbours) {
        neighbours.push_back({{"label", contact.label},
                              {"triangles", contact.triangles},
                              {"areaMm2", number(contact.areaMm2)}});
    }
    begin.update(Json{{"volumeMm3", number(measure.volumeMm3)},
                      {"areaMm2", number(measure.areaMm2)},
                      {"vertices", measure.vertices},
                      {"triangles", measure.triangles},
                      {"eulerCharacteristic", measure.eulerCharacteristic},
                      {"components", measure.components},
                      {"neighbours", neighbours}});
    return begin;
}

}  // namespace adaptiso
