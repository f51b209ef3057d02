#include "MendInput.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "BorderCaps.h"
#include "DoubledTriangles.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/detail/FlatTriangles.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptiso/MeshQuality/InsideTest.h"

namespace adaptiso::detail {
namespace {

/// Points of borders, and of triangles without area, may move by as much of the bound to become
/// one.
constexpr double kNearBorder = 0.2, kNearFlat = 0.05;

/// How many triangles each edge has.
std::vector<std::int64_t> edgeUses(const MendInput& input) {
    std::vector<std::int64_t> uses(input.edges.size());
    for (const auto& edges : input.edgeOf) {
        for (const std::uint32_t e : edges) ++uses[e];
    }
    return uses;
}

std::vector<VertexId> borderPoints(const MendInput& input) {
    const std::vector<std::int64_t> uses = edgeUses(input);
    std::vector<VertexId> points;
    for (std::size_t e = 0; e < uses.size(); ++e) {
        if (uses[e] != 1) continue;
        points.push_back(input.edges[e].a);
        points.push_back(input.edges[e].b);
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

/// Points become others; edges follow. \return how many do
std::int64_t renumber(MendInput& input, const std::vector<VertexId>& becomes) {
    std::int64_t merged = 0;
    for (std::size_t v = 0; v < becomes.size(); ++v) {
        if (becomes[v] != static_cast<VertexId>(v)) ++merged;
    }
    if (merged == 0) return 0;
    for (Triangle& t : input.mesh.triangles) {
        for (VertexId& v : t) v = becomes[v];
    }
    findEdges(input);
    return merged;
}

std::vector<VertexId> themselves(std::size_t count) {
    std::vector<VertexId> points(count);
    std::iota(points.begin(), points.end(), VertexId{0});
    return points;
}

/// Points of borders become the first one at their place.
std::int64_t mergeBorderPoints(MendInput& input) {
    const std::vector<VertexId> place = firstAtPlace(input.mesh.points);
    std::vector<VertexId> first(place.size(), -1), becomes = themselves(place.size());
    for (const VertexId v : borderPoints(input)) {
        VertexId& of = first[place[v]];
        if (of < 0) of = v;
        becomes[v] = of;
    }
    return renumber(input, becomes);
}

/// Points of borders that lie as near to each other become the first of them, but where a triangle
/// has two of them, or they make a chain that reaches farther.
/// \param movedMm  raised to how far a point moves
std::int64_t mergeNearBorderPoints(MendInput& input, double reachMm, double& movedMm) {
    const std::vector<VertexId> border = borderPoints(input);
    const auto& points = input.mesh.points;
    using Cell = std::array<std::int64_t, 3>;
    const double side = 0.5 * reachMm;  // its diagonal is within reach
    const auto cellOf = [&](const Vec3& p) {
        return Cell{static_cast<std::int64_t>(std::floor(p.x / side)),
                    static_cast<std::int64_t>(std::floor(p.y / side)),
                    static_cast<std::int64_t>(std::floor(p.z / side))};
    };
    std::vector<std::pair<Cell, VertexId>> sorted;
    for (const VertexId v : border) sorted.emplace_back(cellOf(points[v]), v);
    std::sort(sorted.begin(), sorted.end());
    DisjointSets sets(std::ssize(points));
    // points of a cell are near each other; of neighbouring cells the first that are join all
    std::vector<std::size_t> begins;
    for (std::size_t n = 0; n < sorted.size(); ++n) {
        if (n == 0 || sorted[n].first != sorted[n - 1].first) begins.push_back(n);
        sets.join(sorted[begins.back()].second, sorted[n].second);
    }
    begins.push_back(sorted.size());
    const auto areNear = [&](std::size_t one, std::size_t other) {
        constexpr std::size_t kMostPairs = 4096;  // of more, points are taken for far
        const std::size_t pairs =
            (begins[one + 1] - begins[one]) * (begins[other + 1] - begins[other]);
        if (pairs > kMostPairs) return false;
        for (std::size_t i = begins[one]; i < begins[one + 1]; ++i) {
            for (std::size_t j = begins[other]; j < begins[other + 1]; ++j) {
                const Vec3 away = points[sorted[i].second] - points[sorted[j].second];
                if (squaredNorm(away) <= reachMm * reachMm) return true;
            }
        }
        return false;
    };
    for (std::size_t one = 0; one + 1 < begins.size(); ++one) {
        const Cell& cell = sorted[begins[one]].first;
        for (std::int64_t x = -2; x <= 2; ++x) {
            for (std::int64_t y = -2; y <= 2; ++y) {
                const Cell low{cell[0] + x, cell[1] + y, cell[2] - 2};
                const auto from = std::lower_bound(
                    begins.begin(), begins.end() - 1, low,
                    [&](std::size_t n, const Cell& than) { return sorted[n].first < than; });
                for (auto at = from; at + 1 != begins.end(); ++at) {
                    const Cell& there = sorted[*at].first;
                    if (there[0] != low[0] || there[1] != low[1] || there[2] > cell[2] + 2) break;
                    const auto other = static_cast<std::size_t>(at - begins.begin());
                    const VertexId a = sorted[begins[one]].second, b = sorted[*at].second;
                    if (other >= one || sets.find(a) == sets.find(b)) continue;
                    if (areNear(one, other)) sets.join(a, b);
                }
            }
        }
    }
    std::vector<std::uint8_t> isSpoilt(points.size());
    for (const VertexId v : border) {
        const std::int64_t set = sets.find(v);
        if (squaredNorm(points[set] - points[v]) > reachMm * reachMm) isSpoilt[set] = 1;
    }
    for (const auto& [a, b, c] : input.mesh.triangles) {
        const std::int64_t p = sets.find(a), q = sets.find(b), r = sets.find(c);
        if (p == q || p == r) isSpoilt[p] = 1;
        if (q == r) isSpoilt[q] = 1;
    }
    std::vector<VertexId> becomes = themselves(points.size());
    for (const VertexId v : border) {
        const std::int64_t set = sets.find(v);
        if (isSpoilt[set] != 0) continue;
        becomes[v] = set;
        movedMm = std::max(movedMm, norm(points[set] - points[v]));
    }
    return renumber(input, becomes);
}

/// \return  of what went with its counterpart, one of each
std::vector<LostPair> dropFlatAndDoubled(TriangleMesh& mesh, double mayMoveMm,
                                         MendStatistics& statistics) {
    AreaTriangles area = withoutFlatTriangles(mesh, mayMoveMm);
    statistics.degenerateTriangles = area.flat;
    statistics.movedMm = area.movedMm;
    std::vector<Triangle> kept;
    if (area.triangles.empty()) {
        kept.swap(mesh.triangles);
    } else {
        for (std::size_t n = 0; n < area.triangles.size(); ++n) {
            if (area.isLeftOut[n] == 0) kept.push_back(area.triangles[n]);
        }
    }
    const DoubledTriangles doubled = findDoubled(mesh.points, kept);
    mesh.triangles.clear();
    for (std::size_t n = 0; n < kept.size(); ++n) {
        if (doubled.isDropped[n] == 0) mesh.triangles.push_back(kept[n]);
    }
    statistics.duplicateTriangles = std::ssize(kept) - std::ssize(mesh.triangles);
    if (mesh.triangles.empty()) throw InvalidInput("mend: no triangle has an area");
    std::vector<std::uint32_t> triangleAt(mesh.points.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const VertexId v : mesh.triangles[t]) triangleAt[v] = t;
    }
    std::vector<LostPair> lost;
    for (const std::size_t n : doubled.walls) {
        const auto& [a, b, c] = kept[n];
        lost.push_back({{mesh.points[a], mesh.points[b], mesh.points[c]}, triangleAt[a]});
    }
    return lost;
}

/// The triangles at each edge, in their order.
Buckets<std::uint32_t> trianglesAtEdges(const MendInput& input) {
    return Buckets<std::uint32_t>(input.edges.size(), [&](const auto& give) {
        for (std::uint32_t t = 0; t < input.edgeOf.size(); ++t) {
            for (const std::uint32_t e : input.edgeOf[t]) give(e, t);
        }
    });
}

/// Does a triangle run along its edge i from the smaller to the larger point?
bool runsUp(const Triangle& t, std::size_t i) {
    return t[i] < t[(i + 1) % 3];
}
bool runsUpAlong(const MendInput& input, std::uint32_t t, std::uint32_t edge) {
    const auto& edges = input.edgeOf[t];
    const auto at =
        static_cast<std::size_t>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
    return runsUp(input.mesh.triangles[t], at);
}

void flip(MendInput& input, std::uint32_t t) {
    std::swap(input.mesh.triangles[t][1], input.mesh.triangles[t][2]);
    std::swap(input.edgeOf[t][0], input.edgeOf[t][2]);
}

/// Sheets: triangles that hang together by edges with two triangles.
struct Sheets {
    std::vector<std::uint32_t> triangles;  ///< sheet after sheet
    std::vector<std::size_t> begin{0};     ///< of each, and the end
    std::vector<std::uint8_t> isClosed;
    std::vector<std::optional<std::uint32_t>> oddPoint;  ///< of each, where it can't face one way
    std::vector<std::uint8_t> isTurned;  ///< of each triangle: turned round since it was given

    std::span<const std::uint32_t> of(std::size_t sheet) const {
        return std::span(triangles).subspan(begin[sheet], begin[sheet + 1] - begin[sheet]);
    }
    std::size_t count() const { return isClosed.size(); }
};

double areaOf(const TriangleMesh& mesh, std::uint32_t t) {
    const Corners c = cornersOf(mesh, t);
    return 0.5 * norm(areaVector2(c[0], c[1], c[2]));
}

void turnSheet(MendInput& input, Sheets& sheets, std::size_t sheet) {
    for (const std::uint32_t t : sheets.of(sheet)) {
        flip(input, t);
        sheets.isTurned[t] ^= 1;
    }
}

/// Turns the triangles of each sheet to face as most of its area does.
Sheets makeSheetsFaceOneWay(MendInput& input, const Buckets<std::uint32_t>& atEdge) {
    Sheets sheets;
    const std::size_t count = input.edgeOf.size();
    sheets.isTurned.resize(count);
    std::vector<std::uint8_t> isSeen(count);
    for (std::uint32_t first = 0; first < count; ++first) {
        if (isSeen[first] != 0) continue;
        isSeen[first] = 1;
        bool isClosed = true;
        std::optional<std::uint32_t> oddPoint;
        double turnedArea = 0, area = 0;
        sheets.triangles.push_back(first);
        for (std::size_t n = sheets.begin.back(); n < sheets.triangles.size(); ++n) {
            const std::uint32_t t = sheets.triangles[n];
            area += areaOf(input.mesh, t);
            if (sheets.isTurned[t] != 0) turnedArea += areaOf(input.mesh, t);
            for (const std::uint32_t e : input.edgeOf[t]) {
                const auto at = atEdge.of(e);
                if (at.size() != 2) {
                    isClosed = false;
                    continue;
                }
                const std::uint32_t other = at[0] == t ? at[1] : at[0];
                const bool isOneWay = runsUpAlong(input, t, e) == runsUpAlong(input, other, e);
                if (isSeen[other] != 0) {
                    if (isOneWay) {  // of a Moebius band
                        isClosed = false;
                        oddPoint = input.edges[e].a;
                    }
                    continue;
                }
                isSeen[other] = 1;
                if (isOneWay) {
                    flip(input, other);
                    sheets.isTurned[other] = 1;
                }
                sheets.triangles.push_back(other);
            }
        }
        sheets.begin.push_back(sheets.triangles.size());
        sheets.isClosed.push_back(isClosed ? 1 : 0);
        sheets.oddPoint.push_back(oddPoint);
        if (turnedArea > 0.5 * area) turnSheet(input, sheets, sheets.count() - 1);
    }
    return sheets;
}

/// Turns closed sheets that are inside out and lie in no other, and open ones whose front, by the
/// even-odd rule, is rather inside.
void turnSheetsOutward(MendInput& input, Sheets& sheets) {
    const TriangleMesh& mesh = input.mesh;
    const AabbTree tree(mesh);
    const InsideTest inside(mesh, tree);
    const BoundingBox box = boundingBox(mesh);
    const Vec3 reference = box.middle();
    const double step = 1e-6 * norm(box.size());
    constexpr std::size_t kSamples = 48;
    for (std::size_t sheet = 0; sheet < sheets.count(); ++sheet) {
        const auto triangles = sheets.of(sheet);
        if (sheets.isClosed[sheet] != 0) {
            double volume = 0;
            for (const std::uint32_t t : triangles) {
                const Corners c = cornersOf(mesh, t);
                volume += dot(c[0] - reference, cross(c[1] - reference, c[2] - reference));
            }
            if (volume >= 0) continue;
        }
        // A cavity's wall faces the solid's outside, as the solid's own does: both have the outside
        // of the even-odd rule in front.
        int front = 0, back = 0;
        const std::size_t every = (triangles.size() + kSamples - 1) / kSamples;
        for (std::size_t n = 0; n < triangles.size(); n += every) {
            const Corners c = cornersOf(mesh, triangles[n]);
            const Vec3 middle = (1.0 / 3) * (c[0] + c[1] + c[2]);
            const Vec3 normal = normalized(areaVector2(c[0], c[1], c[2]));
            const Side ahead = inside.sideOf(middle + step * normal),
                       behind = inside.sideOf(middle - step * normal);
            if (ahead == Side::Outside && behind == Side::Inside) ++front;
            if (ahead == Side::Inside && behind == Side::Outside) ++back;
        }
        if (back > front) turnSheet(input, sheets, sheet);
    }
}

/// Points whose triangles are more than one fan. \param count  of the triangles that are looked at
std::vector<std::uint32_t> findBadVertices(const MendInput& input, std::int64_t count) {
    const auto& triangles = input.mesh.triangles;
    DisjointSets corners(3 * count);
    const auto cornerAt = [&](std::int64_t t, std::uint32_t v) {
        const Triangle& of = triangles[t];
        return 3 * t + (of[0] == v ? 0 : of[1] == v ? 1 : 2);
    };
    for (const MendInput::Edge& edge : input.edges) {
        if (!edge.isSound || std::ranges::max(edge.triangles) >= count) continue;
        for (const std::uint32_t v : {edge.a, edge.b}) {
            corners.join(cornerAt(edge.triangles[0], v), cornerAt(edge.triangles[1], v));
        }
    }
    std::vector<std::int64_t> fan(input.mesh.points.size(), -1);
    std::vector<std::uint32_t> bad;
    for (std::int64_t c = 0; c < 3 * count; ++c) {
        const VertexId v = triangles[c / 3][c % 3];
        const std::int64_t set = corners.find(c);
        if (fan[v] == -1) fan[v] = set;
        if (fan[v] != set && fan[v] >= 0) {
            fan[v] = -2;
            bad.push_back(static_cast<std::uint32_t>(v));
        }
    }
    return bad;
}

void findCrossings(MendInput& input) {
    const auto triangles = inShort(input.mesh);
    CrossingPairs crossing = findCrossingPairs({input.mesh.points, triangles});
    input.crossingPairs = std::move(crossing.pairs);
    input.undecided = std::move(crossing.undecided);
}

void countCrossing(const MendInput& input, MendStatistics& statistics) {
    std::vector<std::uint32_t> all = input.undecided;
    for (const auto& pair : input.crossingPairs) all.insert(all.end(), pair.begin(), pair.end());
    std::sort(all.begin(), all.end());
    statistics.crossingTriangles = std::unique(all.begin(), all.end()) - all.begin();
}

/// Finds the triangles of each edge, and whether it is sound.
void judgeEdges(MendInput& input, MendStatistics& statistics) {
    const Buckets<std::uint32_t> atEdge = trianglesAtEdges(input);
    for (std::uint32_t e = 0; e < input.edges.size(); ++e) {
        MendInput::Edge& edge = input.edges[e];
        const auto at = atEdge.of(e);
        if (at.size() > 2) ++statistics.badEdges;
        if (at.size() != 2) continue;
        const bool up = runsUpAlong(input, at[0], e);
        edge.isSound = up != runsUpAlong(input, at[1], e);
        edge.triangles = {at[up ? 0 : 1], at[up ? 1 : 0]};
        if (!edge.isSound) ++statistics.badEdges;
    }
}

}  // namespace

std::vector<TriangleView::Triangle> inShort(const TriangleMesh& mesh) {
    std::vector<TriangleView::Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                             static_cast<std::uint32_t>(c)});
    }
    return triangles;
}

