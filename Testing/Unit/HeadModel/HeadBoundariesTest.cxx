#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "HeadPhantoms.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

using namespace testing;

constexpr Vec3 kCentre{2.3, -1.4, 0.7};

/// A head of a third of the usual size, so that tests are quick: what is tested scales.
HeadShapes smallHead() {
    return sphericalHead(kCentre, 26, 30, 35);
}

BoundaryOptions quick() {
    BoundaryOptions options;
    options.closingMm = 5;
    return options;
}

TissueLabels numbered() {
    return {{1}, {2}, {3}, false};
}

double largestError(const HeadBoundaries& head, const HeadShapes& truth) {
    return std::max({surfaceError(head.solids[0], truth.innerSkull).largestMm,
                     surfaceError(head.solids[1], truth.outerSkull).largestMm,
                     surfaceError(head.solids[2], truth.skin).largestMm});
}

/// Least distance from the surface of each solid to that of the next, mm.
std::vector<double> gapsOf(const HeadBoundaries& head) {
    std::vector<double> gaps;
    for (std::size_t n = 0; n + 1 < head.solids.size(); ++n) {
        const NestingReport nesting =
            checkNesting(surfaceOf(head.solids[n]), surfaceOf(head.solids[n + 1]));
        EXPECT_TRUE(nesting.isStrictlyNested());
        gaps.push_back(nesting.gap.nearest.distanceMm);
    }
    return gaps;
}

void expectRefused(const std::function<void()>& call, const std::string& message) {
    try {
        call();
        ADD_FAILURE() << "should say: " << message;
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
}

TEST(BoundariesFromLabels, FindBinarySpheresToAThirdOfAVoxelInEveryGeometry) {
    const HeadShapes head = smallHead();
    const Index3 size{84, 84, 84};
    for (const ImageGeometry& geometry :
         {centredGeometry(size), obliqueGeometry(size, {1, 1, 1}),
          mirroredGeometry(size, {1, 1, 1}), shearedGeometry({84, 110, 84}, {1, 1, 1})}) {
        const std::vector<std::uint8_t> labels = headLabels(head, geometry);
        const HeadBoundaries found =
            boundariesFromLabels({labels.data(), geometry}, numbered(), quick());
        ASSERT_EQ(found.solids.size(), 3u);
        // flat caps of a binary sphere lie up to half a voxel off and are wider than the Gaussian;
        // it takes about a third off, and moves the surface by 1.5^2 / 26 = 0.09 mm
        EXPECT_LE(largestError(found, head), 0.5);
        EXPECT_NEAR(surfaceError(found.solids[0], head.innerSkull).meanMm, -2.25 / 26, 0.05);
    }
}

TEST(BoundariesFromLabels, FindSpheresInThickSlices) {
    const HeadShapes head = smallHead();
    for (const ImageGeometry& geometry : {centredGeometry({160, 160, 30}, {0.5, 0.5, 2.7}),
                                          obliqueGeometry({84, 84, 40}, {1, 1, 2})}) {
        const std::vector<std::uint8_t> labels = headLabels(head, geometry);
        const HeadBoundaries found =
            boundariesFromLabels({labels.data(), geometry}, numbered(), quick());
        // half a slice at the poles
        EXPECT_LE(largestError(found, head), 0.5 * geometry.spacingMm().z + 0.1);
        EXPECT_EQ(norm(found.solids[0].grid.indexToPhysical.column[2]), 1);
    }
}

TEST(BoundariesFromLabels, FillHolesAndDropIslands) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    std::vector<std::uint8_t> labels = headLabels(head, geometry);
    const Shape island = sphere({-38, -38, -38}, 2), hole = sphere(kCentre, 8);
    const Shape tunnel = box(kCentre + Vec3{0, 0, 30}, {1, 1, 8});
    for (std::int64_t n = 0; n < std::ssize(labels); ++n) {
        const Vec3 p =
            geometry.toPhysical({static_cast<double>(n % 84), static_cast<double>(n / 84 % 84),
                                 static_cast<double>(n / (84 * 84))});
        if (island.depthMm(p) > 0) labels[n] = 3;
        if (hole.depthMm(p) > 0 || tunnel.depthMm(p) > 0) labels[n] = 0;
    }
    const HeadBoundaries found =
        boundariesFromLabels({labels.data(), geometry}, numbered(), quick());
    // the tunnel's mouth leaves a dent less deep than it is wide
    EXPECT_LE(largestError(found, head), 1.0);
}

