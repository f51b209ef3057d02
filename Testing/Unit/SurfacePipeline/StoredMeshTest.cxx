#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Support/Meshes.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso {
namespace {

const AffineTransform kRas = lpsToFrame(CoordinateFrame::Ras, std::nullopt);

/// A sheet and one that comes near it, by a fraction of a coordinate's last place, around `centre`.
TriangleMesh sheetsThatNearlyTouch(const Vec3& centre, double gapMm) {
    TriangleMesh lower = testing::planeMesh(7, 10), upper = testing::planeMesh(6, 10);
    for (Vec3& p : upper.points) {
        const double x = p.x - 5, y = p.y - 5;
        p.z = gapMm + 0.01 * (x * x + y * y);
    }
    TriangleMesh sheets = testing::merged({lower, upper});
    sheets.normals = {};
    for (Vec3& p : sheets.points) {  // tilted against the axes
        const Vec3 q = p - Vec3{5, 5, 0};
        p = centre +
            Vec3{0.9 * q.x - 0.3 * q.z, 0.1 * q.x + q.y + 0.2 * q.z, 0.31 * q.x - 0.21 * q.y + q.z};
    }
    return sheets;
}

TriangleMesh asFloats(TriangleMesh mesh) {
    for (Vec3& p : mesh.points) {
        for (int a = 0; a < 3; ++a) {
            const volatile float rounded = static_cast<float>(p[a]);
            p[a] = rounded;
        }
    }
    return mesh;
}

std::int64_t crossingsIn(const TriangleMesh& mesh) {
    return findSelfIntersections(mesh).pairCount;
}

// At 1000 mm floats lie 6.1e-5 mm apart.
TEST(SettleRounding, UncrossesTrianglesThatRoundingMakesCross) {
    int crossed = 0;
    for (int n = 0; n < 30; ++n) {
        TriangleMesh sheets = sheetsThatNearlyTouch(
            {1003.1 + 0.371 * n, -1207.7 + 0.093 * n, 1100.3 - 0.517 * n}, 1e-5);
        const TriangleMesh before = sheets;
        ASSERT_EQ(crossingsIn(sheets), 0);
        if (crossingsIn(asFloats(sheets)) > 0) ++crossed;
        const RoundingHarm harm = settleRounding(sheets, CoordinatePrecision::Float32, kRas);
        EXPECT_FALSE(harm) << textOf(harm, findMeshFormat("a.stl"));
        EXPECT_EQ(crossingsIn(asFloats(sheets)), 0);
        for (std::size_t v = 0; v < sheets.points.size(); ++v) {
            EXPECT_LE(norm(sheets.points[v] - before.points[v]), 4 * std::ldexp(1000.0, -23));
        }
    }
    EXPECT_GT(crossed, 5);
}

// A triangle of 1e-6 mm, and a corner of another surface as near to one of its corners.
TEST(SettleRounding, PartsVerticesThatRoundingMerges) {
    for (int n = 0; n < 30; ++n) {
        const Vec3 middle{1003.1 + 0.371 * n, -1207.7 + 0.093 * n, 1100.3 - 0.517 * n};
        TriangleMesh sphere = testing::icosphere(3, middle, 5);
        const Triangle& t = sphere.triangles[7 * n];
        const Vec3 centre =
            (1.0 / 3) * (sphere.points[t[0]] + sphere.points[t[1]] + sphere.points[t[2]]);
        for (const VertexId v : t) {
            sphere.points[v] = centre + 1e-6 * (sphere.points[v] - centre);
        }
        const Vec3 corner = sphere.points[t[0]], outward = 0.2 * (corner - middle);
        TriangleMesh beside = testing::icosphere(1, corner + 3 * outward, 1);
        *std::min_element(beside.points.begin(), beside.points.end(),
                          [&](const Vec3& p, const Vec3& q) {
                              return norm(p - corner) < norm(q - corner);
                          }) = corner + 1e-6 * outward;
        TriangleMesh both = testing::merged({sphere, beside});
        both.normals = {};
        ASSERT_EQ(crossingsIn(both), 0) << n;
        const RoundingHarm harm = settleRounding(both, CoordinatePrecision::Float32, kRas);
        EXPECT_FALSE(harm) << n << textOf(harm, findMeshFormat("a.stl"));
        EXPECT_GT(harm.movedPoints, 0);
        const TriangleMesh file = asFloats(both);
        EXPECT_EQ(crossingsIn(file), 0);
        for (const Triangle& triangle : file.triangles) EXPECT_FALSE(isDegenerate(file, triangle));
    }
}

TEST(SettleRounding, LeavesAMeshThatRoundingDoesNotHarm) {
    for (const auto precision : {CoordinatePrecision::Float64, CoordinatePrecision::Float32,
                                 CoordinatePrecision::NineDigits}) {
        TriangleMesh sphere = testing::icosphere(3, {100, 20, -30}, 50);
        const std::vector<Vec3> before = sphere.points;
        EXPECT_FALSE(settleRounding(sphere, precision, kRas));
        EXPECT_EQ(sphere.points, before);
    }
}

TEST(SettleRounding, LeavesWhatCrossesAnyway) {
    TriangleMesh spheres = testing::crossingSpheres(2);
    const std::vector<Vec3> before = spheres.points;
    EXPECT_FALSE(settleRounding(spheres, CoordinatePrecision::Float32, kRas));
    EXPECT_EQ(spheres.points, before);
}

TEST(SettleRounding, TellsWhatAFormatCannotHold) {
    // at 1e7 mm floats lie 1 mm apart
    TriangleMesh sphere = testing::icosphere(3, {1e7, 1e7, -1e7}, 5);
    const RoundingHarm harm = settleRounding(sphere, CoordinatePrecision::Float32, kRas);
    EXPECT_GT(harm.flatTriangles, 0);
    EXPECT_GT(harm.mergedPoints, 0);
    EXPECT_NE(textOf(harm, findMeshFormat("a.stl")).find("STL keeps 24 bits"), std::string::npos);
    EXPECT_FALSE(settleRounding(sphere, CoordinatePrecision::Float64, kRas));
}

// Moved vertices go through the frame and back: what counts is what the file holds.
TEST(SettleRounding, CountsInTheFrameOfTheFile) {
    AffineTransform toFrame = kRas;
    toFrame.offset = {13.37, 0.1, -77.7};
    for (int n = 0; n < 30; ++n) {
        TriangleMesh sheets = sheetsThatNearlyTouch(
            {1003.1 + 0.371 * n, -1207.7 + 0.093 * n, 1100.3 - 0.517 * n}, 1e-5);
        EXPECT_FALSE(settleRounding(sheets, CoordinatePrecision::Float32, toFrame));
        EXPECT_EQ(crossingsIn(asFloats(transformed(sheets, toFrame))), 0);
    }
}

TEST(SettleRounding, TakesNineDigits) {
    // at 1000 mm nine digits lie 1e-5 mm apart
    for (int n = 0; n < 30; ++n) {
        TriangleMesh sheets = sheetsThatNearlyTouch(
            {1003.1 + 0.371 * n, -1207.7 + 0.093 * n, 1100.3 - 0.517 * n}, 2e-6);
        EXPECT_FALSE(settleRounding(sheets, CoordinatePrecision::NineDigits, kRas));
    }
}

/// A sphere as a file has it, read again.
TriangleMesh writtenAndRead(const TriangleMesh& mesh, const std::filesystem::path& path,
                            CoordinateFrame frame, const std::optional<ImageGeometry>& volume) {
    MeshWriteOptions write;
    write.frame = frame;
    write.volume = volume;
    writeMesh(mesh, path, write);
    MeshFile file = readMesh(path);
    return fromFrame(file.mesh, frame, volume);
}

// The rounding claimed is that of the file, in every format that keeps the order of points.
TEST(SettleRounding, MeasuresTheRoundingOfTheFile) {
    const std::filesystem::path folder =
        std::filesystem::path(::testing::TempDir()) / ("settled" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const ImageGeometry volume{{256, 256, 256}, {-128, -128, -128}, {}};
    for (const double far : {10.0, 4e4, 4e5}) {
        for (const char* name : {"a.obj", "a.off", "a.gii", "a.surf", "a.tri", "a.vtp"}) {
            const MeshFormat format = findMeshFormat(name);
            const CoordinateFrame frame = format.defaultFrame;
            TriangleMesh sphere = testing::icosphere(3, {far, 0.3 * far, -0.7 * far}, 50);
            sphere.normals = {};
            const std::vector<Vec3> exact = sphere.points;
            const AffineTransform toFrame = lpsToFrame(frame, volume);
            const RoundingHarm harm = settleRounding(sphere, format.precision, toFrame);
            ASSERT_FALSE(harm);
            const TriangleMesh file = writtenAndRead(sphere, folder / name, frame, volume);
            const TriangleMesh stored = asStored(sphere, format.precision, toFrame);
            ASSERT_EQ(file.points.size(), exact.size());
            double farthestMm = 0;
            for (std::size_t v = 0; v < exact.size(); ++v) {
                farthestMm = std::max(farthestMm, norm(file.points[v] - exact[v]));
                // a frame and back: some units in the last place of doubles
                EXPECT_LE(norm(stored.points[v] - file.points[v]), 1e-14 * far) << name;
            }
            EXPECT_NEAR(harm.roundingMm, farthestMm, 1e-14 * far) << name << far;
            if (format.precision == CoordinatePrecision::Float64) {
                EXPECT_EQ(harm.roundingMm, 0);
            }
        }
    }
}

TEST(RoundingFault, RefusesRoundingBeyondTheBound) {
    const MeshFormat stl = findMeshFormat("a.stl");
    EXPECT_FALSE(roundingFault(0.01, 0.05, stl));
    EXPECT_EQ(roundingFault(0.226, 0.05, stl),
              "STL keeps 24 bits of a coordinate: points would move by up to 0.226 mm, "
              "more than the bound of 0.05 mm; write a .vtp or .ply, or move the image nearer to "
              "the origin");
}

TEST(RoundingWarning, StatesTheBoundOfTheFileWhereItIsNoticeablyLarger) {
    const MeshFormat stl = findMeshFormat("a.stl");
    const auto warning = roundingWarning("a.stl", 0.056789, 0.05, 0.006789, stl);
    ASSERT_TRUE(warning);
    EXPECT_EQ(warning->code, "bound-exceeded");
    EXPECT_EQ(warning->line().find("a.stl: lies within 0.0568 mm, not 0.05 mm"), 0u);
    EXPECT_FALSE(roundingWarning("a.stl", 0.15000763, 0.15, 7.63e-6, stl));
    EXPECT_FALSE(roundingWarning("a.stl", 0.04, 0.05, 0.006789, stl));  // within it all the same
}

}  // namespace
}  // namespace adaptiso