void findEdges(MendInput& input) {
    struct HalfEdge {
        std::uint32_t a, b, at;
        auto operator<=>(const HalfEdge&) const = default;
    };
    std::vector<HalfEdge> halves;
    halves.reserve(3 * input.mesh.triangles.size());
    for (std::uint32_t t = 0; t < input.mesh.triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const auto from = static_cast<std::uint32_t>(input.mesh.triangles[t][i]),
                       to = static_cast<std::uint32_t>(input.mesh.triangles[t][(i + 1) % 3]);
            halves.push_back({std::min(from, to), std::max(from, to), 3 * t + i});
        }
    }
    std::sort(halves.begin(), halves.end());
    input.edges.clear();
    input.edgeOf.resize(input.mesh.triangles.size());
    for (std::size_t begin = 0, end; begin < halves.size(); begin = end) {
        for (end = begin; end < halves.size() && halves[end].a == halves[begin].a &&
                          halves[end].b == halves[begin].b;
             ++end) {
            input.edgeOf[halves[end].at / 3][halves[end].at % 3] =
                static_cast<std::uint32_t>(input.edges.size());
        }
        input.edges.push_back({halves[begin].a, halves[begin].b, {-1, -1}, false});
    }
}

void requireCountable(const TriangleMesh& mesh) {
    if (mesh.points.size() > 0x7FFFFFFF || mesh.triangles.size() > 0x7FFFFFFF / 3) {
        throw InvalidInput("mend: more than 2^31 points or edges");
    }
}

