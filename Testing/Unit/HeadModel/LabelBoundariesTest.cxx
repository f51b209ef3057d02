#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "BoundaryTestSupport.h"
#include "Support/Meshes.h"

namespace adaptiso {
namespace {

using namespace testing;

TissueLabels numbered() {
    return {{1}, {2}, {3}, false};
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

/// smallHead() with a brain of 4 CSF voxels less than the inner skull: 4 brain, 1 CSF.
std::vector<std::uint8_t> fourTissues(const HeadShapes& head, const Shape& brain,
                                      const ImageGeometry& geometry) {
    std::vector<std::uint8_t> labels = headLabels(head, geometry);
    const std::vector<float> part = partInside(brain, geometry);
    for (std::size_t n = 0; n < labels.size(); ++n) {
        if (labels[n] == 1 && part[n] >= 0.5f) labels[n] = 4;
    }
    return labels;
}

TEST(BoundariesFromLabels, FindABrainWithinCsf) {
    const HeadShapes head = smallHead();
    const Shape brain = sphere(kCentre, 22);
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = fourTissues(head, brain, geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 1;
    const HeadBoundaries found =
        boundariesFromLabels({labels.data(), geometry}, {{4}, {2}, {3}, false, {1}}, options);
    ASSERT_EQ(found.solids.size(), 4u);
    // half a voxel, as of the other spheres
    EXPECT_LE(surfaceError(found.solids[0], brain).largestMm, 0.5);
    EXPECT_LE(surfaceError(found.solids[1], head.innerSkull).largestMm, 0.5);
    EXPECT_LE(surfaceError(found.solids[3], head.skin).largestMm, 0.5);

    // the three around it are those of three layers, to the bit
    const HeadBoundaries three =
        boundariesFromLabels({labels.data(), geometry}, {{4}, {2}, {3}, false, {1}}, quick());
    ASSERT_EQ(three.solids.size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
        EXPECT_EQ(three.solids[n].part, found.solids[n + 1].part);
    }
}

TEST(BoundariesFromLabels, LetTheBrainGiveWayToTheLeastCsf) {
    const HeadShapes head = smallHead();
    // touches the skull on one side
    const Shape brain = sphere(kCentre + Vec3{4, 0, 0}, 22);
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = fourTissues(head, brain, geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 1;
    options.minCsfMm = 2;
    const HeadBoundaries found =
        boundariesFromLabels({labels.data(), geometry}, {{4}, {2}, {3}, false, {1}}, options);
    // to about a voxel, as of the other layers
    EXPECT_GE(gapsOf(found).front(), 1.0);
    EXPECT_LE(surfaceError(found.solids[1], head.innerSkull).largestMm, 0.5);
}

TEST(BoundariesFromLabels, RefuseFourLayersWithoutCsf) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = headLabels(head, geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 1;
    expectRefused(
        [&] {
            boundariesFromLabels({labels.data(), geometry}, numbered(), options);
        },
        "no label of the tissue CSF");
    options.innerSkullOnly = true;
    expectRefused(
        [&] {
            boundariesFromLabels({labels.data(), geometry}, numbered(), options);
        },
        "one surface and four");
}

/// fourTissues() and in them white matter, 5, with a ventricle of 5 mm radius (CSF) that opens into
/// the brain by a door of 2 mm.
std::vector<std::uint8_t> fiveTissues(const HeadShapes& head, const Shape& brain,
                                      const Shape& white, const ImageGeometry& geometry) {
    std::vector<std::uint8_t> labels = fourTissues(head, brain, geometry);
    const std::vector<float> part = partInside(white, geometry);
    const std::vector<float> ventricle = partInside(sphere(kCentre, 5), geometry);
    const std::vector<float> door = partInside(box(kCentre + Vec3{0, 0, 10}, {1, 1, 12}), geometry);
    for (std::size_t n = 0; n < labels.size(); ++n) {
        if (part[n] < 0.5f) continue;
        labels[n] = ventricle[n] >= 0.5f || door[n] >= 0.5f ? 1 : 5;
    }
    return labels;
}

const TissueLabels kFive{{4}, {2}, {3}, false, {1}, {5}};

TEST(BoundariesFromLabels, FindWhiteMatterWithinTheBrain) {
    const HeadShapes head = smallHead();
    const Shape brain = sphere(kCentre, 22), white = sphere(kCentre, 16);
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    const std::vector<std::uint8_t> labels = fiveTissues(head, brain, white, geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 2;
    options.sulciMm = 0;  // the ventricle is filled all the same
    const HeadBoundaries found = boundariesFromLabels({labels.data(), geometry}, kFive, options);
    ASSERT_EQ(found.solids.size(), 5u);
    // half a voxel, as of the other spheres
    EXPECT_LE(surfaceError(found.solids[0], white).largestMm, 0.5);
    EXPECT_LE(surfaceError(found.solids[1], brain).largestMm, 0.5);

    // the four around it are those of four layers, to the bit
    options.innerSurfaces = 1;
    const HeadBoundaries four = boundariesFromLabels({labels.data(), geometry}, kFive, options);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(four.solids[n].part, found.solids[n + 1].part);
}

TEST(BoundariesFromLabels, LetTheWhiteMatterGiveWayToTheLeastGreyMatter) {
    const HeadShapes head = smallHead();
    const Shape brain = sphere(kCentre, 22);
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    // touches the brain's surface on one side
    const std::vector<std::uint8_t> labels =
        fiveTissues(head, brain, sphere(kCentre + Vec3{6, 0, 0}, 16), geometry);
    BoundaryOptions options = quick();
    options.innerSurfaces = 2;
    options.minGreyMm = 2;
    const HeadBoundaries found = boundariesFromLabels({labels.data(), geometry}, kFive, options);
    // to about a voxel, as of the other layers; the brain stays
    EXPECT_GE(gapsOf(found).front(), 1.0);
    EXPECT_LE(surfaceError(found.solids[1], brain).largestMm, 0.5);
}

TEST(BoundariesFromLabels, RefuseWhiteMatterInTwoPieces) {
    const HeadShapes head = smallHead();
    const ImageGeometry geometry = centredGeometry({84, 84, 84});
    std::vector<std::uint8_t> labels =
        fiveTissues(head, sphere(kCentre, 22), sphere(kCentre, 18), geometry);
    const std::vector<float> between = partInside(box(kCentre, {5, 40, 40}), geometry);
    for (std::size_t n = 0; n < labels.size(); ++n) {
        if (labels[n] == 5 && between[n] >= 0.5f) labels[n] = 4;
    }
    BoundaryOptions options = quick();
    options.innerSurfaces = 2;
    options.sulciMm = 1;  // else they are joined
    expectRefused(
        [&] {
            boundariesFromLabels({labels.data(), geometry}, kFive, options);
        },
        "the white matter is no single piece");
}

TEST(BoundariesFromLabels, KnowWhiteMatterOfEveryProgramThatHasIt) {
    for (const std::string& name : tissuePresetNames()) {
        EXPECT_EQ(tissuePreset(name).white.empty(), name == "totalsegmentator") << name;
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
    for (const auto& order : {std::array{1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}}) {
        expectRefused([&] { inOrder(order[0], order[1], order[2]); }, "named in the right order?");
    }
}

TEST(TissuePreset, NamesWhatItKnows) {
    EXPECT_EQ(tissuePreset("charm").skull, (std::vector<std::int64_t>{4, 7, 8}));
    EXPECT_EQ(tissuePreset("headreco").brain, (std::vector<std::int64_t>{2}));
    EXPECT_EQ(tissuePreset("headreco").white, (std::vector<std::int64_t>{1}));
    EXPECT_EQ(tissuePreset("headreco").csf, (std::vector<std::int64_t>{3}));
    EXPECT_TRUE(tissuePreset("aseg").othersAreBrain);
    EXPECT_EQ(tissuePreset("totalsegmentator").skull, (std::vector<std::int64_t>{91}));
    expectRefused([] { tissuePreset("freesurfer"); }, "'freesurfer' is no preset");
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

}  // namespace
}  // namespace adaptiso
