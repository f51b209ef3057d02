#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "BoundaryTestSupport.h"
#include "Support/Meshes.h"

namespace adaptiso {
namespace {

using namespace testing;

/// A head of the usual size in 2 mm voxels, cut at the neck, with ears and an airway.
struct LargeHead {
    HeadShapes shapes = sphericalHead({3, -4, 8}, 68, 74, 81);
    ImageGeometry geometry = centredGeometry({96, 96, 96}, {2, 2, 2});

    LargeHead() {
        const Shape neck = box({3, -10, -77}, {45, 50, 45});
        const Shape leftEar = box({88, -4, 5}, {12, 6, 16}),
                    rightEar = box({-82, -4, 5}, {12, 6, 16});
        const Shape airway = box({3, 10, -95}, {5, 5, 25});
        const Shape skull = shapes.skin;
        shapes.skin.depthMm = [=](const Vec3& p) {
            const double solid = std::max(
                {skull.depthMm(p), neck.depthMm(p), leftEar.depthMm(p), rightEar.depthMm(p)});
            return std::min(solid, -airway.depthMm(p));
        };
    }
};

TEST(BoundariesFromT1, FindSkinBrainAndSkullBandOfAPhantom) {
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    const HeadBoundaries found =
        boundariesFromT1({t1.data(), head.geometry}, std::nullopt, options);
    ASSERT_EQ(found.solids.size(), 3u);
    ASSERT_EQ(found.warnings.size(), 1u);
    EXPECT_EQ(found.warnings[0].code, "guessed-brain");
    // "1290 cm3", not "1.29e+03 cm3"
    EXPECT_EQ(found.warnings[0].text.find("e+"), std::string::npos);
    // the brain is cut by voxels of 2 mm; 2 mm of CSF are added to it
    EXPECT_LE(surfaceError(found.solids[0], head.shapes.innerSkull).largestMm, 2.0);
    EXPECT_LE(std::abs(surfaceError(found.solids[0], head.shapes.innerSkull).meanMm), 1.0);

    // the upper half: scalp all round
    const TriangleMesh outer = surfaceOf(found.solids[1]);
    double sum = 0, count = 0;
    for (const Vec3& p : outer.points) {
        if (p.z < 18) continue;
        sum -= head.shapes.outerSkull.depthMm(p);
        ++count;
        EXPECT_LE(std::abs(head.shapes.outerSkull.depthMm(p)), 2.0);  // a voxel
    }
    EXPECT_LE(std::abs(sum / count), 0.6);

    // the skin: ears are in it, the airway is not, the neck is closed
    const TriangleMesh skin = surfaceOf(found.solids[2]);
    const BoundingBox box = boundingBox(skin);
    EXPECT_NEAR(box.maximum.x, 96, 1);  // the image ends in the ear, half a voxel on: 96
    EXPECT_NEAR(box.minimum.z, head.geometry.originMm.z - 1, 1.5);
    for (const double gap : gapsOf(found)) EXPECT_GE(gap, 2 - 2);
}

/// What a bad scan makes of a T1: brighter to one side than to the other, noise, and a side beyond
/// the field of view.
struct BadScan {
    ImageGeometry geometry;
    std::vector<float> t1;

    BadScan(const LargeHead& head, double bias, double noise, std::int64_t cutVoxels)
        : geometry(head.geometry) {
        const std::vector<float> whole = headT1(head.shapes, 2, head.geometry);
        geometry.size[0] -= cutVoxels;
        std::uint64_t seed = 7;
        for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
            const Index3 at{n % geometry.size[0], n / geometry.size[0] % 96,
                            n / (geometry.size[0] * 96)};
            const double place = static_cast<double>(at[0] - at[2]) / 96;  // -1 to 1
            double spread = 0;  // about normal: the sum of twelve, less its mean
            for (int k = 0; k < 12; ++k)
                spread += static_cast<double>(nextRandom(seed) % 1024) / 1024;
            t1.push_back(static_cast<float>(
                std::abs(whole[at[0] + 96 * (at[1] + 96 * at[2])] * (1 + bias * place) +
                         noise * (spread - 6))));
        }
    }
};

TEST(BoundariesFromT1, FindTheBrainThroughABiasFieldNoiseAndACut) {
    const LargeHead head;
    const BadScan scan(head, 0.6, 7, 12);  // 0.5 to 1.5 within the head; 7 % of the brain's level
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    options.innerSkullOnly = true;
    const HeadBoundaries found =
        boundariesFromT1({scan.t1.data(), scan.geometry}, std::nullopt, options);
    EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), [](const std::string& note) {
        return note.find("a bias field") != std::string::npos;
    }));
    // as without: the brain is cut by voxels of 2 mm
    const SurfaceError error = surfaceError(found.solids[0], head.shapes.innerSkull);
    EXPECT_LE(error.largestMm, 3.0);
    EXPECT_LE(std::abs(error.meanMm), 1.0);
    ASSERT_EQ(found.warnings.size(), 1u);
    EXPECT_EQ(found.warnings.front().code, "guessed-brain");
}

