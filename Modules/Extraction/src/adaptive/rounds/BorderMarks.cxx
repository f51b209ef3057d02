#include "adaptive/rounds/BorderMarks.h"

#include "adaptiso/SurfaceProof/HalfEdges.h"

namespace adaptiso::detail {
namespace {

/// Weighted by the squared length of the edge, as a triangle's is by its area.
Quadric borderQuadric(const Vec3& a, const Vec3& b, const Vec3& area2) {
    const Vec3 edge = b - a;
    return Quadric::ofTriangle(2 * norm(edge) * cross(edge, normalized(area2)), a);
}

void markSamples(SimplifiedSurface& surface) {
    for (std::size_t s = 0; s < surface.samples.size(); ++s) {
        Sample& sample = surface.samples[s];
        for (const std::uint64_t v : surface.triangles[surface.sampleTriangle[s]]) {
            if (surface.marks[v] != Patch::kPlain &&
                Sample::positionOf(surface.points[v]) == sample.position) {
                sample.isOnBorder = true;
            }
        }
    }
}

}  // namespace

std::vector<std::uint64_t> openHalfEdges(const SurfaceState& surface,
                                         std::span<const std::uint8_t> mayBeOnBorder) {
    HalfEdges<SurfaceState::Number> halfEdges;
    halfEdges.assign(surface.points.size(), surface.triangles);
    std::vector<SurfaceState::Number> twin;
    halfEdges.match(twin);
    std::vector<std::uint64_t> open;
    for (std::uint64_t h = 0; h < twin.size(); ++h) {
        const SurfaceState::Triangle& t = surface.triangles[h / 3];
        if (twin[h] == HalfEdges<SurfaceState::Number>::kNone && mayBeOnBorder[t[h % 3]] != 0 &&
            mayBeOnBorder[t[(h + 1) % 3]] != 0) {
            open.push_back(h);
        }
    }
    return open;
}

void markBorders(std::span<const std::uint64_t> halfEdges, SimplifiedSurface& surface) {
    surface.marks.resize(surface.points.size(), Patch::kPlain);
    for (const std::uint64_t h : halfEdges) {
        const SurfaceState::Triangle& t = surface.triangles[h / 3];
        const Corners c = surface.view().cornersOf(h / 3);
        const Vec3 area2 = areaVector2(c[0], c[1], c[2]);
        const std::uint64_t a = t[h % 3], b = t[(h + 1) % 3];
        const Quadric q = borderQuadric(surface.points[a], surface.points[b], area2);
        for (const std::uint64_t v : {a, b}) {
            if (surface.marks[v] == Patch::kPlain) surface.marks[v] = Patch::kBorder;
            if (!surface.quadrics.empty()) {
                surface.quadrics[v] += StoredQuadric::of(q, surface.points[v]);
            }
        }
    }
    markSamples(surface);
}

}  // namespace adaptiso::detail