void judgeSurface(MendInput& input, MendStatistics& statistics) {
    judgeEdges(input, statistics);
    input.badVertices = findBadVertices(input, std::ssize(input.mesh.triangles));
    statistics.badVertices = std::ssize(input.badVertices);
    if (input.badVertices.empty() || input.capOf.empty()) return;
    // a cap that lacks a part is no fault of what was given
    std::vector<std::uint8_t> wasBad(input.mesh.points.size());
    for (const std::uint32_t v : findBadVertices(input, input.firstCap())) wasBad[v] = 1;
    statistics.badVertices =
        std::ranges::count_if(input.badVertices, [&](std::uint32_t v) { return wasBad[v] != 0; });
}

MendInput prepareInput(const TriangleMesh& mesh, MendStatistics& statistics) {
    MendInput input;
    input.mesh.points = mesh.points;
    input.mesh.triangles = mesh.triangles;
    input.lostPairs = dropFlatAndDoubled(input.mesh, kNearFlat * statistics.maxErrorMm, statistics);
    findEdges(input);
    statistics.mergedPoints = mergeBorderPoints(input);
    double movedMm = 0;
    statistics.mergedPoints +=
        mergeNearBorderPoints(input, kNearBorder * statistics.maxErrorMm, movedMm);
    statistics.movedMm += movedMm;  // a point may have moved before
    const auto uses = edgeUses(input);
    for (std::size_t e = 0; e < uses.size(); ++e) {
        if (uses[e] == 1) input.borders.push_back({input.edges[e].a, input.edges[e].b});
    }
    statistics.borderEdges = std::ssize(input.borders);
    Sheets sheets = makeSheetsFaceOneWay(input, trianglesAtEdges(input));
    std::vector<std::uint8_t> isTurned = sheets.isTurned;
    for (const CapKind kind : {CapKind::Flat, CapKind::LeastArea}) {
        if (addCaps(input, kind)) {
            findEdges(input);
        } else if (kind == CapKind::LeastArea) {
            break;
        }
        sheets = makeSheetsFaceOneWay(input, trianglesAtEdges(input));
        turnSheetsOutward(input, sheets);
        for (std::size_t t = 0; t < isTurned.size(); ++t) isTurned[t] ^= sheets.isTurned[t];
        findCrossings(input);
        if (dropCrossingCaps(input)) findEdges(input);
    }
    statistics.flippedTriangles = std::count(isTurned.begin(), isTurned.end(), 1);
    countCrossing(input, statistics);
    judgeSurface(input, statistics);
    const bool isOneSided = std::all_of(sheets.oddPoint.begin(), sheets.oddPoint.end(),
                                        [](const auto& point) { return point.has_value(); });
    if (isOneSided && statistics.borderEdges > 0) {
        input.oneSidedMm = input.mesh.points[*sheets.oddPoint[0]];
    }
    return input;
}

}  // namespace adaptiso::detail
