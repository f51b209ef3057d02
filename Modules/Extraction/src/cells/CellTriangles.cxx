#include "cells/CellTriangles.h"

#include <algorithm>

#include "adaptiso/MeshQuality/Certificate.h"

namespace adaptiso::detail {
namespace {

/// Room between two triangles of a cell, in cells.
constexpr double kGap = 1e-9;

/// It is sure that two triangles of the table, named by their edges, do not cross.
bool areClear(const std::array<std::uint8_t, 3>& a, const std::array<std::uint8_t, 3>& b,
              const CellCrossings& p) {
    std::array<int, 3> inB{};  // where a corner of a stands in b, or -1
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const auto at = std::find(b.begin(), b.end(), a[i]);
        inB[i] = at == b.end() ? -1 : static_cast<int>(at - b.begin());
        if (inB[i] >= 0) ++shared;
    }
    const auto cornersFrom = [&](const std::array<std::uint8_t, 3>& t, int first) {
        return Corners{p[t[first]], p[t[(first + 1) % 3]], p[t[(first + 2) % 3]]};
    };
    if (shared == 0) return areApart(cornersFrom(a, 0), cornersFrom(b, 0), kGap);
    if (shared == 1) {
        const int i = inB[0] >= 0 ? 0 : inB[1] >= 0 ? 1 : 2;
        return touchAtVertexOnly(cornersFrom(a, i), cornersFrom(b, inB[i]), kGap);
    }
    if (shared == 3) return false;
    const int other = inB[0] < 0 ? 0 : inB[1] < 0 ? 1 : 2;  // the corner of a that b does not have
    const Corners edgeFirst = cornersFrom(a, (other + 1) % 3);
    const int otherInB = 3 - inB[(other + 1) % 3] - inB[(other + 2) % 3];
    return touchAtEdgeOnly(edgeFirst, {edgeFirst[1], edgeFirst[0], p[b[otherInB]]});
}

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
            if (!areClear(boxCase.triangle[i], boxCase.triangle[j], crossings)) return true;
        }
    }
    return false;
}

}  // namespace adaptiso::detail