TEST(BoundariesFromT1, WarnsWhereABrainLacksAPart) {
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    // the brain without its top: up to 23 mm of it lie between the mask and the skull there
    const Shape& whole = head.shapes.innerSkull;
    Shape low;
    low.depthMm = [&](const Vec3& p) { return std::min(whole.depthMm(p) - 2, 53 - p.z); };
    const std::vector<float> mask = partInside(low, head.geometry);
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    const HeadBoundaries found = boundariesFromT1({t1.data(), head.geometry},
                                                  VolumeView{mask.data(), head.geometry}, options);
    EXPECT_TRUE(
        std::any_of(found.warnings.begin(), found.warnings.end(), [](const Warning& warning) {
            return warning.text.find("as bright as brain") != std::string::npos;
        }));
}

/// CSF within the brain, as sulci and ventricles have it: rods of 6 mm, 18 mm apart.
bool isInSulcus(const Vec3& p, const LargeHead& head) {
    const auto place = [](double mm) { return mm - 18 * std::floor(mm / 18); };
    return head.shapes.innerSkull.depthMm(p) > 4 && place(p.x) < 6 && place(p.y) < 6;
}

Vec3 placeOf(std::int64_t voxel, const ImageGeometry& geometry) {
    const Index3& size = geometry.size;
    return geometry.toPhysical({static_cast<double>(voxel % size[0]),
                                static_cast<double>(voxel / size[0] % size[1]),
                                static_cast<double>(voxel / (size[0] * size[1]))});
}

TEST(BoundariesFromT1, TakeALesionForBrainWhereItIsMarked) {
    const LargeHead head;
    std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    const Shape cavity = sphere({3 + 40, -4, 8 + 35}, 20);  // touches the inner skull
    std::vector<float> lesion(t1.size());
    for (std::int64_t n = 0; n < std::ssize(t1); ++n) {
        const Vec3 p = placeOf(n, head.geometry);
        if (cavity.depthMm(p) < 0 || head.shapes.innerSkull.depthMm(p) < 0) continue;
        t1[n] = 30;
        lesion[n] = 1;
    }
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    options.innerSkullOnly = true;
    BrainSources sources;
    const auto error = [&] {
        const HeadBoundaries found = boundariesFromT1({t1.data(), head.geometry}, sources, options);
        return surfaceError(found.solids[0], head.shapes.innerSkull).largestMm;
    };
    EXPECT_GT(error(), 10);  // the cavity is as dark as CSF
    sources.lesion = VolumeView{lesion.data(), head.geometry};
    EXPECT_LE(error(), 3);  // as without a lesion; voxels have 2 mm
    std::fill(lesion.begin(), lesion.end(), 0.0F);
    EXPECT_THROW(error(), InvalidInput);
}

TEST(BoundariesFromT1, TakeABrightDuraForTheInnerSkullItself) {
    const LargeHead head;
    const auto found = [&](double duraLevel) {
        std::vector<float> t1 = headT1(head.shapes, 0, head.geometry);
        for (std::int64_t n = 0; n < std::ssize(t1); ++n) {
            const Vec3 p = placeOf(n, head.geometry);
            const double depth = head.shapes.innerSkull.depthMm(p);
            const bool isSinus = std::abs(p.x - 3) < 5 && depth < 8 && p.z > 30;
            if (depth > 1 && depth < 8) t1[n] = 75;  // the cortex
            if (depth > 0 && depth < 3) t1[n] = static_cast<float>(duraLevel);
            if (depth > 0 && isSinus && duraLevel > 75) t1[n] = 200;
        }
        BoundaryOptions options;
        options.stepMm = 2;
        options.smoothingMm = 2;
        return boundariesFromT1({t1.data(), head.geometry}, std::nullopt, options);
    };
    const auto saysDura = [](const HeadBoundaries& made) {
        return std::any_of(made.notes.begin(), made.notes.end(), [](const std::string& note) {
            return note.find("contrast agent") != std::string::npos;
        });
    };
    const HeadBoundaries bright = found(120), plain = found(30);
    EXPECT_TRUE(saysDura(bright));
    EXPECT_FALSE(saysDura(plain));
    // with 2 mm of CSF around the dura the mean is 1.8 mm; voxels have 2 mm
    EXPECT_LE(std::abs(surfaceError(bright.solids[0], head.shapes.innerSkull).meanMm), 0.7);
    EXPECT_LE(surfaceError(bright.solids[0], head.shapes.innerSkull).largestMm, 2.5);
}

