#include "adaptiso/Extraction/detail/BoxCases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace {

using IntVec = std::array<int, 3>;

IntVec subtract(const IntVec& a, const IntVec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
IntVec crossProduct(const IntVec& a, const IntVec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
int dotProduct(const IntVec& a, const IntVec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Midpoints of the box edges in half box sides.
constexpr auto kMidpoints = [] {
    std::array<IntVec, kBoxEdges> points{};
    for (int edge = 0; edge < kBoxEdges; ++edge) {
        const int corner = lowCorner(edge);
        points[edge] = {2 * (corner & 1), corner & 2, (corner & 4) / 2};
        points[edge][edgeAxis(edge)] = 1;
    }
    return points;
}();
const IntVec& midpoint(int edge) {
    return kMidpoints[edge];
}

/// Bit f: the box edge borders face f.
constexpr auto kFacesAtEdge = [] {
    std::array<unsigned, kBoxEdges> faces{};
    for (int face = 0; face < kBoxFaces; ++face) {
        for (int side = 0; side < 4; ++side) faces[faceEdge(face, side)] |= 1u << face;
    }
    return faces;
}();

bool onCommonFace(int a, int b) {
    return (kFacesAtEdge[a] & kFacesAtEdge[b]) != 0;
}

/// Number of the plane family that a normal direction belongs to (0 .. 12), or kNoIncidence when
/// the direction is not a multiple of a vector of -1, 0 and 1.
int incidenceOf(const IntVec& normal) {
    int largest = 0;
    for (const int c : normal) largest = std::max(largest, std::abs(c));
    if (largest == 0) return kNoIncidence;
    IntVec unit;
    for (int i = 0; i < 3; ++i) {
        if (normal[i] % largest != 0) return kNoIncidence;
        unit[i] = normal[i] / largest;
    }
    const int code = unit[0] + 3 * unit[1] + 9 * unit[2];  // -13 .. 13, opposite normals negate it
    return std::abs(code) - 1;
}

/// Box edges in order; a loop meets each at most once.
class Polygon {
public:
    std::size_t size() const { return size_; }
    int operator[](std::size_t i) const { return edge_[i]; }
    void add(int edge) { edge_[size_++] = static_cast<std::int8_t>(edge); }
    const std::int8_t* begin() const { return edge_.data(); }
    const std::int8_t* end() const { return edge_.data() + size_; }

private:
    std::array<std::int8_t, kBoxEdges> edge_{};
    std::size_t size_ = 0;
};

IntVec areaVector(const Polygon& polygon) {
    IntVec area{0, 0, 0};
    const IntVec apex = midpoint(polygon[0]);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const IntVec part = crossProduct(subtract(midpoint(polygon[i]), apex),
                                         subtract(midpoint(polygon[i + 1]), apex));
        for (int c = 0; c < 3; ++c) area[c] += part[c];
    }
    return area;
}

/// A plane, convex polygon in one of the 13 families: a facet of discretized marching cubes.
bool isFacet(const Polygon& polygon) {
    const IntVec area = areaVector(polygon);
    if (incidenceOf(area) == kNoIncidence) return false;
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
        const IntVec p = midpoint(polygon[i]), q = midpoint(polygon[(i + 1) % n]),
                     r = midpoint(polygon[(i + 2) % n]);
        if (dotProduct(area, subtract(p, midpoint(polygon[0]))) != 0) return false;
        if (dotProduct(area, crossProduct(subtract(q, p), subtract(r, q))) < 0) return false;
    }
    return true;
}

/// Cuts a loop into as few facets as can be. A chord on a face of the box would lie in the
/// neighbour too, and a triangle in none of the 13 families can't be merged: both only where
/// nothing else is left.
class LoopCutter {
public:
    explicit LoopCutter(const Polygon& loop) : loop_(loop) {}

    std::vector<Polygon> cut() {
        std::vector<Polygon> facets;
        collect(0, static_cast<int>(loop_.size()) - 1, facets);
        return facets;
    }

    /// \pre cut() was called
    bool needsChordOnFace() {
        return plan(0, static_cast<int>(loop_.size()) - 1).cost >= kChordOnFace;
    }

private:
    static constexpr int kFacet = 1, kOddTriangle = 100, kChordOnFace = 1000, kFlat = 100000;
    static constexpr std::size_t kLargestFacet = 6;  // a plane cuts a cube in a hexagon at most

    /// The cheapest way to cut the part of the loop from vertex i to vertex j, closed by the chord
    /// i j: the facet at that chord, which leaves smaller parts at its other sides.
    struct Plan {
        int cost = std::numeric_limits<int>::max();
        std::array<int, kLargestFacet> corner{};
        int corners = 0;
    };

    const Plan& plan(int i, int j) {
        Plan& best = plans_[i][j];
        if (best.corners == 0) {
            std::array<int, kLargestFacet> chosen{i};
            extend(chosen, 1, j, 0, best);
        }
        return best;
    }

    /// Tries every facet at the chord whose first `count` corners are `chosen`. Of four corners and
    /// more only those in one plane: others are no facets.
    void extend(std::array<int, kLargestFacet>& chosen, int count, int j, int cost, Plan& best) {
        for (int k = chosen[count - 1] + 1; k < j; ++k) {
            if (count > 1 && !isInPlane(chosen[0], chosen[1], k, j)) continue;
            const int sideCost = cost + costOfSide(chosen[count - 1], k);
            if (sideCost >= best.cost) continue;
            chosen[count] = k;
            chosen[count + 1] = j;
            const int total = sideCost + costOfSide(k, j);
            if (total + kFacet < best.cost) {
                const int whole = total + costOfFacet(chosen, count + 2);
                if (whole < best.cost) best = {whole, chosen, count + 2};
            }
            if (count + 2 < static_cast<int>(kLargestFacet)) {
                extend(chosen, count + 1, j, sideCost, best);
            }
        }
    }

    bool isInPlane(int a, int b, int c, int d) const {
        const IntVec p = midpoint(loop_[a]);
        const auto from = [&](int corner) { return subtract(midpoint(loop_[corner]), p); };
        return dotProduct(crossProduct(from(b), from(c)), from(d)) == 0;
    }

    int costOfSide(int a, int b) {
        if (b == a + 1) return 0;
        const bool onFace = onCommonFace(loop_[a], loop_[b]);
        return plan(a, b).cost + (onFace ? kChordOnFace : 0);
    }

    int costOfFacet(const std::array<int, kLargestFacet>& corner, int count) const {
        Polygon polygon;
        for (int c = 0; c < count; ++c) polygon.add(loop_[corner[c]]);
        if (isFacet(polygon)) return kFacet;
        if (count > 3) return kFlat;
        return areaVector(polygon) == IntVec{0, 0, 0} ? kFlat : kOddTriangle;
    }

    void collect(int i, int j, std::vector<Polygon>& facets) {
        const Plan chosen = plan(i, j);
        Polygon facet;
        for (int c = 0; c < chosen.corners; ++c) facet.add(loop_[chosen.corner[c]]);
        facets.push_back(facet);
        for (int c = 0; c + 1 < chosen.corners; ++c) {
            if (chosen.corner[c + 1] > chosen.corner[c] + 1) {
                collect(chosen.corner[c], chosen.corner[c + 1], facets);
            }
        }
    }

    const Polygon& loop_;
    std::array<std::array<Plan, kBoxEdges>, kBoxEdges> plans_{};
};

/// Face that the iso-line from edge `a` to edge `b` runs on, by start edge; see loopsOf.
struct BoxIsoLines {
    std::array<int, kBoxEdges> to;
    std::array<int, kBoxEdges> face;
};

BoxIsoLines isoLinesOf(unsigned corners, unsigned joined) {
    BoxIsoLines lines;
    lines.to.fill(-1);
    lines.face.fill(-1);
    for (int face = 0; face < kBoxFaces; ++face) {
        unsigned square = 0;
        const std::array<int, 4> corner = faceCorners(face);
        for (int i = 0; i < 4; ++i) square |= (corners >> corner[i] & 1u) << i;
        const SquareIsoLines found = squareIsoLines(square, joined >> face & 1u);
        for (int i = 0; i < found.count; ++i) {
            int from = faceEdge(face, found.lines[i].from), to = faceEdge(face, found.lines[i].to);
            if ((face & 1) == 0) std::swap(from, to);  // seen from outside, u and v are mirrored
            lines.to[from] = to;
            lines.face[from] = face;
        }
    }
    return lines;
}

std::vector<Polygon> loopsOf(const BoxIsoLines& lines) {
    std::vector<Polygon> loops;
    std::array<bool, kBoxEdges> seen{};
    for (int start = 0; start < kBoxEdges; ++start) {
        if (lines.to[start] < 0 || seen[start]) continue;
        Polygon loop;
        for (int edge = start; !seen[edge]; edge = lines.to[edge]) {
            seen[edge] = true;
            loop.add(edge);
        }
        loops.push_back(loop);
    }
    return loops;
}

int sideOf(int face, int edge) {
    for (int side = 0; side < 4; ++side) {
        if (faceEdge(face, side) == edge) return side;
    }
    throw InternalError("BoxCases: edge is not on the face");
}

void addFacet(BoxCase& box, const Polygon& facet, const BoxIsoLines& lines) {
    const std::uint8_t first = box.halfEdgeCount;
    const int n = static_cast<int>(facet.size());
    const IntVec area = areaVector(facet);
    const int incidence = isFacet(facet) ? incidenceOf(area) : kNoIncidence;
    CaseFacet& record = box.facet[box.facetCount];
    record = {first, static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(incidence), {0, 0, 0}};
    if (incidence != kNoIncidence) {
        for (int c = 0; c < 3; ++c) {
            record.normal[c] = static_cast<std::int8_t>((area[c] > 0) - (area[c] < 0));
        }
    }
    for (int i = 0; i < n; ++i) {
        const int edge = facet[i], following = facet[(i + 1) % n];
        CaseHalfEdge& half = box.halfEdge[first + i];
        const bool onFace = lines.to[edge] == following;
        half.edge = static_cast<std::uint8_t>(edge);
        half.face = static_cast<std::uint8_t>(onFace ? lines.face[edge] : kInsideBox);
        half.next = static_cast<std::uint8_t>(first + (i + 1) % n);
        half.facet = box.facetCount;
        const IntVec step = subtract(midpoint(following), midpoint(edge));
        for (int c = 0; c < 3; ++c) half.direction[c] = static_cast<std::int8_t>(step[c]);
        if (onFace) {
            box.onFace[half.face][sideOf(half.face, edge)] = static_cast<std::uint8_t>(first + i);
        }
    }
    box.halfEdgeCount = static_cast<std::uint8_t>(first + n);
    ++box.facetCount;
}

void addTriangles(BoxCase& box, const Polygon& facet) {
    for (std::size_t i = 1; i + 1 < facet.size(); ++i) {
        box.triangle[box.triangleCount++] = {static_cast<std::uint8_t>(facet[0]),
                                             static_cast<std::uint8_t>(facet[i]),
                                             static_cast<std::uint8_t>(facet[i + 1])};
    }
}

BoxCase makeCase(unsigned corners, unsigned joined) {
    BoxCase box;
    for (auto& face : box.onFace) face.fill(255);
    const BoxIsoLines lines = isoLinesOf(corners, joined);
    for (const Polygon& loop : loopsOf(lines)) {
        box.loopLength[box.loopCount++] = static_cast<std::uint8_t>(loop.size());
        for (const std::int8_t edge : loop) {
            box.loopEdge[box.crossedEdges++] = static_cast<std::uint8_t>(edge);
        }
        LoopCutter cutter(loop);
        const std::vector<Polygon> facets = cutter.cut();
        for (const Polygon& facet : facets) addTriangles(box, facet);
        if (cutter.needsChordOnFace()) {
            box.hasChordOnFace = true;
            addFacet(box, loop, lines);
        } else {
            for (const Polygon& facet : facets) addFacet(box, facet, lines);
        }
    }
    return box;
}

}  // namespace

