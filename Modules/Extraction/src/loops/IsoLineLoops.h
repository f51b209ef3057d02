#pragma once

#include <array>
#include <utility>
#include <vector>

#include "adaptiso/Extraction/detail/BoxCases.h"
#include "lattice/BlockSamples.h"
#include "lattice/BlockVertices.h"

namespace adaptiso::detail {

/// A rectangle on a lattice plane of a block: its corner of lowest position, the axis at right
/// angles to it, its cells along the two axes that follow.
struct FaceRectangle {
    std::array<int, 3> corner;
    int normal;
    int sizeU, sizeV;
};

/// Bit i: corner i of the rectangle is inside, (u, v) = 00, 10, 01, 11.
template <int N>
unsigned cornersOf(const BlockSamples<N>& samples, const FaceRectangle& rectangle) {
    const int u = axisAfter(rectangle.normal, 1), v = axisAfter(rectangle.normal, 2);
    unsigned corners = 0;
    for (int c = 0; c < 4; ++c) {
        std::array<int, 3> p = rectangle.corner;
        if (c & 1) p[u] += rectangle.sizeU;
        if (c >> 1) p[v] += rectangle.sizeV;
        corners |= static_cast<unsigned>(samples.inside(p)) << c;
    }
    return corners;
}

/// The iso-lines on the faces of one box at a time, chained into closed loops. A vertex is the code
/// (EdgeCode) of the crossed lattice edge that it lies on.
template <int N>
class IsoLineLoops {
public:
    /// Adds the iso-lines of a rectangle on a face of the box. \pre no lign varies twice in it
    void add(const BlockSamples<N>& samples, const FaceRectangle& rectangle, int face) {
        const unsigned corners = cornersOf(samples, rectangle);
        const bool joined =
            isAmbiguous(corners) && samples.insideJoins(rectangle.corner, rectangle.normal,
                                                        rectangle.sizeU, rectangle.sizeV);
        const SquareIsoLines lines = squareIsoLines(corners, joined);
        for (int i = 0; i < lines.count; ++i) {
            int from = vertexOn(samples, rectangle, lines.lines[i].from);
            int to = vertexOn(samples, rectangle, lines.lines[i].to);
            if ((face & 1) == 0) std::swap(from, to);  // seen from outside, u and v are mirrored
            next_[from] = to;
            starts_.push_back(from);
        }
    }

    /// Calls f(vertex, isLast of its loop) along every loop, the inside to its left, and forgets
    /// them. Returns their number. \pre the faces of a box have been added whole
    template <class F>
    int takeLoops(const F& f) {
        int loops = 0;
        for (const int start : starts_) {
            if (next_[start] < 0) continue;
            ++loops;
            for (int vertex = start; next_[vertex] >= 0;) {
                const int following = std::exchange(next_[vertex], -1);
                f(vertex, following == start);
                vertex = following;
            }
        }
        starts_.clear();
        return loops;
    }

private:
    static int vertexOn(const BlockSamples<N>& samples, const FaceRectangle& rectangle, int side) {
        const int u = axisAfter(rectangle.normal, 1), v = axisAfter(rectangle.normal, 2);
        std::array<int, 3> p = rectangle.corner;
        if (side == 1) p[u] += rectangle.sizeU;
        if (side == 2) p[v] += rectangle.sizeV;
        const bool alongU = side % 2 == 0;
        const int axis = alongU ? u : v;
        p[axis] = samples.crossingOn(p, axis, alongU ? rectangle.sizeU : rectangle.sizeV);
        return EdgeCode<N>::encode(p, axis);
    }

    std::vector<int> next_ = std::vector<int>(EdgeCode<N>::kCount, -1);  ///< by vertex
    std::vector<int> starts_;                                            ///< of iso-lines
};

}  // namespace adaptiso::detail
