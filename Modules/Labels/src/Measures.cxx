#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

/// A triangle of a region's surface, outward, and what lies beyond it.
struct Side {
    std::int64_t triangle;
    bool isTurned;
    Label beyond;
};

Triangle cornersOf(const LabelComplex& complex, const Side& side) {
    const Triangle& t = complex.triangles[side.triangle];
    return side.isTurned ? Triangle{t[0], t[2], t[1]} : t;
}

/// The points that a surface uses, ascending.
std::vector<VertexId> pointsOf(const std::vector<Triangle>& triangles) {
    std::vector<VertexId> used;
    used.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

/// Names the points by their places in `used`.
void renumber(std::vector<Triangle>& triangles, const std::vector<VertexId>& used) {
    for (Triangle& t : triangles) {
        for (VertexId& v : t) {
            v = std::lower_bound(used.begin(), used.end(), v) - used.begin();
        }
    }
}

std::int64_t countEdges(const std::vector<Triangle>& triangles) {
    std::vector<std::pair<VertexId, VertexId>> edges;
    edges.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) {
        for (int c = 0; c < 3; ++c) edges.push_back(std::minmax(t[c], t[(c + 1) % 3]));
    }
    std::sort(edges.begin(), edges.end());
    return std::unique(edges.begin(), edges.end()) - edges.begin();
}

std::int64_t countComponents(const std::vector<Triangle>& triangles, std::int64_t points) {
    std::vector<VertexId> parent(points);
    std::iota(parent.begin(), parent.end(), 0);
    const auto rootOf = [&](VertexId v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    std::int64_t count = points;
    for (const Triangle& t : triangles) {
        for (int c = 1; c < 3; ++c) {
            const VertexId a = rootOf(t[0]), b = rootOf(t[c]);
            if (a == b) continue;
            parent[b] = a;
            --count;
        }
    }
    return count;
}

RegionMeasure measure(const LabelComplex& complex, Label label, std::span<const Side> sides) {
    RegionMeasure m;
    m.label = label;
    m.triangles = static_cast<std::int64_t>(sides.size());
    const Vec3 origin = complex.points[complex.triangles[sides.front().triangle][0]];
    std::map<Label, RegionContact> contacts;
    std::vector<Triangle> triangles;
    triangles.reserve(sides.size());
    for (const Side& side : sides) {
        const Triangle t = cornersOf(complex, side);
        triangles.push_back(t);
        const Vec3 a = complex.points[t[0]] - origin, b = complex.points[t[1]] - origin,
                   c = complex.points[t[2]] - origin;
        const double areaMm2 = norm(areaVector2(a, b, c)) / 2;
        m.areaMm2 += areaMm2;
        m.volumeMm3 += dot(a, cross(b, c)) / 6;
        RegionContact& contact = contacts[side.beyond];
        contact.label = side.beyond;
        ++contact.triangles;
        contact.areaMm2 += areaMm2;
    }
    for (const auto& [beyond, contact] : contacts) m.neighbours.push_back(contact);
    const std::vector<VertexId> used = pointsOf(triangles);
    renumber(triangles, used);
    m.vertices = static_cast<std::int64_t>(used.size());
    m.eulerCharacteristic = m.vertices - countEdges(triangles) + m.triangles;
    m.components = countComponents(triangles, m.vertices);
    return m;
}

}  // namespace

TriangleMesh regionSurface(const LabelComplex& complex, Label label) {
    TriangleMesh mesh;
    for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
        const auto& [from, into] = complex.labels[t];
        if (from != label && into != label) continue;
        mesh.triangles.push_back(
            cornersOf(complex, {static_cast<std::int64_t>(t), into == label, 0}));
    }
    const std::vector<VertexId> used = pointsOf(mesh.triangles);
    renumber(mesh.triangles, used);
    mesh.points.reserve(used.size());
    for (const VertexId v : used) mesh.points.push_back(complex.points[v]);
    return mesh;
}

std::vector<RegionMeasure> measureRegions(const LabelComplex& complex,
                                          const std::vector<Label>& labels) {
    std::map<Label, std::vector<Side>> sides;
    for (const Label label : labels) sides[label];
    const auto add = [&](Label label, const Side& side) {
        if (label == 0) return;
        const auto at = sides.find(label);
        if (at != sides.end()) {
            at->second.push_back(side);
        } else if (labels.empty()) {
            sides[label].push_back(side);
        }
    };
    for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
        const auto& [from, into] = complex.labels[t];
        add(from, {static_cast<std::int64_t>(t), false, into});
        add(into, {static_cast<std::int64_t>(t), true, from});
    }
    std::erase_if(sides, [](const auto& entry) { return entry.second.empty(); });
    std::vector<std::pair<Label, std::span<const Side>>> regions;
    for (const auto& [label, own] : sides) regions.emplace_back(label, own);
    std::vector<RegionMeasure> measures(regions.size());
    parallelForPieces(static_cast<std::int64_t>(regions.size()), 1,
                      [&](std::int64_t n, std::int64_t) {
                          measures[n] = measure(complex, regions[n].first, regions[n].second);
                      });
    return measures;
}

}  // namespace adaptiso
