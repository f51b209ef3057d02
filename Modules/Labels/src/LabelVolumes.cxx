#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/MeshQuality/InsideTest.h"

namespace adaptiso {
namespace {

/// A triangle's first (0) or second (1) side: its label lies there.
struct WallSide {
    std::int64_t triangle;
    int place;
};

/// A closed piece of a region's surface: round a piece of the region, or round a cavity in one.
struct Shell {
    std::vector<WallSide> sides;
    double mm3 = 0;  ///< below 0: of a cavity

    bool isCavity() const { return mm3 < 0; }
};

double volumeUnder(const LabelComplex& complex, const WallSide& side) {
    const auto& [a, b, c] = complex.triangles[side.triangle];
    const double six = dot(complex.points[a], cross(complex.points[b], complex.points[c]));
    return (side.place == 0 ? six : -six) / 6;
}

/// Sides that share an edge of the region's surface, which is a manifold, are of one shell.
std::vector<Shell> shellsOf(const LabelComplex& complex, const std::vector<WallSide>& sides) {
    struct Edge {
        VertexId low, high;
        std::int64_t side;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * sides.size());
    for (std::size_t s = 0; s < sides.size(); ++s) {
        const Triangle& t = complex.triangles[sides[s].triangle];
        for (int c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax(t[c], t[(c + 1) % 3]);
            edges.push_back({low, high, static_cast<std::int64_t>(s)});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    DisjointSets sets(std::ssize(sides));
    for (std::size_t e = 1; e < edges.size(); ++e) {
        const Edge &a = edges[e - 1], &b = edges[e];
        if (a.low == b.low && a.high == b.high) sets.join(a.side, b.side);
    }
    std::map<std::int64_t, Shell> shells;  // in the order of their first sides
    for (std::size_t s = 0; s < sides.size(); ++s) {
        Shell& shell = shells[sets.find(static_cast<std::int64_t>(s))];
        shell.sides.push_back(sides[s]);
        shell.mm3 += volumeUnder(complex, sides[s]);
    }
    std::vector<Shell> result;
    for (auto& [first, shell] : shells) result.push_back(std::move(shell));
    return result;
}

/// The smallest of the outer shells that holds a cavity.
std::size_t holderOf(const LabelComplex& complex, const std::vector<Shell>& shells,
                     const std::vector<std::size_t>& outer, const Shell& cavity) {
    if (outer.size() == 1) return outer.front();
    const Vec3& place = complex.points[complex.triangles[cavity.sides.front().triangle][0]];
    std::size_t holder = shells.size();
    for (const std::size_t n : outer) {
        if (shells[n].mm3 < -cavity.mm3) continue;
        if (holder < shells.size() && shells[holder].mm3 <= shells[n].mm3) continue;
        TriangleMesh mesh{complex.points, {}, {}};
        for (const WallSide& side : shells[n].sides) {
            mesh.triangles.push_back(complex.triangles[side.triangle]);
        }
        const AabbTree tree(mesh);
        if (InsideTest(mesh, tree).sideOf(place) != Side::Outside) holder = n;
    }
    if (holder == shells.size()) throw InternalError("labelMesherInput: a cavity lies in nothing");
    return holder;
}

/// A point in the region, beside one of its largest triangles.
Vec3 pointWithin(const LabelComplex& complex, const TriangleMesh& walls, const AabbTree& tree,
                 const Shell& shell) {
    std::vector<std::pair<double, WallSide>> bySize;
    for (const WallSide& side : shell.sides) {
        const auto& [a, b, c] = complex.triangles[side.triangle];
        bySize.emplace_back(
            -squaredNorm(areaVector2(complex.points[a], complex.points[b], complex.points[c])),
            side);
    }
    std::stable_sort(bySize.begin(), bySize.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [size, side] : bySize) {
        const std::array<std::int64_t, 1> one{side.triangle};
        try {
            return pointBeside(walls, tree, one, side.place == 1);
        } catch (const InvalidInput&) {
            continue;
        }
    }
    throw InvalidInput("labelMesherInput: a piece of a region is too thin for a point in it");
}

}  // namespace

MesherInput labelMesherInput(const LabelComplex& complex, const std::vector<Label>& labels) {
    MesherInput input;
    const TriangleMesh walls{complex.points, {}, complex.triangles};
    const AabbTree tree(walls);
    // the volume on either side of each triangle, from 1; 0: none
    std::vector<std::array<std::int32_t, 2>> volumes(complex.triangles.size());
    const RegionSurfaces surfaces(complex, labels);
    for (std::size_t region = 0; region < labels.size(); ++region) {
        std::vector<WallSide> sides;
        for (const std::int64_t t : surfaces.triangles(region)) {
            sides.push_back({t, complex.labels[t][0] == labels[region] ? 0 : 1});
        }
        const std::vector<Shell> shells = shellsOf(complex, sides);
        std::vector<std::size_t> outer;
        std::vector<std::int32_t> numbers(shells.size());
        for (std::size_t n = 0; n < shells.size(); ++n) {
            if (shells[n].isCavity()) continue;
            outer.push_back(n);
            input.volumes.push_back({static_cast<std::int32_t>(region + 1),
                                     {},
                                     pointWithin(complex, walls, tree, shells[n])});
            numbers[n] = static_cast<std::int32_t>(input.volumes.size());
        }
        for (std::size_t n = 0; n < shells.size(); ++n) {
            if (shells[n].isCavity())
                numbers[n] = numbers[holderOf(complex, shells, outer, shells[n])];
            for (const WallSide& side : shells[n].sides) {
                volumes[static_cast<std::size_t>(side.triangle)][side.place] = numbers[n];
            }
        }
    }
    std::map<std::array<std::int32_t, 2>, std::int32_t> wallOf;
    for (const auto& pair : volumes) {
        const auto number = static_cast<std::int32_t>(wallOf.size() + 1);
        const auto [found, isNew] = wallOf.emplace(pair, number);
        input.walls.push_back(found->second);
        if (!isNew) continue;
        for (const std::int32_t volume : std::set<std::int32_t>{pair[0], pair[1]}) {
            if (volume > 0)
                input.volumes[static_cast<std::size_t>(volume - 1)].walls.push_back(number);
        }
    }
    input.points = complex.points;
    input.triangles = complex.triangles;
    return input;
}

}  // namespace adaptiso
