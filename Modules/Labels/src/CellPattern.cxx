#include "CellPattern.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {
namespace {

using CornerLabels = std::array<int, 8>;  ///< the label of each corner, or what stands for it

int tetrahedronWith(unsigned corners) {
    for (int t = 0; t < kTetrahedra; ++t) {
        if ((cornersOf(t) & corners) == corners) return t;
    }
    return -1;
}

unsigned bitsOf(const std::array<int, 3>& triangle) {
    return 1U << triangle[0] | 1U << triangle[1] | 1U << triangle[2];
}

SideTetrahedra findSideTetrahedra() {
    SideTetrahedra sides{};
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            for (int n = 0; n < 2; ++n) {
                sides[axis][side][n] = tetrahedronWith(bitsOf(sideTriangle(axis, side, n)));
            }
        }
    }
    return sides;
}

Vec3 cornerPoint(int c) {
    return {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1),
            static_cast<double>(c >> 2)};
}

EdgeRing findEdgeRing(int kind) {
    const Vec3 along = cornerPoint(kind);
    const Vec3 across = kind == 1 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    const Vec3 u = cross(along, cross(across, along)), v = cross(along, u);
    std::vector<std::pair<double, TetrahedronAt>> found;
    for (int at = 0; at < 8; ++at) {  // the corner of the cell where the edge begins
        if ((at & kind) != 0) continue;
        const unsigned ends = 1U << at | 1U << (at | kind);
        for (int t = 0; t < kTetrahedra; ++t) {
            if ((cornersOf(t) & ends) != ends) continue;
            Vec3 middle;
            for (int c = 0; c < 8; ++c) {
                if ((cornersOf(t) >> c & 1) != 0)
                    middle += 0.25 * (cornerPoint(c) - cornerPoint(at));
            }
            const double angle = std::atan2(dot(middle, v) / norm(v), dot(middle, u) / norm(u));
            found.push_back({angle, {{-(at & 1), -(at >> 1 & 1), -(at >> 2)}, t}});
        }
    }
    std::sort(found.begin(), found.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    EdgeRing ring;
    for (const auto& [angle, tetrahedron] : found) ring.around[ring.count++] = tetrahedron;
    return ring;
}

/// Tetrahedra of a cell as bits.
using Tetrahedra = unsigned;
constexpr Tetrahedra kAll = (1U << kTetrahedra) - 1;

/// Faces of the tetrahedra that lie on the border of their union, as corner bits.
std::vector<unsigned> borderOf(Tetrahedra tetrahedra) {
    std::vector<unsigned> faces;
    for (int t = 0; t < kTetrahedra; ++t) {
        if ((tetrahedra >> t & 1) == 0) continue;
        for (int c = 0; c < 8; ++c) {
            if ((cornersOf(t) >> c & 1) == 0) continue;
            const unsigned face = cornersOf(t) & ~(1U << c);
            const auto at = std::find(faces.begin(), faces.end(), face);
            if (at == faces.end()) {
                faces.push_back(face);
            } else {
                faces.erase(at);
            }
        }
    }
    return faces;
}

/// The corners of a label span a disc (or a part of one) on a border: connected, without holes.
bool isDisc(const std::vector<unsigned>& border, unsigned corners) {
    std::vector<unsigned> edges;
    int faces = 0;
    unsigned all = 0;
    for (const unsigned face : border) {
        all |= face;
        faces += (face & corners) == face ? 1 : 0;
        for (int a = 0; a < 8; ++a) {
            const unsigned edge = face & ~(1U << a);
            if (edge == face || (edge & corners) != edge) continue;
            if (std::find(edges.begin(), edges.end(), edge) == edges.end()) edges.push_back(edge);
        }
    }
    const unsigned own = corners & all;
    if (own == 0) return true;
    if (std::popcount(own) - static_cast<int>(edges.size()) + faces != 1) return false;
    unsigned reached = own & (~own + 1);  // its lowest corner
    for (unsigned last = 0; last != reached;) {
        last = reached;
        for (const unsigned edge : edges) {
            if ((edge & reached) != 0) reached |= edge;
        }
    }
    return reached == own;
}

/// A cone over the walls on the border of the tetrahedra is what is inside them.
bool isCone(const CornerLabels& labels, Tetrahedra tetrahedra) {
    const std::vector<unsigned> border = borderOf(tetrahedra);
    for (int label = 0; label < 8; ++label) {
        unsigned corners = 0;
        for (int c = 0; c < 8; ++c) corners |= labels[c] == label ? 1U << c : 0U;
        if (!isDisc(border, corners)) return false;
    }
    return true;
}

bool isPinchedSide(const CornerLabels& labels, int axis, int side) {
    const std::array<int, 3> one = sideTriangle(axis, side, 0), other = sideTriangle(axis, side, 1);
    return isPinched(labels[one[0]], labels[one[1]], labels[one[2]], labels[other[1]]);
}

/// No group has both tetrahedra of a side that is pinched.
bool keepsSidesApart(const CornerLabels& labels, const std::array<int, kTetrahedra>& groupOf) {
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const auto& [s, t] = kSideTetrahedra[axis][side];
            if (groupOf[s] >= 0 && groupOf[s] == groupOf[t] && isPinchedSide(labels, axis, side)) {
                return false;
            }
        }
    }
    return true;
}

