#include <gtest/gtest.h>

#include <tuple>

#include "MeshIOTestSupport.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {
namespace {

using testing::decoded;
using testing::exampleName;
using testing::icosphere;
using testing::mirroredVolume;
using testing::obliqueVolume;
using testing::written;

/// Largest error, in units of the frame, of a coordinate below 512 there.
double coordinateTolerance(CoordinatePrecision precision) {
    switch (precision) {
        case CoordinatePrecision::Float64:
            return 0;
        case CoordinatePrecision::Float32:
            return 1.6e-5;  // half the float step, 2^-16
        case CoordinatePrecision::NineDigits:
            return 5.1e-7;  // half the ninth digit of 512
    }
    return 0;
}

class RoundTrip : public ::testing::TestWithParam<std::tuple<int, CoordinateFrame, bool>> {
protected:
    const MeshFormat& format() const { return meshFormats()[std::get<0>(GetParam())]; }
    MeshWriteOptions options() const {
        return {std::get<1>(GetParam()),
                std::get<2>(GetParam()) ? mirroredVolume() : obliqueVolume(), "T1.mgz"};
    }
    bool isHeld() const {
        return options().frame != CoordinateFrame::Voxel || format().holdsVoxelFrame;
    }
    // inside the volumes, so that voxel indices stay below 512
    const TriangleMesh sphere_ = icosphere(3, {40, 60, -20}, 30);
};

TEST_P(RoundTrip, KeepsPointsOrientationNormalsAndFrame) {
    const std::string name = exampleName(format());
    if (!isHeld()) {
        EXPECT_THROW(written(sphere_, name, options()), InvalidInput);
        return;
    }
    const TriangleMesh expected = toFrame(sphere_, options().frame, options().volume);
    const MeshFile file = decoded(written(sphere_, name, options()), name);

    EXPECT_EQ(file.mesh.points.size(), expected.points.size());
    ASSERT_EQ(file.mesh.triangles.size(), expected.triangles.size());
    const double tolerance = coordinateTolerance(format().precision);
    for (std::size_t t = 0; t < expected.triangles.size(); ++t) {
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3 miss = file.mesh.points[file.mesh.triangles[t][corner]] -
                              expected.points[expected.triangles[t][corner]];
            for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(miss[axis]), tolerance);
        }
    }
    if (format().sharesVertices) {
        EXPECT_EQ(file.mesh.triangles, expected.triangles);
    }
    testing::expectSound(file.mesh);
    EXPECT_GT(enclosedVolume(file.mesh), 0);

    ASSERT_EQ(file.mesh.normals.size(), format().holdsNormals ? expected.normals.size() : 0);
    for (std::size_t i = 0; i < file.mesh.normals.size(); ++i) {
        // nine digits of a float name that float
        EXPECT_EQ(file.mesh.normals[i], expected.normals[i]);
    }
    EXPECT_EQ(file.frame, format().holdsFrame ? std::optional(options().frame) : std::nullopt);
}

TEST_P(RoundTrip, KeepsTheVolumeOfTkRas) {
    if (!isHeld()) GTEST_SKIP() << "not a frame of this format";
    const std::string name = exampleName(format());
    const MeshFile file = decoded(written(sphere_, name, options()), name);
    const bool isTkRas = options().frame == CoordinateFrame::TkRas;
    // GIFTI's matrix to scanner space tells where voxels lie, but not how many there are
    const bool isGiftiVoxel = format().name == "GIFTI" && options().frame == CoordinateFrame::Voxel;
    if (!isGiftiVoxel && !(format().holdsVolumeGeometry && isTkRas)) {
        EXPECT_EQ(file.volume, std::nullopt);
        return;
    }
    ASSERT_TRUE(file.volume.has_value());
    if (isTkRas) {
        EXPECT_EQ(file.volume->size, options().volume->size);
    }
    for (const Vec3& index : {Vec3{0, 0, 0}, Vec3{175, 239, 199}}) {
        const Vec3 miss = file.volume->toPhysical(index) - options().volume->toPhysical(index);
        EXPECT_LE(norm(miss), 1e-6);  // nine digits of direction (1e-9) over 300 mm
    }
}