TEST(BoundariesFromT1, RecogniseAT2) {
    const LargeHead head;
    std::vector<float> t1 = headT1(head.shapes, 2, head.geometry), t2 = t1;
    for (std::int64_t n = 0; n < std::ssize(t1); ++n) {
        const Vec3 p = placeOf(n, head.geometry);
        const double depth = head.shapes.innerSkull.depthMm(p);
        if (isInSulcus(p, head)) t1[n] = 30;
        if (depth > 0) t2[n] = depth < 2 || isInSulcus(p, head) ? 200 : 100;
    }
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    const auto isTold = [](const HeadBoundaries& found) {
        return std::any_of(found.warnings.begin(), found.warnings.end(),
                           [](const Warning& warning) { return warning.code == "t2-weighted"; });
    };
    EXPECT_FALSE(isTold(boundariesFromT1({t1.data(), head.geometry}, std::nullopt, options)));
    const HeadBoundaries found =
        boundariesFromT1({t2.data(), head.geometry}, std::nullopt, options);
    EXPECT_TRUE(isTold(found));
    // CSF is bright, so the inner skull itself is seen; voxels have 2 mm
    EXPECT_LE(surfaceError(found.solids[0], head.shapes.innerSkull).largestMm, 3);
    options.innerSurfaces = 1;
    EXPECT_THROW(boundariesFromT1({t2.data(), head.geometry}, std::nullopt, options), InvalidInput);
}

TEST(BoundariesFromT1, ModelAnInfantByItsAgeAndNameItWithout) {
    // 589 cm3, as at three months; bone of 2.5 mm from 2.5 to 5 mm below the skin, the brain at 6
    const HeadShapes infant = sphericalHead({1, -2, 3}, 52, 54.5, 57);
    const ImageGeometry geometry = centredGeometry({128, 128, 128}, {1, 1, 1});
    const std::vector<float> t1 = headT1(infant, 1, geometry);
    const VolumeView view(t1.data(), geometry);
    BoundaryOptions options;
    options.csfMm = 1;
    try {
        boundariesFromT1(view, std::nullopt, options);
        ADD_FAILURE() << "taken for an adult's";
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("--age"), std::string::npos) << error.what();
    }
    options.ageYears = 0.25;
    const HeadBoundaries found = boundariesFromT1(view, std::nullopt, options);
    // voxels of 1 mm, two tissues within each
    EXPECT_LE(surfaceError(found.solids[0], infant.innerSkull).largestMm, 1.5);
    EXPECT_LE(surfaceError(found.solids[1], infant.outerSkull).largestMm, 1.5);
    EXPECT_LE(surfaceError(found.solids[2], infant.skin).largestMm, 1);
    ASSERT_EQ(found.warnings.size(), 1u);
    EXPECT_EQ(found.warnings.front().code, "guessed-brain");
}

TEST(BoundariesFromT1, SeeAnInfantsSkullOutsideAnInnerSkullThatIsTooWide) {
    const HeadShapes infant = sphericalHead({1, -2, 3}, 52, 54.5, 57);
    const ImageGeometry geometry = centredGeometry({128, 128, 128}, {1, 1, 1});
    const std::vector<float> t1 = headT1(infant, 1, geometry);
    BoundaryOptions options;
    options.ageYears = 0.25;
    options.minScalpMm = 0.5;
    const auto isUnseen = [&](double brainMm) {
        std::vector<std::uint8_t> mask;
        for (const float part : partInside(sphere({1, -2, 3}, brainMm), geometry)) {
            mask.push_back(part >= 0.5 ? 1 : 0);
        }
        const HeadBoundaries found =
            boundariesFromT1({t1.data(), geometry}, VolumeView(mask.data(), geometry), options);
        return std::any_of(found.warnings.begin(), found.warnings.end(),
                           [](const Warning& warning) { return warning.code == "skull-unseen"; });
    };
    // with 2 mm of CSF, where there is room, the inner skull has 51.7, 53.7 and 55.2 mm
    EXPECT_FALSE(isUnseen(49.7));
    EXPECT_FALSE(isUnseen(51.7));  // 0.8 mm of bone outside
    try {
        EXPECT_TRUE(isUnseen(55.2));  // none
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("skull shows on"), std::string::npos);
    }
}

