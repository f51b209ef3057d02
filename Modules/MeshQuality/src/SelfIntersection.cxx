#include "adaptiso/MeshQuality/SelfIntersection.h"

#include <algorithm>
#include <utility>

#include "Triangles.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

bool areOnOneSide(int a, int b, int c) {
    return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

/// \pre p lies on the line through a and b
bool isBetween(const Point2& p, const Point2& a, const Point2& b) {
    return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
           std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
}

bool segmentsMeet(const Point2& p, const Point2& q, const Point2& a, const Point2& b) {
    const int pSide = orient2d(a, b, p), qSide = orient2d(a, b, q);
    const int aSide = orient2d(p, q, a), bSide = orient2d(p, q, b);
    if (pSide * qSide < 0 && aSide * bSide < 0) return true;
    return (pSide == 0 && isBetween(p, a, b)) || (qSide == 0 && isBetween(q, a, b)) ||
           (aSide == 0 && isBetween(a, p, q)) || (bSide == 0 && isBetween(b, p, q));
}

/// \pre p, q and the triangle lie in one plane, the triangle has area
bool segmentMeetsCoplanarTriangle(const Vec3& p, const Vec3& q, const Corners& t) {
    const int axis = axisWithArea(t);
    const Point2 p2 = dropAxis(p, axis), q2 = dropAxis(q, axis);
    const Point2 a = dropAxis(t[0], axis), b = dropAxis(t[1], axis), c = dropAxis(t[2], axis);
    return haveOneSign(orient2d(a, b, p2), orient2d(b, c, p2), orient2d(c, a, p2)) ||
           segmentsMeet(p2, q2, a, b) || segmentsMeet(p2, q2, b, c) || segmentsMeet(p2, q2, c, a);
}

/// pSide, qSide: orient3d of the triangle and p, q. \pre the triangle has area
bool segmentMeetsTriangle(const Vec3& p, int pSide, const Vec3& q, int qSide, const Corners& t) {
    if (pSide * qSide > 0) return false;
    if (pSide == 0 && qSide == 0) return segmentMeetsCoplanarTriangle(p, q, t);
    // The line through p and q goes through the triangle when it passes all sides the same way.
    return haveOneSign(orient3d(p, q, t[0], t[1]), orient3d(p, q, t[1], t[2]),
                       orient3d(p, q, t[2], t[0]));
}

/// Side of the plane of `t` on which each corner of `other` lies.
std::array<int, 3> sidesOf(const Corners& t, const Corners& other) {
    return {orient3d(t[0], t[1], t[2], other[0]), orient3d(t[0], t[1], t[2], other[1]),
            orient3d(t[0], t[1], t[2], other[2])};
}

/// Whatever two triangles share ends on a side of one of them.
bool crossWithoutSharing(const Corners& a, const Corners& b) {
    const std::array<int, 3> ofB = sidesOf(a, b);
    if (areOnOneSide(ofB[0], ofB[1], ofB[2])) return false;
    const std::array<int, 3> ofA = sidesOf(b, a);
    if (areOnOneSide(ofA[0], ofA[1], ofA[2])) return false;
    for (int n = 0; n < 3; ++n) {
        const int next = (n + 1) % 3;
        if (segmentMeetsTriangle(b[n], ofB[n], b[next], ofB[next], a) ||
            segmentMeetsTriangle(a[n], ofA[n], a[next], ofA[next], b)) {
            return true;
        }
    }
    return false;
}

/// A section that triangles share besides their corner v reaches from v to a side opposite it: on
/// the way out from v, a point leaves one of the two first. \pre a[0] == b[0], nothing else is
/// shared
bool crossBeyondCorner(const Corners& a, const Corners& b) {
    const int b1 = orient3d(a[0], a[1], a[2], b[1]), b2 = orient3d(a[0], a[1], a[2], b[2]);
    if (b1 * b2 > 0) return false;
    const int a1 = orient3d(b[0], b[1], b[2], a[1]), a2 = orient3d(b[0], b[1], b[2], a[2]);
    if (a1 * a2 > 0) return false;
    return segmentMeetsTriangle(b[1], b1, b[2], b2, a) ||
           segmentMeetsTriangle(a[1], a1, a[2], a2, b);
}

/// \pre a[0] == b[0], a[1] == b[1], the third corners differ
bool crossBeyondEdge(const Corners& a, const Corners& b) {
    if (orient3d(a[0], a[1], a[2], b[2]) != 0) return false;
    const int axis = axisWithArea(a);
    const Point2 p = dropAxis(a[0], axis), q = dropAxis(a[1], axis);
    return orient2d(p, q, dropAxis(a[2], axis)) == orient2d(p, q, dropAxis(b[2], axis));
}

/// Swaps corners so that shared ones come first, in the same order. \return how many are shared.
int alignSharedCorners(Corners& a, Corners& b) {
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = shared; j < 3; ++j) {
            if (a[i] != b[j]) continue;
            std::swap(a[i], a[shared]);
            std::swap(b[j], b[shared]);
            ++shared;
            break;
        }
    }
    return shared;
}

}  // namespace

bool trianglesCross(const Corners& a, const Corners& b) {
    Corners first = a, second = b;
    const int shared = alignSharedCorners(first, second);
    bool cross = false;
    switch (shared) {
        case 0:
            cross = crossWithoutSharing(first, second);
            break;
        case 1:
            cross = crossBeyondCorner(first, second);
            break;
        case 2:
            cross = crossBeyondEdge(first, second);
            break;
        default:
            cross = true;
    }
    // Only the few that seem to cross are asked whether they are triangles at all.
    return cross && axisWithArea(a) >= 0 && axisWithArea(b) >= 0;
}

std::string foundText(std::int64_t found, bool isComplete) {
    if (isComplete) return formatCount(found);
    if (found <= 1) return "at least " + formatCount(found);
    std::int64_t step = 1;  // two digits tell enough
    while (found - 1 >= 100 * step) step *= 10;
    return "more than " + formatCount((found - 1) / step * step);
}

std::string pairsText(std::int64_t found, bool isComplete) {
    return foundText(found, isComplete) + (found == 1 ? " pair" : " pairs");
}

std::string crossingText(const SelfIntersections& crossings) {
    if (crossings.pairCount == 0 && !crossings.isComplete) {
        return "not decided: hundreds of triangles lie near each one, more than are tested";
    }
    return pairsText(crossings.pairCount, crossings.isComplete) + " of triangles cross";
}

bool trianglesMeet(const Corners& a, const Corners& b) {
    return crossWithoutSharing(a, b) && axisWithArea(a) >= 0 && axisWithArea(b) >= 0;
}

}  // namespace adaptiso