TEST_P(RoundTrip, SameMeshGivesSameBytes) {
    if (!isHeld()) GTEST_SKIP() << "not a frame of this format";
    const std::string once = written(sphere_, "once" + exampleName(format()), options());
    EXPECT_TRUE(once == written(sphere_, "again" + exampleName(format()), options()));
    EXPECT_GT(once.size(), sphere_.triangles.size());
}

TEST_P(RoundTrip, WhatWasReadIsWrittenAgainBitForBit) {
    if (!isHeld()) GTEST_SKIP() << "not a frame of this format";
    // in the file's own frame, so that only the format works on the numbers
    const std::string name = exampleName(format());
    const MeshWriteOptions plain{CoordinateFrame::Lps, std::nullopt, ""};
    const std::string once = written(sphere_, name, plain);
    EXPECT_TRUE(written(decoded(once, name).mesh, "again" + name, plain) == once);
}

std::string nameOfCase(const ::testing::TestParamInfo<RoundTrip::ParamType>& info) {
    const auto [format, frame, isMirrored] = info.param;
    std::string name(meshFormats()[format].extensions.front().substr(1));
    for (const char c : toString(frame))
        name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name + (isMirrored ? "Mirrored" : "");
}

INSTANTIATE_TEST_SUITE_P(
    EveryFormatAndFrame, RoundTrip,
    ::testing::Combine(::testing::Range(0, static_cast<int>(meshFormats().size())),
                       ::testing::Values(CoordinateFrame::Ras, CoordinateFrame::Lps,
                                         CoordinateFrame::TkRas, CoordinateFrame::Voxel),
                       ::testing::Bool()),
    nameOfCase);

TEST(MeshFile, MeshesWithoutNormalsStaySo) {
    TriangleMesh sphere = icosphere(1);
    sphere.normals.clear();
    for (const MeshFormat& format : meshFormats()) {
        const std::string name = exampleName(format);
        const MeshFile file =
            decoded(written(sphere, name, {CoordinateFrame::Lps, std::nullopt, ""}), name);
        if (format.name == "OpenMEEG") continue;  // has normals always: see below
        EXPECT_TRUE(file.mesh.normals.empty()) << format.name;
    }
}

TEST(MeshFile, VerticesThatNoTriangleUsesKeepTheirPlaceAndNormal) {
    TriangleMesh sphere = icosphere(1);
    sphere.points.insert(sphere.points.begin(), {7, 8, 9});
    sphere.normals.insert(sphere.normals.begin(), {0, 0, 1});
    for (Triangle& triangle : sphere.triangles) {
        for (VertexId& vertex : triangle) ++vertex;
    }
    for (const MeshFormat& format : meshFormats()) {
        if (!format.sharesVertices) continue;
        const std::string name = exampleName(format);
        const MeshFile file =
            decoded(written(sphere, name, {CoordinateFrame::Lps, std::nullopt, ""}), name);
        EXPECT_EQ(file.mesh.triangles, sphere.triangles) << format.name;
        ASSERT_EQ(file.mesh.points.size(), sphere.points.size()) << format.name;
        EXPECT_EQ(file.mesh.points.front(), (Vec3{7, 8, 9})) << format.name;
        if (format.holdsNormals) {
            EXPECT_EQ(file.mesh.normals, sphere.normals) << format.name;
        }
    }
}

TEST(MeshFile, OpenMeegGetsAreaWeightedNormals) {
    TriangleMesh sphere = icosphere(3, {1, 2, 3}, 10);
    const std::vector<Normal> radial = std::exchange(sphere.normals, {});
    const MeshFile file =
        decoded(written(sphere, "a.tri", {CoordinateFrame::Lps, std::nullopt, ""}), "a.tri");
    ASSERT_EQ(file.mesh.normals.size(), radial.size());
    for (std::size_t i = 0; i < radial.size(); ++i) {
        // triangles of 8 degrees: their mean leans by less than a hundredth of that angle
        EXPECT_GT(dot(toVec3(file.mesh.normals[i]), toVec3(radial[i])), 1 - 1e-4);
    }
}

TEST(MeshFile, WritesToAndReadsFromDisk) {
    const auto path = testing::temporaryFile("sphere.ply");
    const TriangleMesh sphere = icosphere(2);
    writeMesh(sphere, path, {CoordinateFrame::Lps, std::nullopt, ""});
    EXPECT_EQ(readMesh(path).mesh, sphere);
}

}  // namespace
}  // namespace adaptiso
