#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "BoundaryTestSupport.h"
#include "Necks.h"

namespace adaptiso {
namespace {

using namespace testing;
using namespace headmodel;

constexpr Vec3 kMiddle{3, -4, 8};
constexpr double kInnerMm = 68;
/// Where a foramen leaves the inner skull: 25 mm beside the axis, at the base.
constexpr Vec3 kForamen{28, -4, -55};

/// A tube with round ends.
Shape tube(const Vec3& from, const Vec3& to, double radiusMm) {
    Shape shape;
    shape.depthMm = [=](const Vec3& p) {
        const Vec3 along = to - from;
        const double at = std::clamp(dot(p - from, along) / squaredNorm(along), 0.0, 1.0);
        return radiusMm - norm(p - (from + at * along));
    };
    return shape;
}

Shape both(const Shape& a, const Shape& b) {
    Shape shape;
    shape.depthMm = [=](const Vec3& p) { return std::max(a.depthMm(p), b.depthMm(p)); };
    return shape;
}

/// A head of the usual size in 2 mm voxels, with a neck below, and `more` of an inner skull.
struct HeadWith {
    HeadShapes shapes;
    ImageGeometry geometry;
    BoundaryOptions options;

    explicit HeadWith(const Shape& more)
        : shapes(sphericalHead(kMiddle, kInnerMm, 74, 81)),
          geometry(centredGeometry({96, 96, 110}, {2, 2, 2})) {
        shapes.skin = both(shapes.skin, box({3, -10, -77}, {45, 50, 45}));
        shapes.innerSkull = both(shapes.innerSkull, more);
        options.stepMm = 2;
    }
    HeadBoundaries byLabels() const {
        const std::vector<std::uint8_t> labels = headLabels(shapes, geometry);
        return boundariesFromLabels({labels.data(), geometry}, {{1}, {2}, {3}, false}, options);
    }
    /// The brain mask ends 2 mm within the inner skull, also in the tube.
    HeadBoundaries byMask() const {
        const std::vector<float> t1 = headT1(shapes, 2, geometry);
        const Shape inner = shapes.innerSkull;
        Shape brain;
        brain.depthMm = [=](const Vec3& p) { return inner.depthMm(p) - 2; };
        std::vector<std::uint8_t> mask;
        for (const float part : partInside(brain, geometry)) mask.push_back(part >= 0.5 ? 1 : 0);
        return boundariesFromT1({t1.data(), geometry}, VolumeView(mask.data(), geometry), options);
    }
    /// Nobody says where the brain is.
    HeadBoundaries byGuess() const {
        const std::vector<float> t1 = headT1(shapes, 2, geometry);
        return boundariesFromT1({t1.data(), geometry}, std::nullopt, options);
    }
    /// The same head with nothing cut, of which only the inner skull is asked.
    HeadWith uncut() const {
        HeadWith head = *this;
        head.options.cutNecksMm = 0;
        head.options.innerSkullOnly = true;
        return head;
    }
};

HeadWith headWithForamen(double radiusMm) {
    // 26 mm beyond the inner skull
    return HeadWith(tube(kMiddle, kForamen - Vec3{0, 0, 26}, radiusMm));
}

/// How far the lowest vertex beside the foramen's axis lies below the inner skull's sphere, mm.
double tongueMm(const FractionField& solid) {
    double lowest = kForamen.z;
    for (const Vec3& p : surfaceOf(solid).points) {
        if (std::hypot(p.x - kForamen.x, p.y - kForamen.y) < 12) lowest = std::min(lowest, p.z);
    }
    return kForamen.z - lowest;
}

bool tells(const std::vector<std::string>& notes, const std::string& text) {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
        return note.find(text) != std::string::npos;
    });
}

/// The sphere itself lies lower by 5 mm at a distance of 12 mm towards the axis; a stub of 2 mm
/// stays, and voxels have 2 mm.
constexpr double kNoTongueMm = 5 + 2 + 2;

TEST(CutNecks, ATongueDownAForamenInALabelMap) {
    for (const double radiusMm : {3.0, 5.0}) {
        const HeadWith head = headWithForamen(radiusMm);
        const HeadBoundaries before = head.uncut().byLabels(), after = head.byLabels();
        EXPECT_GE(tongueMm(before.solids[0]), 22) << radiusMm;
        EXPECT_FALSE(tells(before.notes, "a neck of"));
        EXPECT_LE(tongueMm(after.solids[0]), kNoTongueMm) << radiusMm;
        EXPECT_TRUE(tells(after.notes, "inner skull: a neck of 2")) << radiusMm;
        // it does not stay as bone in the soft tissue of the neck: 6 mm of skull are the sphere's
        EXPECT_LE(tongueMm(after.solids[1]), kNoTongueMm + 6) << radiusMm;
        for (const double gap : gapsOf(after)) EXPECT_GE(gap, 2 - 2);  // to a voxel, as promised
    }
}

