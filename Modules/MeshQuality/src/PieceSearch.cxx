#include "PieceSearch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adaptiso {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
/// Halving takes 40 cuts to 1e-6 of the size, and half of them halve.
constexpr int kMostCuts = 100;

/// Keeps the nearest of the points offered.
struct Nearest {
    Vec3 to, point;
    double squared = kUnbounded;

    void offer(const Vec3& p) {
        const double candidate = squaredNorm(to - p);
        if (candidate < squared) {
            point = p;
            squared = candidate;
        }
    }
    /// Offers the nearest point of a segment. \param along  product of the way from its begin with
    /// the segment \param length  of the segment, squared
    void offer(const Vec3& begin, const Vec3& segment, double along, double length) {
        if (along > 0) {
            offer(begin + (along < length ? along / length : 1) * segment);
        } else {
            offer(begin);
        }
    }
};

Nearest nearestOfThin(const Vec3& p, const Corners& t) {
    std::array<double, 3> squares;
    for (std::size_t i = 0; i < 3; ++i) squares[i] = squaredNorm(t[(i + 1) % 3] - t[i]);
    // on the longest side the foot of the height lies between its ends: no digits are lost
    const std::size_t n = std::max_element(squares.begin(), squares.end()) - squares.begin();
    const Vec3 &a = t[n], &b = t[(n + 1) % 3], &c = t[(n + 2) % 3];
    const Vec3 e = b - a, f = c - a, q = p - a;
    const double ee = squares[n], qe = dot(q, e), foot = ee > 0 ? dot(f, e) / ee : 0;
    const Vec3 height = f - foot * e;
    const double hh = squaredNorm(height);
    Nearest best{p, a};
    if (!(hh > 0)) {
        best.offer(a, e, qe, ee);
        return best;
    }
    const double ofC = dot(q, height) / hh, ofB = qe / ee - foot * ofC, ofA = 1 - ofB - ofC;
    if (ofA >= 0 && ofB >= 0 && ofC >= 0) {
        best.offer(a + ofB * e + ofC * f);
        return best;
    }
    if (!(ofC >= 0)) best.offer(a, e, qe, ee);
    if (!(ofB >= 0)) best.offer(a, f, dot(q, f), squaredNorm(f));
    if (!(ofA >= 0)) best.offer(b, c - b, dot(p - b, c - b), squaredNorm(c - b));
    return best;
}

/// The nearest point of a triangle of any shape, give or take 1e-8 of the lengths. As it is put
/// together with weights in [0, 1] it is one of the triangle's, however they were rounded.
Nearest nearestOf(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    constexpr double kThin = 1e-6;  // part of the sides' product; below, the area loses digits
    const Vec3 e = b - a, f = c - a, q = p - a;
    const double ee = squaredNorm(e), ef = dot(e, f), ff = squaredNorm(f), qe = dot(q, e),
                 qf = dot(q, f), area = ee * ff - ef * ef;
    if (!(area > kThin * ee * ff)) return nearestOfThin(p, {a, b, c});
    const double u = ff * qe - ef * qf, v = ee * qf - ef * qe, w = area - u - v;
    Nearest best{p, a};
    if (u >= 0 && v >= 0 && w >= 0) {
        const double scale = 1 / (u + v + w);
        best.offer(a + (u * scale) * e + (v * scale) * f);
        return best;
    }
    // it lies on a side that p is beyond
    if (v < 0) best.offer(a, e, qe, ee);
    if (u < 0) best.offer(a, f, qf, ff);
    if (w < 0) best.offer(b, f - e, qf - qe - ef + ee, ff - 2 * ef + ee);
    return best;
}

}  // namespace

double DistanceTarget::squaredTo(const Vec3& p, std::int64_t triangle) const {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return nearestOf(p, mesh.points[a], mesh.points[b], mesh.points[c]).squared;
}

FarPoint DistanceTarget::farPoint(const Vec3& p, std::int64_t triangle,
                                  std::int64_t& effort) const {
    const auto nearestOn = [&](const Corners& t) { return nearestOf(p, t[0], t[1], t[2]); };
    const Nearest first = nearestOn(cornersOf(mesh, triangle));
    double reach = first.squared;
    FarPoint result{p, first.point, std::sqrt(reach)};
    tree.forEachNear(
        {p, p}, [&] { return reach; },
        [&](std::int64_t near) {
            --effort;
            const Corners t = cornersOf(mesh, near);
            const Nearest nearest = nearestOn(t);
            if (nearest.squared < reach) {
                reach = nearest.squared;
                result.nearest = nearest.point;
            }
            // the triangle lies beyond a plane across n: holds for any n
            const Vec3 n = p - nearest.point;
            const double least = std::min({dot(n, p - t[0]), dot(n, p - t[1]), dot(n, p - t[2])});
            result.distance =
                std::min(result.distance, least > 0 ? least / std::sqrt(nearest.squared) : 0);
        });
    return result;
}

