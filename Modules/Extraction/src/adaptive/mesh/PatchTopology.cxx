#include "adaptive/mesh/PatchTopology.h"

#include <algorithm>
#include <span>

#include "adaptive/mesh/HalfEdges.h"

namespace adaptiso::detail {

PatchTopology::PatchTopology(Patch& patch)
    : patch_(patch), leaving_(patch.points.size(), kNone), stamp_(patch.points.size(), 0) {
    const std::span own(patch.triangles.data(), patch.ownTriangles);
    HalfEdges<std::uint32_t> halfEdges;
    halfEdges.assign(patch.points.size(), own);
    halfEdges.match(own, twin_);
    // the whole surface is a manifold: a vertex whose triangles all have neighbours has one fan
    std::uint32_t h = 0;
    for (const auto& t : own) {
        for (const std::uint32_t v : t) leaving_[v] = h++;
    }
    h = 0;
    for (const auto& [a, b, c] : own) {
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
            if (twin_[h++] == kNone) leaving_[from] = leaving_[to] = kNone;
        }
    }
    for (std::size_t t = patch.ownTriangles; t < patch.triangles.size(); ++t) {
        for (const std::uint32_t v : patch.triangles[t]) leaving_[v] = kNone;
    }
}

bool PatchTopology::starOf(std::uint32_t vertex, Star& star) const {
    star.count = 0;
    star.removedCount = 0;
    const std::uint32_t begin = leaving_[vertex];
    std::uint32_t h = begin;
    do {
        if (star.count == Star::kMost) return false;
        star.ring[star.count] = to(h);
        star.triangle[star.count] = h / 3;
        star.apex[star.count++] = vertex;
        h = twin_[previous(h)];
    } while (h != begin);
    return true;
}

bool PatchTopology::starOfEdge(std::uint32_t h, Star& star) {
    star.count = 0;
    star.removed = {h / 3, twin_[h] / 3};
    star.removedCount = 2;
    const auto walk = [&](std::uint32_t start, std::uint32_t last) {
        const std::uint32_t apex = from(start);
        for (std::uint32_t g = twin_[previous(start)]; g / 3 != last; g = twin_[previous(g)]) {
            if (star.count == Star::kMost) return false;
            star.ring[star.count] = to(g);
            star.triangle[star.count] = g / 3;
            star.apex[star.count++] = apex;
        }
        return true;
    };
    if (!walk(h, star.removed[1])) return false;
    star.secondWedge = star.count;
    if (!walk(twin_[h], star.removed[0])) return false;
    if (star.secondWedge == star.count) star.secondWedge = 0;
    return star.count >= 3 && ringIsSimple(star);
}

bool PatchTopology::ringIsSimple(const Star& star) {
    ++now_;
    for (int i = 0; i < star.count; ++i) {
        if (stamp_[star.ring[i]] == now_) return false;
        stamp_[star.ring[i]] = now_;
    }
    return true;
}

void PatchTopology::collapse(std::uint32_t h, const Star& star) {
    const std::uint32_t g = twin_[h], kept = from(h), gone = from(g);
    const auto close = [&](std::uint32_t side) {  // joins the two outer neighbours of a triangle
        const std::uint32_t a = twin_[next(side)], b = twin_[previous(side)];
        twin_[a] = b;
        twin_[b] = a;
    };
    const std::uint32_t left = from(previous(h)), right = from(previous(g));
    const std::uint32_t fromLeft = twin_[next(h)], fromRight = twin_[next(g)];
    close(h);
    close(g);
    for (int i = 0; i < star.count; ++i) {
        if (star.apex[i] != gone) continue;
        for (std::uint32_t& corner : patch_.triangles[star.triangle[i]]) {
            if (corner == gone) corner = kept;
        }
    }
    if (leaving_[left] != kNone) leaving_[left] = fromLeft;
    if (leaving_[right] != kNone) leaving_[right] = fromRight;
    leaving_[kept] = twin_[fromLeft];
    leaving_[gone] = kNone;
    patch_.triangles[h / 3].fill(Patch::kGone);
    patch_.triangles[g / 3].fill(Patch::kGone);
}

}  // namespace adaptiso::detail
