#include <gtest/gtest.h>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {
namespace {

using testing::icosphere;
using testing::messageOf;
using testing::mirroredVolume;
using testing::obliqueVolume;
using testing::shearedVolume;
using testing::straightVolume;

// a dozen roundings of numbers below 500
constexpr double kRoundingMm = 1e-12 * 500;

void expectNear(const Vec3& found, const Vec3& expected, double tolerance) {
    EXPECT_NEAR(found.x, expected.x, tolerance);
    EXPECT_NEAR(found.y, expected.y, tolerance);
    EXPECT_NEAR(found.z, expected.z, tolerance);
}

TEST(FrameTransform, RasIsLpsWithXAndYTurned) {
    const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, std::nullopt);
    EXPECT_EQ(toRas({1, 2, 3}), (Vec3{-1, -2, 3}));
    EXPECT_EQ(determinant(toRas.linear), 1);
}

TEST(FrameTransform, TkRasIsFreeSurfersFormula) {
    // 10 x 20 x 30 voxels of 1 x 2 x 3 mm; on paper: x = 5 - i, y = 3 k - 45, z = 20 - 2 j
    const AffineTransform toTkRas = indexToTkRas(straightVolume());
    EXPECT_EQ(toTkRas({0, 0, 0}), (Vec3{5, -45, 20}));
    EXPECT_EQ(toTkRas({1, 0, 0}), (Vec3{4, -45, 20}));
    EXPECT_EQ(toTkRas({0, 1, 0}), (Vec3{5, -45, 18}));
    EXPECT_EQ(toTkRas({0, 0, 1}), (Vec3{5, -42, 20}));
}

TEST(FrameTransform, ObliqueAndMirroredVolumesMatchThePaper) {
    // steps of obliqueVolume(), mm: i (.6, -.6, .3), j (1.1, 2.2, 2.2) / 3, k (-1, -.5, 1); to
    // (-80.5, 30.25, -112) come (6, -6, 3), (11, 22, 22) and, mirrored or not, -+(20, 10, -20)
    const Vec3 index{10, 30, 20};
    const Vec3 tkRas{0.9 * (88 - 10), 1.5 * (20 - 100), 1.1 * (120 - 30)};
    const std::pair<ImageGeometry, Vec3> cases[] = {{obliqueVolume(), {-83.5, 36.25, -67}},
                                                    {mirroredVolume(), {-43.5, 56.25, -107}}};
    for (const auto& [volume, lps] : cases) {
        expectNear(lpsToFrame(CoordinateFrame::Voxel, volume)(lps), index, kRoundingMm);
        expectNear(lpsToFrame(CoordinateFrame::TkRas, volume)(lps), tkRas, kRoundingMm);
    }
}

TEST(FrameTransform, TkRasDoesNotDependOnWhereTheVolumeLies) {
    ImageGeometry moved = straightVolume();
    moved.originMm = {100, -70, 3};
    EXPECT_EQ(indexToTkRas(moved), indexToTkRas(straightVolume()));
}

TEST(FrameTransform, TkRasOfTheVolumesCentreIsZero) {
    for (const ImageGeometry& volume : {obliqueVolume(), mirroredVolume()}) {
        const Vec3 centreMm = volume.toPhysical({88, 120, 100});
        expectNear(lpsToFrame(CoordinateFrame::TkRas, volume)(centreMm), {0, 0, 0}, kRoundingMm);
    }
}

TEST(FrameTransform, TkRasIsRigidOnlyForVolumesMirroredInLps) {
    EXPECT_NEAR(determinant(lpsToFrame(CoordinateFrame::TkRas, mirroredVolume()).linear), 1, 1e-12);
    EXPECT_NEAR(determinant(lpsToFrame(CoordinateFrame::TkRas, obliqueVolume()).linear), -1, 1e-12);
}

TEST(FrameTransform, TkRasOfTheConformedVolumeIsRasLessTheCentre) {
    for (const ImageGeometry& volume : {straightVolume(), obliqueVolume(), shearedVolume()}) {
        const auto half = [&](int axis) { return static_cast<double>(volume.size[axis]) / 2; };
        const Vec3 centreMm = volume.toPhysical({half(0), half(1), half(2)});
        const ImageGeometry conformed = conformedGeometry(volume);
        EXPECT_TRUE(conformed.isMirrored());
        const Vec3 point{11, -22, 33};
        const Vec3 offset = point - centreMm;
        expectNear(lpsToFrame(CoordinateFrame::TkRas, conformed)(point),
                   {-offset.x, -offset.y, offset.z}, kRoundingMm);
    }
}

