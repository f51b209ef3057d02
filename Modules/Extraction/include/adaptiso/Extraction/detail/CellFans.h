#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Extraction/detail/BoxCases.h"

namespace adaptiso::detail {

/// Where the surface crosses a cell's edges, continuous sample indices. Edges that it does not
/// cross have no meaning.
using CellCrossings = std::array<Vec3, kBoxEdges>;

/// Is the cell's surface made of fans around the middle of each loop, instead of BoxCase::triangle?
///
/// That is so where the table has an edge across a face of the cell, which the neighbour may have
/// too, and where its triangles could cross each other. Fans do neither (all cases with ambiguous
/// faces, tested). Of cells without ambiguous faces it need not be asked: their triangles never
/// cross.
bool needsFans(const BoxCase& boxCase, const CellCrossings& crossings);

/// Calls triangle(e, f, g) for loops of three edges, and fan(loop, middle) for others: box edges in
/// order, and the mean of their crossings.
template <class MakeTriangle, class MakeFan>
void forEachFan(const BoxCase& boxCase, const CellCrossings& crossings,
                const MakeTriangle& triangle, const MakeFan& fan) {
    std::size_t first = 0;
    for (int l = 0; l < boxCase.loopCount; ++l) {
        const std::span<const std::uint8_t> loop{boxCase.loopEdge.data() + first,
                                                 boxCase.loopLength[l]};
        first += loop.size();
        if (loop.size() == 3) {
            triangle(loop[0], loop[1], loop[2]);
            continue;
        }
        Vec3 middle;
        for (const std::uint8_t edge : loop) middle += crossings[edge];
        fan(loop, (1.0 / static_cast<double>(loop.size())) * middle);
    }
}

}  // namespace adaptiso::detail
