#include "adaptiso/SurfaceProof/PieceBound.h"

#include <limits>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/SurfaceProof/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double squaredDistanceToTriangle(const Vec3& p, const Corners& t) {
    return squaredNorm(p - closestPointOnTriangle(p, t[0], t[1], t[2]));
}

bool PieceBound::isWithin(const Corners& piece, const Corners& triangle) const {
    return squaredDistanceToTriangle(piece[0], triangle) <= enough_ &&
           squaredDistanceToTriangle(piece[1], triangle) <= enough_ &&
           squaredDistanceToTriangle(piece[2], triangle) <= enough_;
}

bool PieceBound::isWithin(const Corners& piece) const {
    if (nearby_.empty()) return false;
    return isWithin(Piece{cornerAt(piece[0]), cornerAt(piece[1]), cornerAt(piece[2])}, kFewCuts);
}

bool PieceBound::isWithin(const Piece& piece, int depth) const {
    const Corners points{piece[0].point, piece[1].point, piece[2].point};
    for (const Corner& corner : piece) {
        if (corner.squared > enough_) return false;
        if (isWithin(points, nearby_[corner.nearest])) return true;
    }
    if (depth == 0) return false;
    const Parts parts = partsOf(piece);
    for (int i = 0; i < parts.count; ++i) {
        if (!isWithin(parts.piece[i], depth - 1)) return false;
    }
    return true;
}

void PieceBound::noteFarthest(const Corner& corner) {
    farthest_ = {corner.point, corner.point, corner.nearest, !nearby_.empty()};
    if (nearby_.empty()) return;
    const Corners& t = nearby_[corner.nearest];
    farthest_.onOther = closestPointOnTriangle(corner.point, t[0], t[1], t[2]);
}

void PieceBound::include(const Corners& piece) {
    if (nearby_.empty()) {
        enough_ = kInfinity;
        noteFarthest({(1.0 / 3) * (piece[0] + piece[1] + piece[2]), 0, kInfinity});
        return;
    }
    include(Piece{newCornerAt(piece[0]), newCornerAt(piece[1]), newCornerAt(piece[2])}, kManyCuts);
}

std::optional<FarPoint> PieceBound::includeWithin(double limitMm, const Corners& piece,
                                                  double& farthestMm) {
    const double before = enough_, limit = limitMm * limitMm;
    include(piece);
    if (enough_ <= limit) return {};
    const double reachedMm = boundMm();
    // it may have grown by more than it had to
    enough_ = limit;
    include(piece);
    if (enough_ <= limit) return {};
    enough_ = before;
    farthestMm = std::max(farthestMm, reachedMm);
    return farthest_;
}

void PieceBound::include(const Piece& piece, int depth) {
    const Corners points{piece[0].point, piece[1].point, piece[2].point};
    for (const Corner& corner : piece) {
        if (isWithin(points, nearby_[corner.nearest])) return;
    }
    if (depth == 0) {
        includeUncut(points);
        return;
    }
    Parts parts = partsOf(piece);
    for (int i = 0; i < parts.count; ++i) {
        for (Corner& corner : parts.piece[i]) {  // a third triangle may be nearer than those cut at
            if (corner.squared > enough_) corner = newCornerAt(corner.point);
        }
        include(parts.piece[i], depth - 1);
    }
}

void PieceBound::includeUncut(const Corners& piece) {
    double best = kInfinity;
    for (const Corners& t : nearby_) {
        double farthest = 0;
        for (const Vec3& p : piece) {
            farthest = std::max(farthest, squaredDistanceToTriangle(p, t));
        }
        best = std::min(best, farthest);
    }
    if (best <= enough_) return;
    enough_ = best;
    noteFarthest(cornerAt((1.0 / 3) * (piece[0] + piece[1] + piece[2])));
}

PieceBound::Corner PieceBound::cornerAt(const Vec3& point) const {
    Corner corner{point, 0, kInfinity};
    for (std::size_t i = 0; i < nearby_.size(); ++i) {
        if (squaredDistance(point, boxOf(nearby_[i])) >= corner.squared) continue;
        const double squared = squaredDistanceToTriangle(point, nearby_[i]);
        if (squared < corner.squared) corner = {point, i, squared};
    }
    return corner;
}

/// A corner as far away as the bound so far, or farther: no bound can be tighter than that.
PieceBound::Corner PieceBound::newCornerAt(const Vec3& point) {
    const Corner corner = cornerAt(point);
    if (corner.squared > enough_) {
        enough_ = kBoundGrowth * corner.squared;
        noteFarthest(corner);
    }
    return corner;
}

/// The corner on the edge from a to b that is as far from a's triangle as from b's.
PieceBound::Corner PieceBound::between(const Corner& a, const Corner& b) const {
    double low = 0, high = 1;
    Corner middle{a.point, a.nearest, a.squared};
    for (int i = 0; i < kCutHalvings; ++i) {
        const double t = 0.5 * (low + high);
        middle.point = a.point + t * (b.point - a.point);
        const double toA = squaredDistanceToTriangle(middle.point, nearby_[a.nearest]),
                     toB = squaredDistanceToTriangle(middle.point, nearby_[b.nearest]);
        middle.squared = std::max(toA, toB);
        (toA < toB ? low : high) = t;
    }
    return middle;
}

/// Cuts a piece where its corners' triangles are equally far, so that the corners of each part have
/// the same one. Of three different ones two at least are parted.
PieceBound::Parts PieceBound::partsOf(const Piece& piece) const {
    const auto as = [](Corner corner, const Corner& like) {
        corner.nearest = like.nearest;
        return corner;
    };
    int single = -1;  // the corner whose triangle differs from the other two's
    for (int i = 0; i < 3; ++i) {
        if (piece[(i + 1) % 3].nearest == piece[(i + 2) % 3].nearest) single = i;
    }
    if (single < 0) {
        const Corner &a = piece[0], &b = piece[1], &c = piece[2];
        const Corner p = between(a, b);
        return {{{{a, as(p, a), c}, {as(p, b), b, c}}}, 2};
    }
    const Corner &a = piece[single], &b = piece[(single + 1) % 3], &c = piece[(single + 2) % 3];
    if (a.nearest == b.nearest) {  // all alike, but not near enough: in four
        const Corner ab = cornerAt(0.5 * (a.point + b.point)),
                     bc = cornerAt(0.5 * (b.point + c.point)),
                     ca = cornerAt(0.5 * (c.point + a.point));
        return {{{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}}, 4};
    }
    const Corner p = between(a, b), q = between(a, c);
    return {{{{a, as(p, a), as(q, a)}, {as(p, b), b, c}, {as(p, b), c, as(q, b)}}}, 3};
}

}  // namespace adaptiso::detail