TEST(BoundariesFromT1, TakeRodsBesideTheHeadForNoNoiseOfTheAir) {
    // fluid of a stereotactic frame, brighter than the scalp: 4 standard deviations above the air's
    // mean once lay above the scalp
    const LargeHead head;
    const std::vector<float> bare = headT1(head.shapes, 2, head.geometry);
    std::vector<float> framed = bare;
    for (std::int64_t n = 0; n < std::ssize(framed); ++n) {
        const Vec3 p = placeOf(n, head.geometry);
        for (const double x : {-86.0, 86.0}) {
            for (const double y : {-86.0, 86.0}) {
                if (box({x, y, 10}, {6, 6, 70}).depthMm(p) > 0) framed[n] = 400;
            }
        }
    }
    const HeadBoundaries found =
        boundariesFromT1({framed.data(), head.geometry}, std::nullopt, {.stepMm = 2});
    const HeadBoundaries expected =
        boundariesFromT1({bare.data(), head.geometry}, std::nullopt, {.stepMm = 2});
    for (std::size_t n = 0; n < 3; ++n) {
        double off = 0;
        for (std::size_t v = 0; v < found.solids[n].part.size(); ++v) {
            off += std::abs(found.solids[n].part[v] - expected.solids[n].part[v]);
        }
        EXPECT_LE(off * 8 / 1000, 10) << n;  // cm3 of 1300 and more
    }
    EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), [](const std::string& note) {
        return note.find("beside the head") != std::string::npos;
    }));
    EXPECT_TRUE(std::none_of(
        expected.notes.begin(), expected.notes.end(),
        [](const std::string& note) { return note.find("beside") != std::string::npos; }));
}

TEST(BoundariesFromT1, RefuseAStrippedImageByNameOnAnyBackground) {
    const LargeHead head;
    const std::vector<float> whole = headT1(head.shapes, 2, head.geometry);
    for (const float background : {0.0F, 40.0F, 99.0F, 250.0F}) {
        std::vector<float> stripped = whole;
        for (std::int64_t n = 0; n < std::ssize(stripped); ++n) {
            const Vec3 p = placeOf(n, head.geometry);
            if (head.shapes.innerSkull.depthMm(p) < 1) stripped[n] = background;
            if (isInSulcus(p, head)) stripped[n] = 30;
        }
        try {
            boundariesFromT1({stripped.data(), head.geometry}, std::nullopt, {.stepMm = 2});
            ADD_FAILURE() << background;
        } catch (const InvalidInput& error) {
            EXPECT_NE(std::string(error.what()).find("skull-stripped"), std::string::npos)
                << background << ": " << error.what();
        }
    }
}

TEST(BoundariesFromT1, TakeAFaceThatWasTakenOutForTheImagesEnd) {
    // a plane 5 mm in front of the brain, zero beyond it; air has a little noise elsewhere
    const LargeHead head;
    std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    std::uint64_t seed = 5;
    for (float& value : t1) value += 1 + static_cast<float>(nextRandom(seed) % 4);
    constexpr double kCutMm = -4 - 71;
    const auto isCut = [](const Vec3& p) { return p.y < kCutMm && p.z < 40; };
    std::int64_t n = 0;
    for (std::int64_t k = 0; k < 96; ++k) {
        for (std::int64_t j = 0; j < 96; ++j) {
            for (std::int64_t i = 0; i < 96; ++i, ++n) {
                const Vec3 p = head.geometry.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                if (isCut(p)) t1[n] = 0;
            }
        }
    }
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    const HeadBoundaries found =
        boundariesFromT1({t1.data(), head.geometry}, std::nullopt, options);
    EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), [](const std::string& note) {
        return note.find("are cut") != std::string::npos;
    }));
    // the brain is found as if nothing were missing: it is not taken for a leak to the skin
    EXPECT_LE(surfaceError(found.solids[0], head.shapes.innerSkull).largestMm, 2.0);
    // the skin is where the image ends, and nobody says that it was seen there, but for the rim
    const double rimMm = std::sqrt(81.0 * 81 - 71.0 * 71);
    const auto isWithinCut = [&](const Vec3& p) {
        return p.y < 0 && p.z < 34 && std::hypot(p.x - 3, p.z - 8) < rimMm - 4;
    };
    for (const Vec3& p : surfaceOf(found.solids[2]).points) {
        if (!isWithinCut(p)) continue;
        // the least skull and scalp in front of the inner skull, in voxels of 2 mm
        EXPECT_NEAR(p.y, kCutMm, 5.5) << p.x << " " << p.z;
    }
    std::int64_t elsewhere = 0;
    for (const Vec3& place : found.seenMm[2]) {
        EXPECT_FALSE(isWithinCut(place)) << place.x << " " << place.y << " " << place.z;
        if (place.y > 0) ++elsewhere;
    }
    EXPECT_GE(elsewhere, 1000);
}