double Tolerance::roundingAt(double coordinateMm) {
    // Let u = 2^-53 and M the largest coordinate. A point a + t (b - a), 0 <= t <= 1, is computed
    // to 5 u M along each axis, 9 u M in all: so far may a cut take its pieces off the surface,
    // and all cuts 900 u M. A point of a triangle, put together of two such terms and weights whose
    // sum is off by 4 u, lies within 40 u M of it, and the length of a difference is computed to
    // 20 u M; so are products with a unit vector and distances of boxes. That is less than
    // 2^10 u M, here doubled.
    static_assert(kMostCuts <= 100);
    return 0x1p-42 * coordinateMm;
}

double Tolerance::at(double distanceMm) const {
    return std::max(options.partOfDistance * distanceMm, options.partOfSize * sizeMm);
}

double Tolerance::enoughMm(double distanceMm) const {
    // the ends move apart by the rounding, and are rounded themselves
    const double least = distanceMm + 2 * roundingMm;
    const double wide = std::max(least, distanceMm + 0.999 * at(distanceMm) - 2 * roundingMm);
    const double limit = options.limitMm.value_or(kUnbounded);
    return limit < distanceMm ? wide : std::min(wide, std::max(least, limit - 2 * roundingMm));
}

double PieceSearch::bound(const std::array<Corner, 3>& triangle, std::int64_t& effort) {
    effort_ = effort;
    closed_ = 0;
    open_.clear();
    areAllNearby_ = false;
    Piece whole{triangle};
    if (effort == 0) return boundOf(whole, kUnbounded);
    for (Corner& corner : whole.corners) {
        if (corner.squared > enough_) corner = cornerAt(corner.point, corner.triangle);
    }
    offer(whole);
    if (!open_.empty()) {
        gatherNearby(whole);
        if (isNearMiddle(whole)) open_.clear();
    }
    while (!open_.empty() && effort_ > 0) {
        const Piece piece = open_.back();
        open_.pop_back();
        cut(piece);
    }
    for (const Piece& piece : open_) closed_ = std::max(closed_, boundOf(piece, kUnbounded));
    effort = effort_;
    return closed_;
}

void PieceSearch::setEnough() {
    const double enough = tolerance_.enoughMm(farthest_.distance);
    enough_ = enough * enough;
}

double PieceSearch::squaredTo(const Vec3& p, std::int64_t triangle) {
    --effort_;
    return to_.squaredTo(p, triangle);
}

/// The largest squared distance of the corners from one and the same triangle, the best of theirs.
/// \param most  larger ones need not be exact
double PieceSearch::boundOf(const Piece& piece, double most) {
    const auto& c = piece.corners;
    double best = kUnbounded;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int64_t t = c[i].triangle;
        if ((i > 0 && t == c[0].triangle) || (i > 1 && t == c[1].triangle)) continue;
        double farthest = c[i].squared;
        for (std::size_t j = 1; j < 3 && farthest < best && farthest <= most; ++j) {
            const Corner& other = c[(i + j) % 3];
            farthest = std::max(farthest,
                                other.isNear(t) ? other.squaredTo(t) : squaredTo(other.point, t));
        }
        best = std::min(best, farthest);
    }
    return best;
}

/// A piece is near enough, or is kept to be cut.
void PieceSearch::offer(const Piece& piece) {
    const double bound = boundOf(piece, enough_);
    if (bound <= enough_) {
        closed_ = std::max(closed_, bound);
    } else {
        open_.push_back(piece);
    }
}

/// A triangle that both surfaces have is the nearest at its middle; at its corners others are too.
bool PieceSearch::isNearMiddle(Piece piece) {
    auto& [a, b, c] = piece.corners;
    const Corner middle = cornerAt(1.0 / 3 * (a.point + b.point + c.point), a.triangle);
    double farthest = 0;
    for (const Corner& corner : piece.corners) {
        if (corner.triangle == middle.triangle) return false;  // it was tried
        farthest = std::max(farthest, squaredTo(corner.point, middle.triangle));
    }
    if (farthest > enough_) return false;
    closed_ = std::max(closed_, farthest);
    return true;
}

/// Gathers the triangles that may be near enough to a piece: a list of few is searched faster than
/// the tree.
void PieceSearch::gatherNearby(const Piece& piece) {
    constexpr std::size_t kMost = 96;
    BoundingBox box =
        boxOf(Corners{piece.corners[0].point, piece.corners[1].point, piece.corners[2].point});
    const double reach = std::sqrt(enough_);
    box.minimum = box.minimum - Vec3{reach, reach, reach};
    box.maximum = box.maximum + Vec3{reach, reach, reach};
    nearby_.clear();
    areAllNearby_ = true;
    to_.tree.forEachOverlap(box, [&](std::int64_t triangle) {
        --effort_;
        if (nearby_.size() == kMost) {
            areAllNearby_ = false;
            box = BoundingBox::empty();
        } else {
            nearby_.push_back({to_.tree.triangleBox(triangle), triangle});
        }
    });
}

