#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "FinishBoundaries.h"
#include "Necks.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {

using namespace headmodel;

namespace {

constexpr double kSoftTissueHu = 40, kAirHu = -1000;
constexpr double kTableMm = 3;  ///< thinner than this is no head: table, cushion, tubes
constexpr double kRestMm = 8;  ///< a ball that gets into noses and necks, not into a plate of 16 mm
constexpr double kRestReachMm = 40;  ///< farther than ears and noses stand out of what it fills
constexpr double kCavityMm = 18;     ///< a ball that does not pass the foramen magnum
constexpr double kCornerMm = 4;      ///< one that gets into the corners of the cavity
constexpr double kCornerReachMm = 14;
constexpr double kBoneSeamMm = 6;  ///< closing of the bone: sutures, thin walls

Mask both(const Mask& a, const Mask& b) {
    Mask result(a.size());
    for (std::size_t n = 0; n < a.size(); ++n) result[n] = a[n] & b[n];
    return result;
}

/// Voxels in `a` and not in `b`.
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

struct CtHead {
    ImageGeometry grid;
    std::vector<float> hu;
    std::vector<std::uint8_t> faces;  ///< imageFaces(), 0 where something was taken off
    Mask solid;                       ///< voxels above the level of skin
};

/// The part of a volume that a box holds, and where it lies.
template <class T>
std::pair<std::vector<T>, ImageGeometry> cutOut(const std::vector<T>& values,
                                                const ImageGeometry& grid, const CropRanges& box) {
    const Volume part = cropVolume(VolumeView(values.data(), grid), box);
    const TypedVolumeView<T> view = part.view().as<T>();
    return {{view.samples, view.samples + view.geometry.voxelCount()}, view.geometry};
}

/// A field of view holds the table too: the head with room around is half of it or less.
void cropToSolid(CtHead& head, double roomMm) {
    const std::vector<float> inside(head.solid.begin(), head.solid.end());
    Index3 first, last;
    boundingIndices(inside, head.grid.size, kFractionIsovalue, first, last);
    const auto room = static_cast<std::int64_t>(std::ceil(roomMm / stepMm(head.grid)));
    CropRanges box;
    for (int a = 0; a < 3; ++a) {
        box[a].first = std::max<std::int64_t>(first[a] - room, 0);
        box[a].end = std::min(last[a] + room + 1, head.grid.size[a]);
    }
    head.solid = cutOut(head.solid, head.grid, box).first;
    head.faces = cutOut(head.faces, head.grid, box).first;
    std::tie(head.hu, head.grid) = cutOut(head.hu, head.grid, box);
}

/// Takes off what hangs on the head, is thin and reaches far: a head rest that touches it, a strap.
void takeOffRest(CtHead& head, std::vector<std::string>& notes) {
    const Mask whole = filled(head.solid, head.grid.size);
    Mask rest(whole.size(), 0);
    for (const Neck& part : findNecks(whole, head.grid, kRestMm, 0)) {
        if (part.reachMm < kRestReachMm) continue;
        for (const std::int64_t voxel : part.voxels) rest[voxel] = 1;
        notes.push_back("skin: a part of " + shortNumber(part.mm3 / 1000) +
                        " cm3 that is thinner than " + shortNumber(2 * kRestMm) +
                        " mm and reaches " + shortNumber(part.reachMm) +
                        " mm from the head was taken off (a head rest?); where it touched, the "
                        "skin may hold some of it");
    }
    if (voxelsIn(rest) == 0) return;
    for (std::size_t n = 0; n < rest.size(); ++n) {
        if (rest[n] != 0) head.solid[n] = 0;
    }
    head.solid = largestComponent(head.solid, head.grid.size);
    // neither air nor skin is seen there
    const Mask beside = dilated(rest, head.grid, 2 * stepMm(head.grid));
    for (std::size_t n = 0; n < beside.size(); ++n) {
        if (beside[n] != 0 && head.solid[n] == 0) head.faces[n] = 0;
    }
}

CtHead findHeadInCt(const VolumeView& ct, const BoundaryOptions& options,
                    std::vector<std::string>& notes) {
    const FloatImage image = toFloat(ct, static_cast<float>(kAirHu));
    requireHounsfield(image, options);
    Index3 first, last;
    if (!boundingIndices(image.values, image.geometry.size, options.skinHu, first, last)) {
        throw InvalidInput("nothing is above " + shortNumber(options.skinHu) + " HU");
    }
    const double roomMm = std::max(marginMm(options), kCavityMm + 4);
    CtHead head;
    head.grid = workingGrid(image.geometry, first, last, options.stepMm, roomMm);
    head.hu = resampled(image, head.grid, static_cast<float>(kAirHu));
    head.faces = imageFaces(image.geometry, head.grid);
    head.solid = largestComponent(opened(above(head.hu, options.skinHu), head.grid, kTableMm),
                                  head.grid.size);
    if (voxelsIn(head.solid) == 0) {
        throw InvalidInput("nothing above " + shortNumber(options.skinHu) + " HU is thicker than " +
                           shortNumber(2 * kTableMm) + " mm");
    }
    cropToSolid(head, roomMm);
    takeOffRest(head, notes);
    cropToSolid(head, roomMm);
    return head;
}

RawBoundaries rawBoundaries(const VolumeView& ct, const BoundaryOptions& options) {
    tell(options, "head", 0);
    RawBoundaries raw;
    const CtHead found = findHeadInCt(ct, options, raw.notes);
    raw.grid = found.grid;
    const auto& [grid, hu, faces, solid] = found;
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
    return raw;
}

}  // namespace

HeadBoundaries boundariesFromCt(const VolumeView& ct, const BoundaryOptions& options) {
    checkOptions(options);
    if (options.innerSurfaces > 0) {
        throw InvalidInput("a CT does not show where the brain ends and CSF begins");
    }
    if (!(options.skinHu < options.skullHu) || !(options.skinHu > kAirHu) ||
        !(options.skullHu > kSoftTissueHu)) {
        throw InvalidInput("skin at " + shortNumber(options.skinHu) + " HU and bone at " +
                           shortNumber(options.skullHu) +
                           " HU; must be above air (-1000) and above soft tissue (40)");
    }
    return finished(rawBoundaries(ct, options), options);
}

}  // namespace adaptiso