/// A wavy surface around the brain of the phantom: sulci along z.
Shape wavy(const Vec3& centre, double radiusMm, double depthMm) {
    Shape shape;
    shape.depthMm = [=](const Vec3& p) {
        const Vec3 d = p - centre;
        const double turns = std::cos(12 * std::atan2(d.y, d.x)) * std::hypot(d.x, d.y) / radiusMm;
        return radiusMm - depthMm * (1 - turns) / 2 - norm(d);
    };
    return shape;
}

TEST(BoundariesFromT1, FindTheBrainsOwnSurface) {
    const LargeHead head;
    const Shape brain = wavy({3, -4, 8}, 66, 4);
    std::vector<float> t1 = headT1(head.shapes, 0, head.geometry);
    const std::vector<float> part = partInside(brain, head.geometry);
    const std::vector<float> cavity = partInside(head.shapes.innerSkull, head.geometry);
    constexpr float kCsf = 30, kBrain = 100;
    for (std::size_t n = 0; n < t1.size(); ++n) {
        if (cavity[n] == 1) t1[n] = kCsf + part[n] * (kBrain - kCsf);
    }
    std::vector<std::uint8_t> mask(t1.size()), aseg(t1.size());
    for (std::size_t n = 0; n < t1.size(); ++n) {
        mask[n] = cavity[n] == 1 ? 1 : 0;
        // 3 cortex, 24 CSF around it, 258 outside of the head's brain would be
        aseg[n] = mask[n] == 0 ? 0 : part[n] >= 0.5f ? 3 : 24;
    }
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    options.innerSurfaces = 1;
    options.sulciMm = 2;
    BrainSources byMask, byLabels, byPial;
    byMask.mask = VolumeView(mask.data(), head.geometry);
    byLabels.aseg = VolumeView(aseg.data(), head.geometry);
    byPial.mask = byMask.mask;
    byPial.pial = {surfaceOf({head.geometry, part})};
    for (const BrainSources* sources : {&byMask, &byLabels, &byPial}) {
        const HeadBoundaries found =
            boundariesFromT1({t1.data(), head.geometry}, *sources, options);
        ASSERT_EQ(found.solids.size(), 4u);
        const SurfaceError error = surfaceError(found.solids[0], brain);
        EXPECT_LE(error.largestMm, 3.0);  // a voxel of 2 mm, and what the Gaussian takes of a crest
        EXPECT_LE(std::abs(error.meanMm), 1.0);  // half a voxel
    }
}

TEST(BoundariesFromT1, RefuseAPialSurfaceOfAnotherSpace) {
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    BoundaryOptions options;
    options.stepMm = 2;
    options.innerSurfaces = 1;
    BrainSources sources;
    sources.pial = {icosphere(2, {3, -4, 8}, 12)};  // 7 cm3
    expectRefused(
        [&] {
            boundariesFromT1({t1.data(), head.geometry}, sources, options);
        },
        "a pial surface encloses");
}

TEST(BoundariesFromCt, RefuseFourLayers) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<float> ct = headCt(head, geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 1;
    expectRefused([&] { boundariesFromCt({ct.data(), geometry}, options); }, "a CT does not show");
}