/// The nearest triangle, or another one that is near enough.
/// Those found last are asked first, and one at half the distance will do.
PieceSearch::Corner PieceSearch::cornerAt(const Vec3& p, std::int64_t hint) {
    Corner corner{p, hint, squaredTo(p, hint)};
    if (areAllNearby_) {
        constexpr double kNear = 0.25;  // squared
        for (Nearby& nearby : nearby_) {
            if (squaredDistance(p, nearby.box) >= corner.squared) continue;
            const double squared = squaredTo(p, nearby.triangle);
            if (squared < corner.squared) {
                corner = {p, nearby.triangle, squared};
                std::swap(nearby, nearby_.front());
                if (squared < kNear * enough_) break;
            }
        }
        if (corner.squared <= enough_) return corner;
    }
    constexpr std::int64_t kLeast = 512;
    SearchEffort search{std::max(effort_, kLeast)};
    effort_ -= search.triangles;
    corner.triangle = to_.tree.closestPoint(p, corner.triangle, &search).triangle;
    effort_ += search.triangles;
    corner.squared = to_.squaredTo(p, corner.triangle);
    if (corner.squared <= enough_ || search.isRough || search.isOpen) return corner;
    const FarPoint found = to_.farPoint(p, corner.triangle, effort_);
    if (found.distance > farthest_.distance) {
        farthest_ = found;
        setEnough();
        areAllNearby_ = false;
    }
    return corner;
}

void PieceSearch::cut(const Piece& piece) {
    const auto& c = piece.corners;
    const auto longestSide = [&](const auto& isWanted) {
        std::size_t side = 3;
        double longest = -1;
        for (std::size_t i = 0; i < 3; ++i) {
            const Corner &a = c[i], &b = c[(i + 1) % 3];
            const double length = squaredNorm(b.point - a.point);
            if (!isWanted(a, b) || !(length > longest)) continue;
            longest = length;
            side = i;
        }
        return side;
    };
    if (piece.cuts == kMostCuts) {
        closed_ = std::max(closed_, boundOf(piece, kUnbounded));
        return;
    }
    std::size_t side = longestSide([](const Corner& a, const Corner& b) {
        return !a.isNear(b.triangle) && !b.isNear(a.triangle);
    });
    std::array<Corner, 2> at;
    if (side == 3 || !isParted(c[side], c[(side + 1) % 3], at)) {
        // near a third triangle, which is a good place at first; halving shrinks the piece for sure
        constexpr int kFreeCuts = 16;
        Vec3 p = at[0].point;
        if (side == 3 || piece.cuts >= kFreeCuts) {
            side = longestSide([](const Corner&, const Corner&) { return true; });
            p = 0.5 * (c[side].point + c[(side + 1) % 3].point);
        }
        at[0] = at[1] = cornerAt(p, c[side].triangle);
    }
    const Corner &a = c[side], &b = c[(side + 1) % 3], &opposite = c[(side + 2) % 3];
    offer({{a, at[0], opposite}, piece.cuts + 1});
    offer({{at[1], b, opposite}, piece.cuts + 1});
}

/// Looks for a point of an edge near enough to the triangles of both ends: a corner of either part.
/// \param at  gets the point twice, as a corner of a's part and of b's; where there is none, a
///            point near a third triangle
bool PieceSearch::isParted(const Corner& a, const Corner& b, std::array<Corner, 2>& at) {
    constexpr int kMostSteps = 24;
    double low = 0, high = 1;
    // how much farther a's triangle is than b's
    double atLow = std::sqrt(a.squared) - std::sqrt(squaredTo(a.point, b.triangle)),
           atHigh = std::sqrt(squaredTo(b.point, a.triangle)) - std::sqrt(b.squared);
    int last = 0;
    for (int step = 0; step < kMostSteps; ++step) {
        // by secants, which meet a kink soon; the end that stays counts half (Illinois)
        double t = (low * atHigh - high * atLow) / (atHigh - atLow);
        if (!(t > low && t < high)) t = 0.5 * (low + high);
        const Vec3 p = a.point + t * (b.point - a.point);
        const double toA = squaredTo(p, a.triangle), toB = squaredTo(p, b.triangle);
        at = {{{p, a.triangle, toA, b.triangle, toB}, {p, b.triangle, toB, a.triangle, toA}}};
        if (std::max(toA, toB) <= enough_) return true;
        if (std::min(toA, toB) > enough_) return false;
        const double farther = std::sqrt(toA) - std::sqrt(toB);
        const int side = farther < 0 ? -1 : 1;
        (side < 0 ? low : high) = t;
        (side < 0 ? atLow : atHigh) = farther;
        if (side == last) (side < 0 ? atHigh : atLow) *= 0.5;
        last = side;
    }
    return false;
}

}  // namespace adaptiso
