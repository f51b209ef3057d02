#include <gtest/gtest.h>

#include "Support/Soundness.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

using testing::expectSound;

/// Two unit cubes side by side along x, 3 and 7, that share the wall at x = 1.
LabelComplex twoCubes() {
    LabelComplex complex;
    for (int x = 0; x < 3; ++x) {
        for (int y = 0; y < 2; ++y) {
            for (int z = 0; z < 2; ++z) complex.points.push_back({1.0 * x, 1.0 * y, 1.0 * z});
        }
    }
    const auto quad = [&](VertexId a, VertexId b, VertexId c, VertexId d, Label from, Label into) {
        complex.triangles.push_back({a, b, c});
        complex.triangles.push_back({a, c, d});
        complex.labels.insert(complex.labels.end(), 2, {from, into});
    };
    for (int x = 0; x < 2; ++x) {
        const VertexId o = 4 * x;
        const Label label = x == 0 ? 3 : 7;
        quad(o + 0, o + 4, o + 5, o + 1, label, 0);  // y = 0
        quad(o + 2, o + 3, o + 7, o + 6, label, 0);  // y = 1
        quad(o + 0, o + 2, o + 6, o + 4, label, 0);  // z = 0
        quad(o + 1, o + 5, o + 7, o + 3, label, 0);  // z = 1
    }
    quad(0, 1, 3, 2, 3, 0);    // x = 0
    quad(8, 10, 11, 9, 7, 0);  // x = 2
    quad(4, 6, 7, 5, 3, 7);    // x = 1
    return complex;
}

TEST(RegionSurface, IsClosedAndOutwardOnBothSidesOfASharedWall) {
    const LabelComplex complex = twoCubes();
    for (const Label label : {3, 7}) {
        const TriangleMesh mesh = regionSurface(complex, label);
        expectSound(mesh);
        EXPECT_EQ(mesh.points.size(), 8U);
        EXPECT_DOUBLE_EQ(enclosedVolume(mesh), 1);
    }
    EXPECT_TRUE(regionSurface(complex, 5).triangles.empty());
}

TEST(MeasureRegions, GivesVolumeAreaAndContacts) {
    const std::vector<RegionMeasure> measures = measureRegions(twoCubes());
    ASSERT_EQ(measures.size(), 2U);
    EXPECT_EQ(measures[0].label, 3);
    EXPECT_EQ(measures[1].label, 7);
    for (const RegionMeasure& m : measures) {
        EXPECT_DOUBLE_EQ(m.volumeMm3, 1);
        EXPECT_DOUBLE_EQ(m.areaMm2, 6);
        EXPECT_EQ(m.vertices, 8);
        EXPECT_EQ(m.triangles, 12);
        EXPECT_EQ(m.eulerCharacteristic, 2);
        EXPECT_EQ(m.components, 1);
        ASSERT_EQ(m.neighbours.size(), 2U);
        EXPECT_EQ(m.neighbours[0], (RegionContact{0, 10, 5}));
        EXPECT_EQ(m.neighbours[1], (RegionContact{m.label == 3 ? 7 : 3, 2, 1}));
    }
    EXPECT_EQ(measureRegions(twoCubes(), {7}), std::vector<RegionMeasure>{measures[1]});
}

}  // namespace
}  // namespace adaptiso
