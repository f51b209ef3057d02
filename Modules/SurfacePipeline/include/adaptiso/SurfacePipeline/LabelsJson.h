#pragma once

#include "adaptiso/Json/Json.h"
#include "adaptiso/Labels/Labels.h"

// The numbers of label walls, as adaptiso-labels and the Python package report them.

namespace adaptiso {

/// The walls of a complex. \param errorBoundMm  of the file's points
inline Json wallsJson(std::int64_t points, std::int64_t triangles, double errorBoundMm,
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

/// `begin`, which has the region's label, with its measures.
inline Json measureJson(Json begin, const RegionMeasure& measure) {
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