TEST(BoundariesFromLabels, ThickenAThinSkullAndScalp) {
    // skull 1 mm, scalp 0.6 mm
    const HeadShapes head = sphericalHead(kCentre, 26, 27, 27.6);
    const ImageGeometry geometry = centredGeometry({80, 80, 80}, {0.8, 0.8, 0.8});
    const std::vector<std::uint8_t> labels = headLabels(head, geometry);
    BoundaryOptions options = quick();
    options.minSkullMm = 3;
    options.minScalpMm = 2;
    const std::vector<double> gaps =
        gapsOf(boundariesFromLabels({labels.data(), geometry}, numbered(), options));
    // to about a voxel, as promised: the meshes see to the rest
    EXPECT_GE(gaps[0], 3 - 0.8);
    EXPECT_GE(gaps[1], 2 - 0.8);
    EXPECT_LE(gaps[0], 3 + 0.8);
}

TEST(BoundariesFromLabels, ClosedWhereTheHeadMeetsTheBorderOfTheImage) {
    // the image ends at z = -17: the head is cut there
    ImageGeometry geometry = centredGeometry({84, 84, 60});
    geometry.originMm.z = -17;
    const HeadShapes head = smallHead();
    const std::vector<std::uint8_t> labels = headLabels(head, geometry);
    const HeadBoundaries found =
        boundariesFromLabels({labels.data(), geometry}, numbered(), quick());
    const TriangleMesh skin = surfaceOf(found.solids[2]);
    const TriangleMesh inner = surfaceOf(found.solids[0]);
    // the inner skull ends half a voxel beyond the last sample, the skin has both gaps below, each
    // with half a voxel for what smoothing takes
    EXPECT_NEAR(boundingBox(inner).minimum.z, -17.5, 0.6);
    EXPECT_NEAR(boundingBox(skin).minimum.z, -17.5 - 5, 0.8);
    for (const double gap : gapsOf(found)) EXPECT_GE(gap, 2 - 1);
}

TEST(BoundariesFromLabels, OneSurfaceForMeg) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = headLabels(head, geometry);
    BoundaryOptions options = quick();
    options.innerSkullOnly = true;
    const HeadBoundaries found =
        boundariesFromLabels({labels.data(), geometry}, {{1}, {}, {}, false}, options);
    ASSERT_EQ(found.solids.size(), 1u);
    EXPECT_LE(surfaceError(found.solids[0], head.innerSkull).largestMm, 0.5);
}

TEST(BoundariesFromLabels, SameBytesForEveryRun) {
    const ImageGeometry geometry = obliqueGeometry({60, 60, 40}, {1.2, 1.2, 2});
    const std::vector<std::uint8_t> labels = headLabels(smallHead(), geometry);
    const VolumeView view(labels.data(), geometry);
    const HeadBoundaries a = boundariesFromLabels(view, numbered(), quick());
    const HeadBoundaries b = boundariesFromLabels(view, numbered(), quick());
    for (int n = 0; n < 3; ++n) EXPECT_EQ(a.solids[n].part, b.solids[n].part);
}

TEST(BoundariesFromLabels, RefuseWhatCantBe) {
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = headLabels(smallHead(), geometry);
    const VolumeView view(labels.data(), geometry);
    expectRefused(
        [&] {
            boundariesFromLabels(view, {{9}, {2}, {3}, false}, quick());
        },
        "no label of the tissue brain");
    expectRefused(
        [&] {
            boundariesFromLabels(view, {{1}, {9}, {3}, false}, quick());
        },
        "no label of the tissue skull");
    expectRefused(
        [&] {
            boundariesFromLabels(view, {{1}, {2}, {9}, false}, quick());
        },
        "no label of the tissue scalp");
    expectRefused(
        [&] {
            boundariesFromLabels(view, {{1}, {1}, {3}, false}, quick());
        },
        "label 1 is named twice");
    BoundaryOptions options = quick();
    options.smoothingMm = std::numeric_limits<double>::quiet_NaN();
    expectRefused([&] { boundariesFromLabels(view, numbered(), options); }, "smoothingMm is nan");
    options = quick();
    options.maxSkullMm = 1;
    expectRefused([&] { boundariesFromLabels(view, numbered(), options); }, "maxSkullMm is 1 mm");
}