TEST(CutNecks, ATongueOfABrainMask) {
    const HeadWith head = headWithForamen(5);
    const HeadBoundaries before = head.uncut().byMask(), after = head.byMask();
    EXPECT_GE(tongueMm(before.solids[0]), 22);
    EXPECT_LE(tongueMm(after.solids[0]), kNoTongueMm);
    EXPECT_LE(tongueMm(after.solids[1]), kNoTongueMm + 8);
}

TEST(CutNecks, AGuessedBrainHasNoTongue) {
    // as bright as the brain, with CSF and bone around: what thresholds follow out of the head
    for (const double radiusMm : {4.0, 7.0}) {
        HeadWith head = headWithForamen(radiusMm);
        head.shapes.outerSkull =
            both(head.shapes.outerSkull, tube(kMiddle, kForamen - Vec3{0, 0, 29}, radiusMm + 4));
        EXPECT_LE(tongueMm(head.byGuess().solids[0]), kNoTongueMm) << radiusMm;
    }
}

TEST(CutNecks, FollowThePlaceAndLengthOfABentNeck) {
    const ImageGeometry grid = centredGeometry({120, 120, 120});
    const Vec3 knee{30, 0, -40}, end{52, 0, -40};
    const Shape solid = both(sphere({}, 40), both(tube({30, 0, 0}, knee, 4), tube(knee, end, 4)));
    Mask mask;
    for (const float part : partInside(solid, grid)) mask.push_back(part >= 0.5 ? 1 : 0);
    const std::vector<Neck> necks = findNecks(mask, grid, 8, 5);
    ASSERT_EQ(necks.size(), 1u);
    // it leaves the sphere at z = -26: 29 mm to the tip in a straight line, less 3 mm that the ball
    // gets into the closed corner; 14 down, 22 to the side and 4 of round end along the axis
    EXPECT_GE(necks[0].reachMm, 29 - 3);
    EXPECT_LE(necks[0].reachMm, 14 + 22 + 4);
    EXPECT_LE(norm(necks[0].tipMm - (end + Vec3{4, 0, 0})), 4);
    // a cylinder of that length, less the stub
    EXPECT_NEAR(necks[0].mm3, 3.14 * 16 * 36, 400);
}

TEST(CutNecks, LeaveAnHonestInnerSkullAsItIs) {
    // a posterior fossa, lobes' poles, a cord as wide as the foramen magnum, an optic recess
    const Shape fossa = sphere({3, 30, -40}, 42), leftPole = tube(kMiddle, {40, -40, -45}, 15),
                rightPole = tube(kMiddle, {-34, -40, -45}, 15),
                cord = tube(kMiddle, {3, 15, -95}, 11),
                recess = tube(kMiddle, kForamen - Vec3{0, 0, 6}, 4);
    const HeadWith head(both(both(fossa, recess), both(cord, both(leftPole, rightPole))));
    HeadWith withoutCuts = head;
    withoutCuts.options.cutNecksMm = 0;
    const HeadBoundaries off = withoutCuts.byLabels(), on = head.byLabels();
    EXPECT_EQ(off.solids[0].part, on.solids[0].part);
    EXPECT_FALSE(tells(on.notes, "a neck of"));
}

TEST(CutNecks, LeaveWhatIsCutToTheBoneOfACanal) {
    // bone of 12 mm around the tube, all the way down
    HeadWith head = headWithForamen(4);
    head.shapes.outerSkull =
        both(head.shapes.outerSkull, tube(kMiddle, kForamen - Vec3{0, 0, 30}, 12));
    const HeadBoundaries found = head.byLabels();
    EXPECT_LE(tongueMm(found.solids[0]), kNoTongueMm);
    // as far as bone counts as skull: 20 mm
    EXPECT_GE(tongueMm(found.solids[1]), 18);
    HeadWith solid{sphere(kMiddle, 1)};
    solid.shapes.outerSkull = head.shapes.outerSkull;
    const auto volume = [](const FractionField& field) {
        double sum = 0;
        for (const float part : field.part) sum += part;
        return sum * 8;
    };
    // no pit where the tube was, which would take 1300 mm3 from the bone; it may be longer by the
    // stub, and by what the ball leaves in the corner, from which its 20 mm are measured
    const double more = volume(found.solids[1]) - volume(solid.byLabels().solids[1]);
    EXPECT_GE(more, -300);
    EXPECT_LE(more, 3.14 * 144 * (2 + 5));
}

}  // namespace
}  // namespace adaptiso
