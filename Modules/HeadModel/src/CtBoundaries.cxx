#include <algorithm>
#include <string>

#include "FinishBoundaries.h"
#include "Necks.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

using namespace headmodel;

namespace {

constexpr double kSoftTissueHu = 40, kAirHu = -1000;
constexpr double kTableMm = 3;    ///< thinner than this is no head: table, cushion, tubes
constexpr double kCavityMm = 18;  ///< a ball that does not pass the foramen magnum
constexpr double kCornerMm = 4;   ///< one that gets into the corners of the cavity
constexpr double kCornerReachMm = 14;
constexpr double kBoneSeamMm = 6;  ///< closing of the bone: sutures, thin walls

Mask both(const Mask& a, const Mask& b) {
    Mask result(a.size());
    for (std::size_t n = 0; n < a.size(); ++n) result[n] = a[n] & b[n];
    return result;
}

/// What is in the head and not bone.
Mask without(const Mask& a, const Mask& b) {
    Mask result(a.size());
    for (std::size_t n = 0; n < a.size(); ++n) result[n] = a[n] & (b[n] ^ 1);
    return result;
}

/// The cavity that holds the brain: of the places where the large ball fits without touching bone
/// or leaving the head, the largest room; and what the small ball reaches from it nearby.
Mask brainCavity(const Mask& head, const Mask& bone, const ImageGeometry& grid) {
    const Mask room = without(head, bone);
    const Mask core = largestComponent(eroded(room, grid, kCavityMm), grid.size);
    if (voxelsIn(core) == 0) {
        throw InvalidInput(
            "no room for a brain inside of the bone; is the isovalue of "
            "bone right?");
    }
    const Mask large = both(dilated(core, grid, kCavityMm), room);
    // not out through a foramen and back along the bone's outside
    const Mask envelope = filled(closed(bone, grid, kCavityMm), grid.size);
    const Mask near =
        both(envelope, both(opened(room, grid, kCornerMm), dilated(large, grid, kCornerReachMm)));
    Mask cavity = componentsWith(large, near, grid.size);
    for (std::size_t n = 0; n < cavity.size(); ++n) cavity[n] |= large[n];
    return filled(closed(cavity, grid, kCornerMm), grid.size);
}

/// In Hounsfield units air has -1000, and there is air around and in every head.
void requireHounsfield(const FloatImage& image, const BoundaryOptions& options) {
    const auto [least, most] = std::minmax_element(image.values.begin(), image.values.end());
    if (*least < options.skinHu) return;
    throw InvalidInput("the samples lie in " + shortNumber(*least) + " to " + shortNumber(*most) +
                       " and are not in Hounsfield units: air has -1000, and nothing lies below " +
                       shortNumber(options.skinHu) +
                       "; give the CT as it was reconstructed, not a window of it, with its "
                       "rescale slope and intercept");
}

}  // namespace

HeadBoundaries boundariesFromCt(const VolumeView& ct, const BoundaryOptions& options) {
    checkOptions(options);
    if (options.withBrain) {
        throw InvalidInput("a CT does not show where the brain ends and CSF begins");
    }
    if (!(options.skinHu < options.skullHu) || !(options.skinHu > kAirHu) ||
        !(options.skullHu > kSoftTissueHu)) {
        throw InvalidInput("skin at " + shortNumber(options.skinHu) + " HU and bone at " +
                           shortNumber(options.skullHu) +
                           " HU; must be above air (-1000) and above soft tissue (40)");
    }
    tell(options, "head", 0);
    const FloatImage image = toFloat(ct, static_cast<float>(kAirHu));
    requireHounsfield(image, options);
    Index3 first, last;
    if (!boundingIndices(image.values, image.geometry.size, options.skinHu, first, last)) {
        throw InvalidInput("nothing is above " + shortNumber(options.skinHu) + " HU");
    }
    RawBoundaries raw;
    raw.grid = workingGrid(image.geometry, first, last, options.stepMm,
                           std::max(marginMm(options), kCavityMm + 4));
    const ImageGeometry& grid = raw.grid;
    const std::vector<float> hu = resampled(image, grid, static_cast<float>(kAirHu));
    const std::vector<std::uint8_t> faces = imageFaces(image.geometry, grid);

    const Mask solid =
        largestComponent(opened(above(hu, options.skinHu), grid, kTableMm), grid.size);
    const Mask head = filledAtBorder(closed(solid, grid, options.closingMm), faces, grid.size);
    const Mask bone = both(head, above(hu, options.skullHu));
    if (voxelsIn(bone) == 0) {
        throw InvalidInput("nothing in the head is above " + shortNumber(options.skullHu) + " HU");
    }
    tell(options, "skull", 0);
    Mask cavity = brainCavity(head, bone, grid);
    // the cavity is what is darker than bone: its level is approached from above
    const double brightBone = 2 * options.skullHu - kSoftTissueHu;
    raw.parts.push_back(partByLevel(cavity, hu, options.skullHu, brightBone, faces, grid));
    cutNecks(raw, options);
    if (!options.innerSkullOnly) {
        cavity = above(raw.parts[0], kFractionIsovalue);
        Mask skull = closed(largestComponent(bone, grid.size), grid, kBoneSeamMm);
        for (std::size_t n = 0; n < skull.size(); ++n) skull[n] |= cavity[n];
        skull = both(filled(skull, grid.size), head);
        raw.parts.push_back(partByLevel(skull, hu, options.skullHu, kSoftTissueHu, faces, grid));
        raw.parts.push_back(partByLevel(head, hu, options.skinHu, kAirHu, faces, grid));
        const std::vector<Vec3> bonesSides = sidesOf(bone, grid, faces);
        raw.seenMm = {bonesSides, bonesSides, sidesOf(filled(solid, grid.size), grid, faces)};
        limitOuterSkull(raw, options);
    }
    return finished(std::move(raw), options);
}

}  // namespace adaptiso