TEST(BoundariesFromLabels, RefuseTissuesInAnotherOrderThanTheyLie) {
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = headLabels(smallHead(), geometry);
    const auto inOrder = [&](std::int64_t brain, std::int64_t skull, std::int64_t scalp) {
        boundariesFromLabels({labels.data(), geometry}, {{brain}, {skull}, {scalp}, false},
                             quick());
    };
    EXPECT_NO_THROW(inOrder(1, 2, 3));
    for (const auto& [brain, skull, scalp] :
         {std::array{1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}}) {
        expectRefused([&] { inOrder(brain, skull, scalp); }, "named in the right order?");
    }
}

TEST(TissuePreset, NamesWhatItKnows) {
    EXPECT_EQ(tissuePreset("charm").skull, (std::vector<std::int64_t>{4, 7, 8}));
    EXPECT_EQ(tissuePreset("headreco").brain, (std::vector<std::int64_t>{1, 2, 3}));
    EXPECT_TRUE(tissuePreset("aseg").othersAreBrain);
    expectRefused([] { tissuePreset("freesurfer"); }, "none of charm, headreco, aseg");
}

TEST(TissuePreset, AsegTakesAllButSkullAndScalpForBrain) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    std::vector<std::int16_t> labels;
    for (const std::uint8_t label : headLabels(head, geometry)) {
        labels.push_back(label == 1   ? static_cast<std::int16_t>(2 + labels.size() % 40)
                         : label == 2 ? 165
                         : label == 3 ? 258
                                      : 0);
    }
    EXPECT_LE(
        largestError(boundariesFromLabels({labels.data(), geometry}, tissuePreset("aseg"), quick()),
                     head),
        0.5);
}

TEST(BoundariesFromProbabilities, FindPartialVolumeSpheresToATwentiethOfAVoxel) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = obliqueGeometry({84, 84, 84}, {1, 1, 1});
    const std::vector<float> inner = partInside(head.innerSkull, geometry);
    const std::vector<float> outer = partInside(head.outerSkull, geometry);
    const std::vector<float> skin = partInside(head.skin, geometry);
    std::vector<std::vector<std::uint8_t>> maps(5, std::vector<std::uint8_t>(inner.size()));
    for (std::size_t n = 0; n < inner.size(); ++n) {
        maps[0][n] = static_cast<std::uint8_t>(std::lround(100 * inner[n]));
        maps[1][n] = static_cast<std::uint8_t>(std::lround(105 * inner[n]));
        maps[2][n] = static_cast<std::uint8_t>(std::lround(50 * inner[n]));
        maps[3][n] = static_cast<std::uint8_t>(std::lround(255 * (outer[n] - inner[n])));
        maps[4][n] = static_cast<std::uint8_t>(std::lround(255 * (skin[n] - outer[n])));
    }
    std::vector<VolumeView> views;
    for (const auto& map : maps) views.emplace_back(map.data(), geometry);
    const HeadBoundaries found = boundariesFromProbabilities(views, quick());
    // besides the Gaussian's 1.5^2 / R: 0.09, 0.08, 0.06 mm
    EXPECT_LE(largestError(found, head), 0.09 + 0.06);
    EXPECT_NEAR(surfaceError(found.solids[2], head.skin).meanMm, -2.25 / 35, 0.02);

    expectRefused([&] { boundariesFromProbabilities(std::span(views).first(4), quick()); },
                  "there are 4 maps, must be 5 or more");
    views[3] = VolumeView(maps[3].data(), centredGeometry({84, 84, 84}));
    expectRefused([&] { boundariesFromProbabilities(views, quick()); }, "map 4 is on another grid");
}

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
    EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), [](const std::string& note) {
        return note.find("brain guessed") != std::string::npos;
    }));
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

