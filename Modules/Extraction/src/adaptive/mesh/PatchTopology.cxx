#include "adaptive/mesh/PatchTopology.h"

#include <algorithm>
#include <span>

#include "adaptiso/SurfaceProof/HalfEdges.h"

namespace adaptiso::detail {

PatchTopology::PatchTopology(Patch& patch)
    : patch_(patch), leaving_(patch.points.size(), kNone), stamp_(patch.points.size(), 0) {
    const std::span own(patch.triangles.data(), patch.ownTriangles);
    HalfEdges<std::uint32_t> halfEdges;
    halfEdges.assign(patch.points.size(), own);
    halfEdges.match(twin_);
    // the whole surface is a manifold: a vertex whose triangles all are here has one fan
    std::uint32_t h = 0;
    for (const auto& t : own) {
        for (const std::uint32_t v : t) leaving_[v] = h++;
    }
    const auto forEachUnmatched = [&](const auto& f) {
        for (std::uint32_t u = 0; u < twin_.size(); ++u) {
            if (twin_[u] == kNone) f(u, from(u), to(u));
        }
    };
    const auto isBorder = [&](std::uint32_t a, std::uint32_t b) {
        return patch.isBorder(a) && patch.isBorder(b);
    };
    forEachUnmatched([&](std::uint32_t u, std::uint32_t a, std::uint32_t b) {
        if (isBorder(a, b)) leaving_[a] = u;
    });
    forEachUnmatched([&](std::uint32_t, std::uint32_t a, std::uint32_t b) {
        if (!isBorder(a, b)) leaving_[a] = leaving_[b] = kNone;
    });
    for (std::size_t t = patch.ownTriangles; t < patch.triangles.size(); ++t) {
        for (const std::uint32_t v : patch.triangles[t]) leaving_[v] = kNone;
    }
}

/// Adds the triangles around a vertex from that of h, which starts there, up to one that is left
/// out, or to the border.
bool PatchTopology::addFan(std::uint32_t h, std::uint32_t last, Star& star) const {
    if (h == kNone) return true;
    const std::uint32_t apex = from(h);
    for (std::uint32_t g = h; g != kNone && g / 3 != last; g = twin_[previous(g)]) {
        if (star.count == Star::kMost) return false;
        star.ring[star.count] = to(g);
        star.triangle[star.count] = g / 3;
        star.apex[star.count++] = apex;
        star.ring[star.count] = from(previous(g));
        if (twin_[previous(g)] == h) break;
    }
    return true;
}

bool PatchTopology::starOf(std::uint32_t vertex, Star& star) const {
    star.count = star.removedCount = 0;
    star.isOpen = isOnBorder(vertex);
    return addFan(leaving_[vertex], kNone, star);
}

bool PatchTopology::starOfEdge(std::uint32_t h, Star& star) {
    star.count = 0;
    star.isOpen = isOnBorder(from(h)) || isOnBorder(to(h));
    return (star.isOpen ? openStarOf(h, star) : closedStarOf(h, star)) && ringIsSimple(star);
}

bool PatchTopology::closedStarOf(std::uint32_t h, Star& star) const {
    star.removed = {h / 3, twin_[h] / 3};
    star.removedCount = 2;
    if (!addFan(twin_[previous(h)], star.removed[1], star)) return false;
    const int second = star.count;
    if (!addFan(twin_[previous(twin_[h])], star.removed[0], star)) return false;
    star.beside = {0, second == star.count ? 0 : second};
    star.ring[star.count] = star.ring[0];
    return star.count >= 3;
}

/// An edge of the border, or one that starts or ends there. One that joins two places of the border
/// must stay.
bool PatchTopology::openStarOf(std::uint32_t h, Star& star) const {
    const std::uint32_t twin = twin_[h];
    if (twin == kNone) {
        star.removed[0] = h / 3;
        star.removedCount = 1;
        if (!addFan(leaving_[to(h)], h / 3, star)) return false;
        star.beside[0] = std::max(0, star.count - 1);
        return addFan(twin_[previous(h)], kNone, star) && star.count > 0;
    }
    if (isOnBorder(from(h)) && isOnBorder(to(h))) return false;
    const std::uint32_t outward = isOnBorder(from(h)) ? h : twin, inward = twin_[outward];
    star.removed = {inward / 3, outward / 3};
    star.removedCount = 2;
    if (!addFan(leaving_[from(outward)], inward / 3, star)) return false;
    star.beside[0] = std::max(0, star.count - 1);
    if (!addFan(twin_[previous(inward)], outward / 3, star)) return false;
    star.beside[1] = std::max(0, star.count - 1);
    return addFan(twin_[previous(outward)], kNone, star) && star.count > 0;
}

bool PatchTopology::ringIsSimple(const Star& star) {
    ++now_;
    for (int i = 0; i < star.ringCount(); ++i) {
        if (stamp_[star.ring[i]] == now_) return false;
        stamp_[star.ring[i]] = now_;
    }
    return true;
}

/// Joins the outer neighbours of a triangle at a collapsed edge.
/// \param side  its half-edge along that edge
void PatchTopology::takeOut(std::uint32_t side) {
    const std::uint32_t a = twin_[next(side)], b = twin_[previous(side)],
                        opposite = from(previous(side));
    if (leaving_[opposite] != kNone &&
        (!isOnBorder(opposite) || leaving_[opposite] == previous(side))) {
        leaving_[opposite] = a;
    }
    if (a != kNone) twin_[a] = b;
    if (b != kNone) twin_[b] = a;
}

void PatchTopology::collapse(std::uint32_t h, const Star& star) {
    const std::uint32_t g = twin_[h], kept = from(h), gone = to(h), beside = twin_[previous(h)];
    takeOut(h);
    if (g != kNone) takeOut(g);
    for (int i = 0; i < star.count; ++i) {
        if (star.apex[i] != gone) continue;
        for (std::uint32_t& corner : patch_.triangles[star.triangle[i]]) {
            if (corner == gone) corner = kept;
        }
    }
    leaving_[kept] = beside;
    if (star.isOpen) {
        const auto& first = patch_.triangles[star.triangle[0]];
        const auto corner = std::find(first.begin(), first.end(), kept) - first.begin();
        leaving_[kept] = 3 * star.triangle[0] + static_cast<std::uint32_t>(corner);
    }
    leaving_[gone] = kNone;
    patch_.triangles[h / 3].fill(Patch::kGone);
    if (g != kNone) patch_.triangles[g / 3].fill(Patch::kGone);
}

}  // namespace adaptiso::detail