TEST(FrameTransform, ShearIsRefusedForTkRasAndKeptForVoxels) {
    const std::string message = messageOf<InvalidInput>([] { indexToTkRas(shearedVolume()); });
    EXPECT_NE(message.find("right angles"), std::string::npos) << message;
    const Vec3 index{3, 7, 11};
    expectNear(
        lpsToFrame(CoordinateFrame::Voxel, shearedVolume())(shearedVolume().toPhysical(index)),
        index, kRoundingMm);
}

TEST(FrameTransform, DirectionsRoundedToSixDigitsAreNotShear) {
    ImageGeometry volume = straightVolume();
    volume.indexToPhysical.column[0] = {0.999999, 0.000014, 0};  // cosine 1e-5 or so
    EXPECT_NO_THROW(indexToTkRas(volume));
}

TEST(FrameTransform, FramesOfAVolumeNeedTheVolume) {
    for (const CoordinateFrame frame : {CoordinateFrame::TkRas, CoordinateFrame::Voxel}) {
        EXPECT_THROW(lpsToFrame(frame, std::nullopt), InvalidInput);
        ImageGeometry flat = straightVolume();
        flat.indexToPhysical.column[2] = {};
        EXPECT_THROW(lpsToFrame(frame, flat), InvalidInput);
    }
    ImageGeometry empty = straightVolume();
    empty.size[1] = 0;
    EXPECT_THROW(indexToTkRas(empty), InvalidInput);
}

TEST(FrameTransform, SurfacesStayOutwardInEveryFrame) {
    const TriangleMesh sphere = icosphere(2, {10, 20, 30}, 25);
    for (const ImageGeometry& volume : {straightVolume(), obliqueVolume(), mirroredVolume()}) {
        for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps,
                                            CoordinateFrame::TkRas, CoordinateFrame::Voxel}) {
            const TriangleMesh moved = toFrame(sphere, frame, volume);
            const double scale = frame == CoordinateFrame::Voxel ? volume.voxelVolumeMm3() : 1;
            // 15,625 mm3 pi 4/3 within 1e-12 of rounding
            EXPECT_NEAR(enclosedVolume(moved) * scale / enclosedVolume(sphere), 1, 1e-11);
            const Vec3 centre = lpsToFrame(frame, volume)({10, 20, 30});
            for (std::size_t i = 0; i < moved.points.size(); ++i) {
                EXPECT_GT(dot(toVec3(moved.normals[i]), moved.points[i] - centre), 0);
            }
        }
    }
}

TEST(FrameTransform, NormalsStayAtRightAnglesToThePlane) {
    // the plane x + y = 0 stretched by 4 along x: its normal leans to (1/4, 1, 0)
    const TriangleMesh plane{
        {{0, 0, 0}, {1, -1, 0}, {0, 0, 1}}, {3, toNormal({1, 1, 0})}, {{0, 2, 1}}};
    const TriangleMesh stretched = transformed(plane, {Mat3::diagonal(4, 1, 1), {7, 8, 9}});
    const Normal expected = toNormal({0.25, 1, 0});
    for (const Normal& normal : stretched.normals) {
        EXPECT_FLOAT_EQ(normal.x, expected.x);
        EXPECT_FLOAT_EQ(normal.y, expected.y);
        EXPECT_FLOAT_EQ(normal.z, expected.z);
    }
    EXPECT_EQ(stretched.points[1], (Vec3{11, 7, 9}));
}

TEST(FrameTransform, FromFrameUndoesToFrame) {
    const TriangleMesh sphere = icosphere(1, {10, 20, 30}, 25);
    for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps,
                                        CoordinateFrame::TkRas, CoordinateFrame::Voxel}) {
        const TriangleMesh back =
            fromFrame(toFrame(sphere, frame, obliqueVolume()), frame, obliqueVolume());
        EXPECT_EQ(back.triangles, sphere.triangles);
        for (std::size_t i = 0; i < back.points.size(); ++i) {
            expectNear(back.points[i], sphere.points[i], kRoundingMm);
        }
    }
}

}  // namespace

TEST(FrameVolume, IsTheConformedVolumeForTkRasOfImagesStoredOtherwise) {
    ImageGeometry image;  // as most DICOM and NIfTI images: right-handed in LPS
    image.size = {10, 20, 30};
    EXPECT_EQ(frameVolume(CoordinateFrame::Ras, image), image);
    EXPECT_EQ(frameVolume(CoordinateFrame::Voxel, image), image);
    EXPECT_EQ(frameVolume(CoordinateFrame::TkRas, image), conformedGeometry(image));
    const ImageGeometry conformed = conformedGeometry(image);  // as FreeSurfer stores them
    EXPECT_EQ(frameVolume(CoordinateFrame::TkRas, conformed), conformed);
}

}  // namespace adaptiso
