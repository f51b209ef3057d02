#include "cells/CellTriangles.h"

#include "adaptiso/MeshQuality/Certificate.h"

namespace adaptiso::detail {
namespace {

/// Room between two triangles of a cell, in cells.
constexpr double kGap = 1e-9;

}  // namespace

CellCrossings crossingsOfCell(const LatticeSampler& sampler, const Index3& lowSample,
                              const BoxCase& boxCase) {
    CellCrossings crossings{};
    for (int i = 0; i < boxCase.crossedEdges; ++i) {
        const int edge = boxCase.loopEdge[i], corner = lowCorner(edge);
        LatticeEdge on{lowSample, edgeAxis(edge)};
        Vec3& p = crossings[edge];
        for (int a = 0; a < 3; ++a) {
            on.sample[a] += corner >> a & 1;
            p[a] = static_cast<double>(on.sample[a]);
        }
        p[on.axis] += sampler.crossingAlong(on);
    }
    return crossings;
}

bool needsFans(const BoxCase& boxCase, const CellCrossings& crossings) {
    if (boxCase.hasChordOnFace) return true;
    for (int i = 0; i < boxCase.triangleCount; ++i) {
        for (int j = i + 1; j < boxCase.triangleCount; ++j) {
            if (!areClear<std::uint8_t>(crossings, boxCase.triangle[i], boxCase.triangle[j],
                                        kGap)) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace adaptiso::detail