bool isMixed(const CornerLabels& labels, int t) {
    const int first = labels[0];
    return labels[7] != first || labels[kRing[t]] != first || labels[kRing[after(t)]] != first;
}

/// The groups that are left when the ring of tetrahedra is cut at inner faces: bit t cuts before
/// tetrahedron t. \return no groups where that is not allowed
CellPattern groupsOfCuts(const CornerLabels& labels, unsigned cuts) {
    CellPattern pattern;
    pattern.groupOf.fill(CellPattern::kNone);
    std::array<int, kTetrahedra> groupOf;
    groupOf.fill(-1);
    const auto joinsPrevious = [&](int t) {
        return isMixed(labels, t) && isMixed(labels, before(t)) && (cuts >> t & 1) == 0;
    };
    for (int t = 0; t < kTetrahedra; ++t) {
        if (!isMixed(labels, t) || joinsPrevious(t)) continue;
        const int group = pattern.groups++;
        Tetrahedra own = 0;
        int size = 0;
        for (int u = t; size == 0 || (u != t && joinsPrevious(u)); u = after(u)) {
            own |= 1U << u;
            ++size;
            groupOf[u] = group;
            pattern.groupOf[u] = static_cast<std::uint8_t>(group);
        }
        pattern.first[group] = static_cast<std::uint8_t>(t);
        pattern.size[group] = static_cast<std::uint8_t>(size);
        if (size > 3 || !isCone(labels, own)) return {};
    }
    if (!keepsSidesApart(labels, groupOf)) return {};
    if (pattern.groups == 2 && pattern.size[0] + pattern.size[1] == kTetrahedra) {
        const int a = kRing[pattern.first[0]], b = kRing[pattern.first[1]];
        if (isPinched(labels[0], labels[a], labels[7], labels[b])) return {};
    }
    return pattern;
}

CellPattern findPattern(const CornerLabels& labels) {
    std::array<int, kTetrahedra> whole{};
    if (std::all_of(labels.begin(), labels.end(), [&](int l) { return l == labels[0]; })) return {};
    if (isCone(labels, kAll) && keepsSidesApart(labels, whole)) {
        CellPattern pattern;
        pattern.groups = 1;
        pattern.size[0] = kTetrahedra;
        return pattern;
    }
    for (int count = 0; count <= kTetrahedra; ++count) {
        for (unsigned cuts = 0; cuts <= kAll; ++cuts) {
            if (std::popcount(cuts) != count) continue;
            const CellPattern pattern = groupsOfCuts(labels, cuts);
            if (pattern.groups != 0) return pattern;
        }
    }
    throw InternalError("findPattern: no groups");
}

std::vector<CellPattern> findPatterns() {
    std::vector<CellPattern> patterns(kPatterns);
    const auto fill = [&](const auto& self, CornerLabels& labels, int c, int kinds) -> void {
        if (c == 8) {
            patterns[patternCode(labels)] = findPattern(labels);
            return;
        }
        for (int kind = 0; kind <= kinds; ++kind) {
            labels[c] = kind;
            self(self, labels, c + 1, std::max(kinds, kind + 1));
        }
    };
    CornerLabels labels{};
    fill(fill, labels, 1, 1);
    return patterns;
}

}  // namespace

std::array<int, 3> sideTriangle(int axis, int side, int triangle) {
    const int first = side << axis, one = 1 << (axis + 1) % 3, other = 1 << (axis + 2) % 3;
    return {first, first | (triangle == 0 ? one : other), first | one | other};
}

const SideTetrahedra kSideTetrahedra = findSideTetrahedra();

const EdgeRing& edgeRing(int kind) {
    static const std::array<EdgeRing, kEdgeKinds + 1> rings = [] {
        std::array<EdgeRing, kEdgeKinds + 1> all;
        for (int k = 1; k <= kEdgeKinds; ++k) all[k] = findEdgeRing(k);
        return all;
    }();
    return rings[kind];
}

const CellPattern& cellPattern(int code) {
    static const std::vector<CellPattern> patterns = findPatterns();
    return patterns[code];
}

}  // namespace adaptiso::detail
