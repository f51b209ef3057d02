#include "NearnessProof.h"

#include <algorithm>

namespace adaptiso::detail {

NearnessProof::NearnessProof(const TriangleMesh& surface, double boundMm)
    : surface_(surface),
      tree_(surface),
      rounding_(1e-12 * norm(boundingBox(surface).size())),
      bound_(boundMm - rounding_) {}

std::int64_t NearnessProof::nearest(const Vec3& p, double reachMm) const {
    double squared = reachMm * reachMm;
    std::int64_t best = -1;
    tree_.forEachNear(
        {p, p}, [&] { return squared; },
        [&](std::int64_t t) {
            const Corners c = cornersOf(surface_, t);
            const double away = squaredNorm(closestPointOnTriangle(p, c[0], c[1], c[2]) - p);
            if (away > squared || (away == squared && best >= 0 && t > best)) return;
            squared = away;
            best = t;
        });
    return best;
}

void NearnessProof::prove(const Corners& piece, double smallestMm, Result& result) const {
    const Vec3 middle = 1.0 / 3 * (piece[0] + piece[1] + piece[2]);
    double radius = 0;
    for (const Vec3& p : piece) radius = std::max(radius, norm(p - middle));
    const std::int64_t triangle = nearest(middle, bound_ + radius);
    if (triangle < 0) {
        result.others.push_back(piece);
        return;
    }
    const Corners c = cornersOf(surface_, triangle);
    double farthest = 0;
    for (const Vec3& p : piece) {
        farthest = std::max(farthest, norm(closestPointOnTriangle(p, c[0], c[1], c[2]) - p));
    }
    if (farthest <= bound_) {
        result.upperMm = std::max(result.upperMm, farthest + rounding_);
        return;
    }
    if (radius < smallestMm) {
        result.others.push_back(piece);
        return;
    }
    int longest = 0;
    const auto lengthOf = [&](int i) { return squaredNorm(piece[(i + 1) % 3] - piece[i]); };
    for (int i = 1; i < 3; ++i) {
        if (lengthOf(i) > lengthOf(longest)) longest = i;
    }
    const Vec3 &p = piece[longest], &q = piece[(longest + 1) % 3], &r = piece[(longest + 2) % 3];
    const Vec3 half = 0.5 * (p + q);
    prove({p, half, r}, smallestMm, result);
    prove({half, q, r}, smallestMm, result);
}

}  // namespace adaptiso::detail
