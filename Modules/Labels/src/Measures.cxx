#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

/// Triangles of a region's surface, outward.
std::vector<Triangle> outward(const LabelComplex& complex, Label label,
                              std::span<const std::int64_t> numbers) {
    std::vector<Triangle> triangles;
    triangles.reserve(numbers.size());
    for (const std::int64_t n : numbers) {
        const Triangle& t = complex.triangles[n];
        triangles.push_back(complex.labels[n][0] == label ? t : Triangle{t[0], t[2], t[1]});
    }
    return triangles;
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

RegionMeasure measure(const LabelComplex& complex, Label label,
                      std::span<const std::int64_t> numbers) {
    RegionMeasure m;
    m.label = label;
    m.triangles = static_cast<std::int64_t>(numbers.size());
    const Vec3 origin = complex.points[complex.triangles[numbers.front()][0]];
    std::map<Label, RegionContact> contacts;
    std::vector<Triangle> triangles = outward(complex, label, numbers);
    for (std::size_t n = 0; n < triangles.size(); ++n) {
        const Triangle& t = triangles[n];
        const Vec3 a = complex.points[t[0]] - origin, b = complex.points[t[1]] - origin,
                   c = complex.points[t[2]] - origin;
        const double areaMm2 = norm(areaVector2(a, b, c)) / 2;
        m.areaMm2 += areaMm2;
        m.volumeMm3 += dot(a, cross(b, c)) / 6;
        const auto& [from, into] = complex.labels[numbers[n]];
        const Label beyond = from == label ? into : from;
        RegionContact& contact = contacts[beyond];
        contact.label = beyond;
        ++contact.triangles;
        contact.areaMm2 += areaMm2;
    }
    for (const auto& [beyond, contact] : contacts) m.neighbours.push_back(contact);
    const std::vector<VertexId> used = pointsOf(triangles);
    renumber(triangles, used);
    m.vertices = static_cast<std::int64_t>(used.size());
    m.eulerCharacteristic = m.vertices - countEdges(triangles) + m.triangles;
    DisjointSets pieces(m.vertices);
    for (const auto& [a, b, c] : triangles) {
        pieces.join(a, b);
        pieces.join(a, c);
    }
    for (VertexId v = 0; v < m.vertices; ++v) m.components += pieces.find(v) == v;
    return m;
}

}  // namespace

RegionSurfaces::RegionSurfaces(const LabelComplex& complex, const std::vector<Label>& labels)
    : complex_(complex), labels_(labels), triangles_(labels.size(), [&](const auto& give) {
          for (std::int64_t t = 0; t < std::ssize(complex.triangles); ++t) {
              for (const Label label : complex.labels[t]) {
                  const auto at = std::ranges::lower_bound(labels, label);
                  if (at != labels.end() && *at == label) give(at - labels.begin(), t);
              }
          }
      }) {}

TriangleMesh RegionSurfaces::surface(std::size_t n) const {
    TriangleMesh mesh{{}, {}, outward(complex_, labels_[n], triangles(n))};
    const std::vector<VertexId> used = pointsOf(mesh.triangles);
    renumber(mesh.triangles, used);
    mesh.points.reserve(used.size());
    for (const VertexId v : used) mesh.points.push_back(complex_.points[v]);
    return mesh;
}

TriangleMesh regionSurface(const LabelComplex& complex, Label label) {
    return RegionSurfaces(complex, {label}).surface(0);
}

std::vector<RegionMeasure> measureRegions(const LabelComplex& complex,
                                          const std::vector<Label>& wanted) {
    std::vector<Label> labels = wanted;
    if (labels.empty()) {
        for (const auto& sides : complex.labels) labels.insert(labels.end(), {sides[0], sides[1]});
        std::sort(labels.begin(), labels.end());
        labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
        std::erase(labels, 0);
    }
    const RegionSurfaces surfaces(complex, labels);
    std::vector<RegionMeasure> measures(labels.size());
    parallelForPieces(std::ssize(labels), 1, [&](std::int64_t n, std::int64_t) {
        const auto triangles = surfaces.triangles(n);
        if (!triangles.empty()) measures[n] = measure(complex, labels[n], triangles);
    });
    std::erase_if(measures, [](const RegionMeasure& m) { return m.triangles == 0; });
    return measures;
}

}  // namespace adaptiso