TEST(BoundariesFromT1, TakeABrainMaskOnAnotherGridAndASkullStrippedImage) {
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    BoundaryOptions options;
    options.stepMm = 2;
    options.innerSkullOnly = true;
    const Shape brain = sphere({3, -4, 8}, 66);
    const ImageGeometry other = obliqueGeometry({80, 80, 60}, {2.5, 2.5, 3});
    std::vector<std::uint8_t> mask;
    for (const float part : partInside(brain, other)) mask.push_back(part >= 0.5 ? 1 : 0);
    const HeadBoundaries byMask =
        boundariesFromT1({t1.data(), head.geometry}, VolumeView(mask.data(), other), options);
    EXPECT_LE(surfaceError(byMask.solids[0], head.shapes.innerSkull).largestMm, 2.5);  // a voxel

    std::vector<float> stripped = t1;
    const std::vector<float> inBrain = partInside(brain, head.geometry);
    for (std::size_t n = 0; n < stripped.size(); ++n)
        stripped[n] *= inBrain[n] >= 0.5 ? 1.0f : 0.0f;
    const HeadBoundaries byImage = boundariesFromT1(
        {t1.data(), head.geometry}, VolumeView(stripped.data(), head.geometry), options);
    EXPECT_LE(surfaceError(byImage.solids[0], head.shapes.innerSkull).largestMm, 2.5);
}

TEST(BoundariesFromT1, RefuseWhatIsNoHead) {
    const ImageGeometry geometry = centredGeometry({40, 40, 40});
    const std::vector<float> flat(64000, 7), ball = partInside(sphere({}, 15), geometry);
    expectRefused([&] { boundariesFromT1({flat.data(), geometry}, std::nullopt); }, "no head");
    expectRefused(
        [&] {
            boundariesFromT1({ball.data(), geometry}, std::nullopt);
        },
        "mm thick; a head is 80 mm or more");
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    const std::vector<std::uint8_t> empty(64000, 0), ones(64000, 1);
    const VolumeView view(t1.data(), head.geometry);
    BoundaryOptions options;
    options.stepMm = 3;
    expectRefused([&] { boundariesFromT1(view, VolumeView(empty.data(), geometry), options); },
                  "the brain mask is empty");
    ImageGeometry away = geometry;
    away.originMm.x = 500;
    expectRefused([&] { boundariesFromT1(view, VolumeView(ones.data(), away), options); },
                  "lies outside the head's image");
}

TEST(BoundariesFromT1, RefuseAMaskThatIsNoBrainsOrLiesElsewhere) {
    const LargeHead head;
    const std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    const VolumeView view(t1.data(), head.geometry);
    BoundaryOptions options;
    options.stepMm = 3;
    const auto tryMask = [&](const Shape& brain) {
        std::vector<std::uint8_t> mask;
        for (const float part : partInside(brain, head.geometry)) mask.push_back(part >= 0.5);
        boundariesFromT1(view, VolumeView(mask.data(), head.geometry), options);
    };
    EXPECT_NO_THROW(tryMask(sphere({3, -4, 8}, 66)));
    expectRefused([&] { tryMask(sphere({}, 200)); }, "must be 200 to 2500 cm3");
    expectRefused([&] { tryMask(sphere({3, -4, 8}, 30)); }, "must be 200 to 2500 cm3");
    // the skin lies at 81 mm: 30 mm to the right, a brain of 66 mm comes out of it
    expectRefused([&] { tryMask(sphere({33, -4, 8}, 66)); }, "in the same space?");
}

TEST(BoundariesFromT1, TakeAMaskThatLiesInTissueAtTheBaseAlone) {
    const LargeHead head;
    // no dark band in the lower third, as with muscle at the temporal poles: a right mask all the
    // same, and no cause for a better one
    HeadShapes boneless = head.shapes;
    boneless.outerSkull = boneless.innerSkull;
    const std::vector<float> bright = headT1(boneless, 0, head.geometry);
    BoundaryOptions options;
    options.stepMm = 3;
    const auto warningsWith = [&](double brightBelowZ, double maskMm) {
        std::vector<std::uint8_t> mask;
        for (const float part : partInside(sphere({3, -4, 8}, maskMm), head.geometry)) {
            mask.push_back(part >= 0.5);
        }
        std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
        for (std::int64_t n = 0; n < std::ssize(t1); ++n) {
            if (placeOf(n, head.geometry).z < brightBelowZ) t1[n] = std::min(bright[n], 100.0f);
        }
        return boundariesFromT1({t1.data(), head.geometry}, VolumeView(mask.data(), head.geometry),
                                options)
            .warnings;
    };
    EXPECT_TRUE(warningsWith(-12, 66).empty());
    // a mask 5 mm smaller than the brain is too small all round
    const std::vector<Warning> warnings = warningsWith(-100, 60);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "brain-doubtful");
    EXPECT_NE(warnings[0].text.find("the brain mask may be too small"), std::string::npos);
}

