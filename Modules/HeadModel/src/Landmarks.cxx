#include "adaptiso/HeadModel/Landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "FinishBoundaries.h"
#include "SkinArcs.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

using namespace headmodel;

namespace {

// Measured on FreeSurfer's average head, in lengths of its inner skull: distance below the top and
// behind the front of the inner skull.
constexpr double kNasionBelow = 0.66, kEarBelow = 0.69, kEarBehind = 0.566;
// By proportion a head that is tilted has its nose's tip for a nasion, 48 mm off.
// Colin's head, in 40 sizes, meshes and turns by up to 10 degrees: seen nasions were off by at most
// 14 mm, ears by 28 (HeadModel.md).
constexpr double kSeenNasionMm = 15, kProportionMm = 50, kEarMm = 28;

constexpr Vec3 kForward{0, -1, 0};  // LPS

/// Extent of a head that proportions refer to.
struct HeadExtent {
    double middleX, frontY, topZ, lengthMm;
};

HeadExtent extentOf(const TriangleMesh& innerSkull) {
    const BoundingBox box = boundingBox(innerSkull);
    return {(box.minimum.x + box.maximum.x) / 2, box.minimum.y, box.maximum.z,
            box.maximum.y - box.minimum.y};
}

/// The skin farthest in front, in the middle plane at a height.
std::optional<Vec3> profileAt(const TriangleMesh& skin, const HeadExtent& extent, double z) {
    const Vec3 inside{extent.middleX, extent.frontY + extent.lengthMm / 2, z};
    const RayHits hits = rayHits(skin, inside, kForward);
    if (hits.mm.empty()) return std::nullopt;
    return inside + hits.mm.back() * kForward;
}

struct SeenNasion {
    Vec3 pointMm;
    double uncertaintyMm;
};

/// The deepest place between nose and forehead.
std::optional<SeenNasion> nasionOf(const TriangleMesh& skin, const HeadExtent& extent) {
    constexpr double kFromBelow = 0.95, kToBelow = 0.45, kNoseBelow = 0.6, kAboveNoseMm = 70;
    constexpr double kStandsOutMm = 5;
    std::vector<Vec3> profile;  // upwards
    for (double z = extent.topZ - kFromBelow * extent.lengthMm;
         z <= extent.topZ - kToBelow * extent.lengthMm; z += 1) {
        if (const auto point = profileAt(skin, extent, z)) profile.push_back(*point);
    }
    const auto isFarther = [](const Vec3& a, const Vec3& b) { return a.y > b.y; };
    const auto noseEnd = std::find_if(profile.begin(), profile.end(), [&](const Vec3& p) {
        return p.z > extent.topZ - kNoseBelow * extent.lengthMm;
    });
    if (noseEnd == profile.begin()) return std::nullopt;
    const auto nose = std::max_element(profile.begin(), noseEnd, isFarther);
    const auto end = std::find_if(nose, profile.end(),
                                  [&](const Vec3& p) { return p.z > nose->z + kAboveNoseMm; });
    const auto nasion = std::min_element(nose, end, isFarther);
    // the forehead comes forward again above it
    const bool isDent =
        std::any_of(nasion, profile.end(), [&](const Vec3& p) { return p.y < nasion->y - 1; });
    if (nasion->y - nose->y < kStandsOutMm || !isDent) return std::nullopt;
    return SeenNasion{*nasion, kSeenNasionMm};
}

std::optional<Vec3> earOf(const TriangleMesh& skin, const HeadExtent& extent, double side) {
    const Vec3 inside{extent.middleX, extent.frontY + kEarBehind * extent.lengthMm,
                      extent.topZ - kEarBelow * extent.lengthMm};
    const Vec3 outward{side, 0, 0};
    const RayHits hits = rayHits(skin, inside, outward);
    if (hits.mm.empty()) return std::nullopt;
    return inside + hits.mm.front() * outward;  // before the fold of the ear, if there is one
}

/// Origin and unit axes (right, front, up).
AffineTransform headAxes(const Landmarks& of) {
    const Vec3 across = of.rightEarMm - of.leftEarMm;
    const double width = norm(across);
    const Vec3 right = (1 / width) * across;
    const Vec3 toNasion = of.nasionMm - of.leftEarMm;
    const Vec3 origin = of.leftEarMm + dot(toNasion, right) * right;
    const Vec3 forward = of.nasionMm - origin;
    const double depth = norm(forward);
    if (!(width > 20) || !(depth > 20)) {
        throw InvalidInput("nasion and ears are within " + shortNumber(std::min(width, depth)) +
                           " mm, must span a head (20 mm or more; is the unit right?)");
    }
    const Vec3 front = (1 / depth) * forward;
    return {{{{right, front, cross(right, front)}}}, origin};
}

}  // namespace

GuessedLandmarks guessLandmarks(const TriangleMesh& innerSkull, const TriangleMesh& skin) {
    const HeadExtent extent = extentOf(innerSkull);
    const double lowest = boundingBox(skin).minimum.z;
    constexpr double kRoomMm = 5;
    GuessedLandmarks guess;
    if (extent.topZ - kEarBelow * extent.lengthMm < lowest + kRoomMm) {
        guess.reason = "the head is cut above the ears; give nasion and ears";
        return guess;
    }
    const auto left = earOf(skin, extent, 1), right = earOf(skin, extent, -1);
    std::optional<SeenNasion> nasion = nasionOf(skin, extent);
    if (!nasion) {
        const auto point = profileAt(skin, extent, extent.topZ - kNasionBelow * extent.lengthMm);
        if (point) nasion = SeenNasion{*point, kProportionMm};
    }
    if (!left || !right || !nasion) {
        guess.reason = "no skin lies where nasion and ears of an upright head are; give them";
        return guess;
    }
    guess.landmarks = Landmarks{nasion->pointMm, *left, *right, nasion->uncertaintyMm, kEarMm};
    return guess;
}

AffineTransform byLandmarks(const Landmarks& from, const Landmarks& to) {
    return headAxes(to) * inverse(headAxes(from));
}

AffineTransform toNeuromag(const Landmarks& landmarks) {
    return inverse(headAxes(landmarks));
}

AffineTransform toBrainstorm(const Landmarks& landmarks) {
    headAxes(landmarks);  // throws
    const Vec3 origin = 0.5 * (landmarks.leftEarMm + landmarks.rightEarMm);
    const Vec3 x = normalized(landmarks.nasionMm - origin);
    const Vec3 z = normalized(cross(x, landmarks.leftEarMm - landmarks.rightEarMm));
    return inverse(AffineTransform{{{{x, cross(z, x), z}}}, origin});
}

OntoSkin projectedOntoSkin(const std::vector<Vec3>& pointsMm, const TriangleMesh& skin) {
    const AabbTree tree(skin);
    OntoSkin result;
    for (std::size_t n = 0; n < pointsMm.size(); ++n) {
        const ClosestPoint nearest = tree.closestPoint(pointsMm[n]);
        const double mm = std::sqrt(nearest.squaredDistanceMm2);
        result.pointsMm.push_back(nearest.pointMm);
        result.meanMm += mm / static_cast<double>(pointsMm.size());
        if (mm <= result.farthestMm) continue;
        result.farthestMm = mm;
        result.farthest = n;
    }
    return result;
}

}  // namespace adaptiso