TEST(BoundariesFromT1, TellWhenTheSkullIsHardlySeen) {
    const LargeHead head;
    // no dark band at all: the skull as bright as the brain
    HeadShapes boneless = head.shapes;
    boneless.outerSkull = boneless.innerSkull;
    std::vector<float> t1 = headT1(boneless, 0, head.geometry);
    for (float& value : t1) value = std::min(value, 100.0f);
    std::vector<std::uint8_t> mask;
    for (const float part : partInside(sphere({3, -4, 8}, 66), head.geometry)) {
        mask.push_back(part >= 0.5);
    }
    BoundaryOptions options;
    options.stepMm = 3;
    const HeadBoundaries found = boundariesFromT1({t1.data(), head.geometry},
                                                  VolumeView(mask.data(), head.geometry), options);
    ASSERT_EQ(found.warnings.size(), 1u);
    EXPECT_NE(found.warnings[0].find("skull shows on only"), std::string::npos);
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
        "skin at 2e+03 HU and bone at 300 HU");
    options = {};
    options.stepMm = 2;
    options.skullHu = 5000;
    expectRefused(
        [&] {
            boundariesFromCt({ct.data(), head.geometry}, options);
        },
        "nothing in the head is above 5e+03 HU");
}

TEST(BoundariesFromSurfaces, MendHolesCrossingsTurnedTrianglesAndStrayPieces) {
    const HeadShapes head = smallHead();
    const TriangleMesh inner = withHole(icosphere(4, kCentre, 26));
    TriangleMesh outer = merged({icosphere(4, kCentre, 30), icosphere(2, {40, 40, 40}, 2)});
    TriangleMesh skin = withFlippedTriangle(icosphere(4, kCentre, 35));
    flipOrientation(inner.triangles.empty() ? outer : skin);
    const std::vector<TriangleMesh> surfaces{inner, outer, skin};
    const HeadBoundaries found = boundariesFromSurfaces(surfaces, quick());
    // the hole's chord, a triangle of 4 mm, lies 0.1 mm deep; the Gaussian takes 0.09
    EXPECT_LE(largestError(found, head), 0.35);

    // two balls that cross: their union
    const TriangleMesh crossing =
        merged({icosphere(4, {-8, 0, 0}, 26), icosphere(4, {8, 0, 0}, 26)});
    BoundaryOptions one = quick();
    one.innerSkullOnly = true;
    const HeadBoundaries united = boundariesFromSurfaces(std::span(&crossing, 1), one);
    const BoundingBox box = boundingBox(surfaceOf(united.solids[0]));
    EXPECT_NEAR(box.minimum.x, -34, 0.3);
    EXPECT_NEAR(box.maximum.x, 34, 0.3);
}

TEST(BoundariesFromSurfaces, FillATunnelThatTheClosingCloses) {
    // a hole of 4 mm through the whole ball, genus 1
    const ImageGeometry geometry = centredGeometry({60, 60, 60});
    const Shape tunnel = box({0, 0, 0}, {2, 2, 40});
    Shape drilled = sphere({}, 25);
    drilled.depthMm = [=](const Vec3& p) { return std::min(25 - norm(p), -tunnel.depthMm(p)); };
    const TriangleMesh surface = surfaceOf({geometry, partInside(drilled, geometry)});
    ASSERT_EQ(*checkTopology(surface).genus(), 1);
    BoundaryOptions options = quick();
    options.innerSkullOnly = true;
    const HeadBoundaries found = boundariesFromSurfaces(std::span(&surface, 1), options);
    EXPECT_LE(surfaceError(found.solids[0], sphere({}, 25)).largestMm, 1.0);  // a voxel
}

TEST(BoundariesFromSurfaces, RefuseOtherNumbersAndUnits) {
    const std::vector<TriangleMesh> metres(3, icosphere(2, {}, 0.08));
    expectRefused([&] { boundariesFromSurfaces(metres, quick()); }, "(metres?)");
    expectRefused([&] { boundariesFromSurfaces(std::span(metres).first(2), quick()); },
                  "there are 2 surfaces, must be 3");
}

}  // namespace
}  // namespace adaptiso