TEST(BoundariesFromT1, RefuseASkullStrippedImageByName) {
    const LargeHead head;
    std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    const std::vector<float> inner = partInside(head.shapes.innerSkull, head.geometry);
    for (std::size_t n = 0; n < t1.size(); ++n) t1[n] *= inner[n];
    const VolumeView stripped(t1.data(), head.geometry);
    BoundaryOptions options;
    options.stepMm = 3;
    const std::string message = "no skull or skin around the brain (a skull-stripped T1)";
    expectRefused([&] { boundariesFromT1(stripped, std::nullopt, options); }, message);
    // also with itself as the mask: there is no skin to find
    expectRefused([&] { boundariesFromT1(stripped, stripped, options); }, message);
}

TEST(BoundariesFromCt, RefuseGreyValuesThatAreNotHounsfieldUnits) {
    const LargeHead head;
    std::vector<float> ct = headCt(head.shapes, head.geometry);
    for (float& value : ct) value = 255.0f * (value + 1000) / 2000;  // -1000 to 1000: 0 to 255
    BoundaryOptions options;
    options.stepMm = 3;
    expectRefused(
        [&] {
            boundariesFromCt({ct.data(), head.geometry}, options);
        },
        "the samples lie in 0 to 255 and are not in Hounsfield units");
}

TEST(BoundariesFromT1, TellWhenTheSkullIsHardlySeen) {
    const LargeHead head;
    // no dark band on one side: the skull as bright as the brain
    HeadShapes boneless = head.shapes;
    boneless.outerSkull = boneless.innerSkull;
    std::vector<float> t1 = headT1(boneless, 0, head.geometry);
    const std::vector<float> whole = headT1(head.shapes, 2, head.geometry);
    for (std::int64_t n = 0; n < std::ssize(t1); ++n) {
        t1[n] = placeOf(n, head.geometry).x < -3 ? whole[n] : std::min(t1[n], 100.0f);
    }
    std::vector<std::uint8_t> mask;
    for (const float part : partInside(sphere({3, -4, 8}, 66), head.geometry)) {
        mask.push_back(part >= 0.5);
    }
    BoundaryOptions options;
    options.stepMm = 3;
    const HeadBoundaries found = boundariesFromT1({t1.data(), head.geometry},
                                                  VolumeView(mask.data(), head.geometry), options);
    ASSERT_EQ(found.warnings.size(), 3u);
    EXPECT_NE(found.warnings[2].text.find("cm2 in one piece"), std::string::npos);
    EXPECT_NE(found.warnings[0].text.find("as bright as brain"), std::string::npos);
    EXPECT_NE(found.warnings[1].text.find("skull shows on only"), std::string::npos);
    // on no side: a stripped image, or as good as one
    t1 = headT1(boneless, 0, head.geometry);
    for (float& value : t1) value = std::min(value, 100.0f);
    EXPECT_THROW(boundariesFromT1({t1.data(), head.geometry},
                                  VolumeView(mask.data(), head.geometry), options),
                 InvalidInput);
}

TEST(BoundariesFromT1, SinglePointsThatAreNoTissueChangeLittle) {
    const LargeHead head;
    std::vector<float> t1 = headT1(head.shapes, 2, head.geometry);
    BoundaryOptions options;
    options.stepMm = 3;
    options.innerSkullOnly = true;
    const auto innerSkull = [&] {
        return boundariesFromT1({t1.data(), head.geometry}, std::nullopt, options).solids[0];
    };
    const SurfaceError before = surfaceError(innerSkull(), head.shapes.innerSkull);
    t1[5] = std::numeric_limits<float>::infinity();
    t1[77] = -1e30f;
    const Index3& size = head.geometry.size;
    t1[size[0] / 2 + size[0] * (size[1] / 2 + size[1] * (size[2] / 2))] = 1e30f;  // in the brain
    for (std::size_t n = 90; n < 9000; n += 7) t1[n] = std::numeric_limits<float>::quiet_NaN();
    const SurfaceError after = surfaceError(innerSkull(), head.shapes.innerSkull);
    EXPECT_NEAR(after.meanMm, before.meanMm, 0.1);  // a spike is filled as a hole would be
    EXPECT_NEAR(after.largestMm, before.largestMm, 0.5);
}

