#include "lattice/BlockSamples.h"

#include "adaptiso/Extraction/detail/BoxCases.h"

namespace adaptiso::detail {

template <int N>
bool BlockSamples<N>::insideJoins(const std::array<int, 3>& corner, int normal, int sizeU,
                                  int sizeV) const {
    if (sizeU == 1 && sizeV == 1) return sampler_.insideJoins(sampleAt(corner), normal);

    constexpr int kBottom = 0, kRight = 1, kTop = 2, kLeft = 3;
    const int u = axisAfter(normal, 1), v = axisAfter(normal, 2);
    std::array<int, 3> cell = corner;
    cell[u] = crossingOn(corner, u, sizeU);
    int entry = kBottom;
    while (true) {
        unsigned square = 0;
        for (int c = 0; c < 4; ++c) {
            std::array<int, 3> p = cell;
            p[u] += c & 1;
            p[v] += c >> 1;
            square |= static_cast<unsigned>(inside(p)) << c;
        }
        const bool joined = isAmbiguous(square) && sampler_.insideJoins(sampleAt(cell), normal);
        const SquareIsoLines lines = squareIsoLines(square, joined);
        int exit = entry;
        for (int i = 0; i < lines.count; ++i) {
            if (lines.lines[i].from == entry) exit = lines.lines[i].to;
            if (lines.lines[i].to == entry) exit = lines.lines[i].from;
        }
        if (exit == kLeft && cell[u]-- == corner[u]) break;
        if (exit == kRight && ++cell[u] == corner[u] + sizeU) break;
        if (exit == kTop) ++cell[v];
        if (exit == kBottom) --cell[v];
        entry = (exit + 2) % 4;
    }
    // bottom to left goes round corner 00: joined unless that corner is inside
    const bool wentLeft = cell[u] < corner[u];
    return wentLeft != inside(corner);
}

template class BlockSamples<2>;
template class BlockSamples<4>;
template class BlockSamples<8>;
template class BlockSamples<16>;

}  // namespace adaptiso::detail