SquareIsoLines squareIsoLines(unsigned corners, bool joined) {
    constexpr std::uint8_t kBottom = 0, kRight = 1, kTop = 2, kLeft = 3;
    if (joined && corners == 0b0110) return {2, {{{kBottom, kLeft}, {kTop, kRight}}}};
    if (joined && corners == 0b1001) return {2, {{{kRight, kBottom}, {kLeft, kTop}}}};
    static constexpr SquareIsoLines kLines[] = {{},
                                                {1, {{{kLeft, kBottom}, {}}}},
                                                {1, {{{kBottom, kRight}, {}}}},
                                                {1, {{{kLeft, kRight}, {}}}},
                                                {1, {{{kTop, kLeft}, {}}}},
                                                {1, {{{kTop, kBottom}, {}}}},
                                                {2, {{{kBottom, kRight}, {kTop, kLeft}}}},
                                                {1, {{{kTop, kRight}, {}}}},
                                                {1, {{{kRight, kTop}, {}}}},
                                                {2, {{{kLeft, kBottom}, {kRight, kTop}}}},
                                                {1, {{{kBottom, kTop}, {}}}},
                                                {1, {{{kLeft, kTop}, {}}}},
                                                {1, {{{kRight, kLeft}, {}}}},
                                                {1, {{{kRight, kBottom}, {}}}},
                                                {1, {{{kBottom, kLeft}, {}}}},
                                                {}};
    return kLines[corners];
}

const BoxCases& BoxCases::instance() {
    static const BoxCases kCases;
    return kCases;
}

BoxCases::BoxCases() {
    for (unsigned corners = 0; corners < 256; ++corners) {
        Group& group = groups_[corners];
        group.first = static_cast<std::uint16_t>(caseCount_);
        for (int face = 0; face < kBoxFaces; ++face) {
            unsigned square = 0;
            const std::array<int, 4> corner = faceCorners(face);
            for (int i = 0; i < 4; ++i) square |= (corners >> corner[i] & 1u) << i;
            if (!isAmbiguous(square)) continue;
            group.ambiguousFace[group.ambiguousCount++] = static_cast<std::uint8_t>(face);
            group.ambiguousMask = static_cast<std::uint8_t>(group.ambiguousMask | 1u << face);
        }
        for (unsigned decision = 0; decision < 1u << group.ambiguousCount; ++decision) {
            unsigned joined = 0;
            for (int i = 0; i < group.ambiguousCount; ++i) {
                joined |= (decision >> i & 1u) << group.ambiguousFace[i];
            }
            cases_.at(caseCount_++) = makeCase(corners, joined);
        }
    }
}

}  // namespace adaptiso::detail