TEST(BoundariesFromCt, FindSkinBoneAndCavityOfAPhantom) {
    const LargeHead head;
    HeadShapes shapes = head.shapes;
    // a hole of radius 12 at the bottom of the skull, filled with soft tissue
    const Shape bone = shapes.outerSkull;
    std::vector<float> ct = headCt(shapes, head.geometry);
    for (std::int64_t n = 0; n < std::ssize(ct); ++n) {
        const Vec3 p =
            head.geometry.toPhysical({static_cast<double>(n % 96), static_cast<double>(n / 96 % 96),
                                      static_cast<double>(n / (96 * 96))});
        if (p.z < 0 && std::hypot(p.x - 3, p.y + 4) < 12 && ct[n] > 40) ct[n] = 40;
    }
    BoundaryOptions options;
    options.stepMm = 2;
    options.smoothingMm = 2;
    const HeadBoundaries found = boundariesFromCt({ct.data(), head.geometry}, options);
    const double holeTop = 8 - std::sqrt(68.0 * 68 - 16 * 16);
    for (int n = 0; n < 2; ++n) {
        const Shape& truth = n == 0 ? shapes.innerSkull : shapes.outerSkull;
        for (const Vec3& p : surfaceOf(found.solids[n]).points) {
            if (p.z < holeTop + 6) continue;  // around the hole nothing is promised
            // a voxel less what partial volume gives back; bone at 300 of 1000 HU lies 0.4 mm out
            ASSERT_LE(std::abs(truth.depthMm(p)), 1.5) << n << " z " << p.z;
        }
    }
    for (const double gap : gapsOf(found)) EXPECT_GE(gap, 2 - 2);

    options.skinHu = 2000;
    expectRefused(
        [&] {
            boundariesFromCt({ct.data(), head.geometry}, options);
        },
        "skin at 2000 HU and bone at 300 HU");
    options = {};
    options.stepMm = 2;
    options.skullHu = 5000;
    expectRefused(
        [&] {
            boundariesFromCt({ct.data(), head.geometry}, options);
        },
        "nothing in the head is above 5000 HU");
}

TEST(BoundariesFromCt, TakeOffAHeadRestThatTouchesAndLeaveWiresAndCushionOut) {
    const LargeHead head;
    const ImageGeometry& geometry = head.geometry;
    std::vector<float> ct = headCt(head.shapes, geometry);
    BoundaryOptions options;
    options.stepMm = 2;
    const HeadBoundaries plain = boundariesFromCt({ct.data(), geometry}, options);
    // a trough of 8 mm, of plastic, in which the back of the head lies; a cushion of foam in it;
    // a wire of 2 mm along the head; all of it no head
    for (std::int64_t n = 0; n < std::ssize(ct); ++n) {
        const Vec3 p =
            geometry.toPhysical({static_cast<double>(n % 96), static_cast<double>(n / 96 % 96),
                                 static_cast<double>(n / (96 * 96))});
        const double across = std::hypot(p.x - 3, p.y - (77 - 94));
        const bool isBack = p.y > -10 && p.z > -70 && p.z < 70;
        if (ct[n] > -900) continue;
        if (isBack && across > 94 && across < 102) ct[n] = 120;
        if (isBack && across > 88 && across <= 94) ct[n] = -850;
        if (std::hypot(p.x - 60, p.y + 70) < 2) ct[n] = 3000;
    }
    const HeadBoundaries found = boundariesFromCt({ct.data(), geometry}, options);
    const auto isTold = [](const std::string& note) {
        return note.find("was taken off (a head rest?)") != std::string::npos;
    };
    EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), isTold));
    EXPECT_TRUE(std::none_of(plain.notes.begin(), plain.notes.end(), isTold));
    // of the trough only the strip that touches stays: 8 mm thick, where the gap is below 4 mm
    for (const Vec3& p : surfaceOf(found.solids[2]).points) {
        const double outside = -head.shapes.skin.depthMm(p);
        ASSERT_LE(outside, 11) << p.x << ' ' << p.y << ' ' << p.z;
        if (p.y < 40 && p.z > -30) {
            ASSERT_LE(outside, 6) << p.x << ' ' << p.y << ' ' << p.z;  // ears are closed against
        }
    }
    for (int n = 0; n < 2; ++n) {
        double most = 0;
        for (const Vec3& p : surfaceOf(found.solids[n]).points) {
            if (p.z < -30) continue;
            const Shape& truth = n == 0 ? head.shapes.innerSkull : head.shapes.outerSkull;
            most = std::max(most, std::abs(truth.depthMm(p)));
        }
        EXPECT_LE(most, 2.5) << n;  // a voxel, and the smoothing
    }
}

}  // namespace
}  // namespace adaptiso
