#include "ElectrodeSides.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

constexpr double kBesideMm = 10;  // of the middle: electrodes there are placed no better

std::string placeText(const NamedPoint& point, double rightMm) {
    return visibleAscii(point.name) + " " + formatFixed(std::abs(rightMm), 0) + " mm to the " +
           (rightMm > 0 ? "right" : "left");
}

}  // namespace

std::optional<Warning> doubtfulSides(const std::vector<NamedPoint>& points,
                                     const std::optional<Landmarks>& landmarks,
                                     const TriangleMesh& skin) {
    Vec3 right{-1, 0, 0}, middle = 0.5 * (boundingBox(skin).minimum + boundingBox(skin).maximum);
    if (landmarks) {
        right = normalized(landmarks->rightEarMm - landmarks->leftEarMm);
        middle = 0.5 * (landmarks->leftEarMm + landmarks->rightEarMm);
    }
    std::size_t named = 0, rightly = 0;
    std::vector<std::string> wrong;
    for (const NamedPoint& point : points) {
        const std::optional<HeadSide> side = sideOfName(point.name);
        if (!side) continue;
        ++named;
        const double mm = dot(point.point - middle, right);
        if (*side == HeadSide::Middle || std::abs(mm) < kBesideMm) continue;
        if ((mm > 0) == (*side == HeadSide::Right)) {
            ++rightly;
        } else {
            wrong.push_back(placeText(point, mm));
        }
    }
    if (wrong.empty() || 2 * named < points.size()) return std::nullopt;
    constexpr std::size_t kShown = 3;
    std::string shown;
    for (std::size_t n = 0; n < std::min(kShown, wrong.size()); ++n) {
        shown += (n == 0 ? "" : ", ") + wrong[n];
    }
    if (wrong.size() > kShown) shown += ", ...";
    const std::string text = std::to_string(wrong.size()) + " of " +
                             std::to_string(wrong.size() + rightly) +
                             " electrodes beside the middle lie on the side that their names "
                             "exclude (odd numbers are of the left): " +
                             shown;
    if (wrong.size() > rightly) {
        throw InvalidInput(text + "; are names of left and right exchanged, or is an axis turned?");
    }
    return Warning{"sides-doubtful", text + "; are these names exchanged?"};
}

std::optional<Warning> doubtfulSides(const Landmarks& landmarks) {
    if (!(landmarks.leftEarMm.x < landmarks.rightEarMm.x)) return std::nullopt;  // LPS
    return Warning{"sides-doubtful",
                   "the left ear lies on the image's right; are the frame (ras or lps) and the "
                   "image's orientation right?"};
}

}  // namespace adaptiso
