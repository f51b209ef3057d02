#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "Scene.h"
#include "Slices.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "SurfaceRenderer.h"

namespace adaptiso {
namespace {

double lengthOf(const std::vector<Segment>& segments) {
    double length = 0;
    for (const Segment& segment : segments) length += norm(segment[1] - segment[0]);
    return length;
}

SceneSurface asSeen(const TriangleMesh& mesh) {
    Report report;
    report.surfaces.push_back({"surface", {}});
    SceneSurface surface = makeScene(report).surfaces.front();
    surface.mesh = SceneMesh(mesh);
    return surface;
}

/// `ras` in a scene.
SceneMesh drawn(TriangleMesh ras) {
    for (Vec3& p : ras.points) p = lpsToRas(p);
    return SceneMesh(std::move(ras));
}

Rendering renderAlone(const SceneSurface& surface, const BoundingBox& box, const View& view,
                      int size) {
    const VertexNormals normals = vertexNormals(surface.mesh);
    return render({&surface, 1}, {&normals, 1}, box, view, size);
}

TEST(CutByPlane, CubeGivesItsPerimeter) {
    const SceneMesh cube = drawn(testing::cubeMesh({0, 0, 0}, {2, 3, 5}));
    // sums of a few lengths: some ulps
    EXPECT_NEAR(lengthOf(cutByPlane(cube, 2, 1.7)), 2 * (2 + 3), 1e-12);
    EXPECT_NEAR(lengthOf(cutByPlane(cube, 1, 1.7)), 2 * (2 + 5), 1e-12);
    EXPECT_NEAR(lengthOf(cutByPlane(cube, 0, 1.7)), 2 * (3 + 5), 1e-12);
}

TEST(CutByPlane, PlaneThroughCornersCountsThemAsAbove) {
    const SceneMesh cube = drawn(testing::cubeMesh({0, 0, 0}, {1, 1, 1}));
    EXPECT_TRUE(cutByPlane(cube, 2, 0).empty());  // the whole cube is above
    EXPECT_NEAR(lengthOf(cutByPlane(cube, 2, 1)), 4, 1e-12);
    EXPECT_TRUE(cutByPlane(cube, 2, 1.5).empty());
}

TEST(CutByPlane, SphereGivesCircleOfTheRightRadius) {
    const SceneMesh sphere = drawn(testing::icosphere(5, {}, 10));
    const double circle = 2 * std::numbers::pi * std::sqrt(100.0 - 36.0);
    // chords of a sphere of 20,480 triangles: edges of 0.35 mm, so 0.002 mm inside
    EXPECT_NEAR(lengthOf(cutByPlane(sphere, 1, 6)), circle, 0.002 * circle);
}

TEST(Scene, LeavesOutWhatCannotBeDrawn) {
    TriangleMesh mesh = testing::cubeMesh();
    mesh.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    mesh.triangles.push_back({0, 1, 8});
    mesh.triangles.push_back({0, 1, 99});
    mesh.triangles.push_back({-1, 1, 2});
    Report report;
    report.surfaces.push_back({"surface", mesh});
    const Scene scene = makeScene(report);
    EXPECT_EQ(scene.surfaces.front().mesh.triangleCount(), 12);
    EXPECT_EQ(scene.surfaces.front().triangles, 15);
}

TEST(Scene, TurnsLpsToRas) {
    Report report;
    report.surfaces.push_back({"cube", testing::cubeMesh({1, 2, 3}, {4, 5, 6})});
    report.spots.push_back({"corner", {1, 2, 3}});
    const Scene scene = makeScene(report);
    EXPECT_EQ(scene.box.minimum, (Vec3{-4, -5, 3}));
    EXPECT_EQ(scene.box.maximum, (Vec3{-1, -2, 6}));
    EXPECT_EQ(scene.spots.front().pointMm, (Vec3{-1, -2, 3}));
}

TEST(Scene, SpotsThatAreNotFiniteAreLeftOut) {
    Report report;
    report.spots.push_back({"nowhere", {std::numeric_limits<double>::infinity(), 0, 0}});
    EXPECT_TRUE(makeScene(report).spots.empty());
}

TEST(Slices, ShowTheSphereOfTheImage) {
    // distances to a sphere of radius 20 about (5, -3, 2) LPS, in an oblique image
    const auto image = testing::sampled<float>(testing::sphere({5, -3, 2}, 20),
                                               testing::obliqueGeometry({60, 60, 60}, {1, 1, 1}));
    SlicePlane plane;
    plane.axis = 2;
    plane.atMm = 2;
    plane.mmPerPixel = 0.5;
    plane.width = plane.height = 100;
    plane.leftMm = -5 - 25;  // its middle is (-5, 3, 2) in RAS
    plane.topMm = 3 + 25;
    const ValueRange window{image.isovalue - 1e-3, image.isovalue + 1e-3};
    const std::vector<std::uint8_t> grey = sampleSlice(image.volume, window, plane);
    std::int64_t white = 0;
    for (const std::uint8_t g : grey) white += g > 127;
    // pixels inside a circle of radius 40: an error of a pixel of its rim would be 250
    EXPECT_NEAR(static_cast<double>(white), std::numbers::pi * 40 * 40, 60);
    EXPECT_EQ(grey[50 * 100 + 50], 255);
    EXPECT_EQ(grey[0], 0);
}

TEST(Slices, RightIsRightAndUpIsUp) {
    SlicePlane plane;
    plane.mmPerPixel = 2;
    plane.leftMm = -10;
    plane.topMm = 20;
    for (int axis = 0; axis < 3; ++axis) {
        plane.axis = axis;
        Vec3 p;
        p[plane.across()] = 10;
        p[plane.up()] = 16;
        EXPECT_EQ(plane.toPixel(p).x, 10);
        EXPECT_EQ(plane.toPixel(p).y, 2);
    }
    EXPECT_STREQ(sidesOf(2).right, "R");
    EXPECT_STREQ(sidesOf(0).right, "A");
    EXPECT_STREQ(sidesOf(1).top, "S");
}

TEST(GreyWindow, LeavesOutTheExtremes) {
    ImageGeometry geometry;
    geometry.size = {10, 10, 10};
    std::vector<float> samples(1000, 50);
    for (int n = 0; n < 100; ++n) samples[static_cast<std::size_t>(n)] = 0;
    samples[500] = 1e6F;
    samples[501] = std::numeric_limits<float>::quiet_NaN();
    const ValueRange window = greyWindow(Volume::fromSamples(samples, geometry));
    EXPECT_EQ(window.minimum, 0);
    EXPECT_EQ(window.maximum, 50);
}

TEST(GreyWindow, OfOneValueIsNotEmpty) {
    ImageGeometry geometry;
    geometry.size = {4, 4, 4};
    const ValueRange window = greyWindow(Volume::fromSamples(std::vector<float>(64, 7), geometry));
    EXPECT_GT(window.maximum, window.minimum);
}

TEST(Renderer, SphereFillsACircle) {
    const SceneSurface sphere = asSeen(testing::icosphere(5, {}, 10));
    const BoundingBox box{{-10, -10, -10}, {10, 10, 10}};
    for (const View& view : sixViews()) {
        const Rendering seen = renderAlone(sphere, box, view, 200);
        double pixels = 0;
        for (const double depth : seen.depthMm) pixels += std::isfinite(depth);
        const double radius = 10 / seen.mmPerPixel;
        // pixels that are half covered count whole: half the rim
        EXPECT_NEAR(pixels, std::numbers::pi * radius * radius, 2 * radius) << view.name;
        // the middle is seen at the sphere's nearest point: chords lie 0.01 mm deep
        EXPECT_NEAR(seen.depthMm[100 * 200 + 100], 10, 0.02) << view.name;
    }
}

TEST(Renderer, ShowsTheInsideInRed) {
    TriangleMesh mesh = testing::icosphere(3, {}, 10);
    flipOrientation(mesh);
    const SceneSurface inside = asSeen(mesh);
    const Rendering seen = renderAlone(inside, {{-10, -10, -10}, {10, 10, 10}}, sixViews()[0], 100);
    const ReportColor middle = seen.colors[50 * 100 + 50];
    EXPECT_GT(middle[0], 2 * middle[1]);
    EXPECT_GT(middle[0], 2 * middle[2]);
}

TEST(Renderer, TheNearestOfSeveralIsSeen) {
    std::vector<SceneSurface> spheres{asSeen(testing::icosphere(3, {}, 6)),
                                      asSeen(testing::icosphere(3, {}, 10))};
    spheres[0].color = {0, 255, 0};
    spheres[1].color = {0, 0, 255};
    for (int turn = 0; turn < 2; ++turn, std::swap(spheres[0], spheres[1])) {
        const std::vector<VertexNormals> normals{vertexNormals(spheres[0].mesh),
                                                 vertexNormals(spheres[1].mesh)};
        const Rendering seen =
            render(spheres, normals, {{-10, -10, -10}, {10, 10, 10}}, sixViews()[0], 100);
        EXPECT_GT(seen.colors[50 * 100 + 50][2], 100);
        EXPECT_EQ(seen.colors[50 * 100 + 50][1], 0);
    }
}

TEST(Renderer, KnowsWhatIsHidden) {
    const SceneSurface sphere = asSeen(testing::icosphere(4, {}, 10));
    const View& front = sixViews()[0];
    const Rendering seen = renderAlone(sphere, {{-10, -10, -10}, {10, 10, 10}}, front, 200);
    EXPECT_TRUE(seen.isSeen({0, 10, 0}, front, 0.5));    // the nose
    EXPECT_FALSE(seen.isSeen({0, -10, 0}, front, 0.5));  // the back of the head
    EXPECT_FALSE(seen.isSeen({50, 10, 0}, front, 0.5));  // not in the picture
}

TEST(Renderer, EachSideShowsItsOwnSide) {
    // a point of the patient's right lies on the left of a view from the front
    const View &front = sixViews()[0], &left = sixViews()[1], &above = sixViews()[2];
    EXPECT_EQ(front.right(), (Vec3{-1, 0, 0}));
    EXPECT_EQ(left.right(), (Vec3{0, -1, 0}));
    EXPECT_EQ(above.right(), (Vec3{1, 0, 0}));
}

}  // namespace
}  // namespace adaptiso
