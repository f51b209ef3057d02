#include <gtest/gtest.h>
#include <zlib.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>

#include "PageParts.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "Support/OperatorNew.h"
#include "adaptiso/Report/Page.h"

namespace {
std::atomic<std::size_t> largestBlock{0};  ///< that was asked for, bytes
}  // namespace

void* adaptiso::testing::memoryForNew(std::size_t byteCount) noexcept {
    std::size_t known = largestBlock;
    while (byteCount > known && !largestBlock.compare_exchange_weak(known, byteCount)) {
    }
    return std::malloc(byteCount > 0 ? byteCount : 1);
}

namespace adaptiso {
namespace {

template <class T>
T get(const std::string& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

std::string gunzip(const std::string& packed, std::size_t size) {
    std::string bytes(size + 1, '\0');
    z_stream stream{};
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    inflateInit2(&stream, 16 + MAX_WBITS);
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    bytes.resize(stream.total_out);
    inflateEnd(&stream);
    return bytes;
}

/// Of voxel `index`, by the file's own header.
Vec3 rasOf(const std::string& nifti, const Vec3& index) {
    Vec3 p;
    for (int row = 0; row < 3; ++row) {
        const std::size_t at = 280 + 16 * static_cast<std::size_t>(row);
        p[row] = get<float>(nifti, at + 12);
        for (int axis = 0; axis < 3; ++axis) {
            p[row] += get<float>(nifti, at + 4 * static_cast<std::size_t>(axis)) * index[axis];
        }
    }
    return p;
}

/// A surface in a scene, with what it looks at.
struct Shown {
    explicit Shown(const TriangleMesh& mesh, std::vector<double> values = {}) {
        report.surfaces.push_back({"surface", mesh, std::move(values)});
        scene = makeScene(report);
    }
    const SceneSurface& surface() const { return scene.surfaces.front(); }

    Report report;
    Scene scene;
};

TEST(Gzip, ComesBackAndHoldsNoDate) {
    std::string text;
    for (int n = 0; n < 100000; ++n) text += std::to_string(n);
    const std::string packed = gzip(text);
    EXPECT_LT(packed.size(), text.size());
    EXPECT_EQ(gunzip(packed, text.size()), text);
    EXPECT_EQ(get<std::uint32_t>(packed, 4), 0u);
    EXPECT_EQ(gunzip(gzip(""), 0), "");
}

TEST(Nifti, LiesWhereTheImageLies) {
    const auto image = testing::sampled<std::int16_t>(
        testing::sphere({1, 2, 3}, 6), testing::mirroredGeometry({20, 16, 12}, {1, 1.5, 2}));
    const std::string nifti = niftiOf(image.volume, 1'000'000);
    EXPECT_EQ(nifti.size(), 352u + 20 * 16 * 12);
    EXPECT_EQ(get<std::int32_t>(nifti, 0), 348);
    EXPECT_EQ(get<std::int16_t>(nifti, 42), 20);
    EXPECT_EQ(get<std::int16_t>(nifti, 46), 12);
    for (const Vec3& index : {Vec3{0, 0, 0}, Vec3{19, 0, 5}, Vec3{7, 15, 11}}) {
        const Vec3 truth = lpsToRas(image.volume.view().geometry().toPhysical(index));
        // floats of some 30 mm: 2e-6 each
        EXPECT_LT(norm(rasOf(nifti, index) - truth), 2e-5);
    }
}

TEST(Nifti, LargeImagesBecomeMeansOfBlocks) {
    ImageGeometry geometry = testing::centredGeometry({40, 40, 20}, {1, 1, 2});
    std::vector<float> samples;
    for (int n = 0; n < 40 * 40 * 20; ++n) samples.push_back(static_cast<float>(n % 40 / 2));
    const std::string nifti = niftiOf(Volume::fromSamples(samples, geometry), 8000);
    // the finest axes go first, till all voxels are 2 mm a side
    EXPECT_EQ(get<std::int16_t>(nifti, 42), 20);
    EXPECT_EQ(get<std::int16_t>(nifti, 44), 20);
    EXPECT_EQ(get<std::int16_t>(nifti, 46), 20);
    EXPECT_EQ(get<float>(nifti, 80), 2);
    // the first voxel lies in the middle of the first two
    const Vec3 truth = lpsToRas(geometry.toPhysical({0.5, 0.5, 0}));
    EXPECT_LT(norm(rasOf(nifti, {0, 0, 0}) - truth), 1e-5);
    // pairs of 0 0 1 1 2 2 ... 19 19: the first is black, the last white, in even steps
    for (int i = 0; i < 20; ++i) {
        EXPECT_NEAR(get<std::uint8_t>(nifti, 352 + static_cast<std::size_t>(i)), 255 * i / 19.0, 1);
    }
}

TEST(Nifti, BlankHoldsTheBox) {
    const BoundingBox box{{-10, -20, 5}, {30, 20, 25}};
    const std::string nifti = blankNifti(box);
    const Vec3 first = rasOf(nifti, {0, 0, 0}), last = rasOf(nifti, {15, 15, 15});
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(first[axis], box.minimum[axis]);
        EXPECT_GT(last[axis], box.maximum[axis]);
    }
}

TEST(Mz3, HoldsTheTrianglesAndWhatTheyUse) {
    TriangleMesh mesh = testing::cubeMesh({1, 2, 3}, {4, 5, 6});
    mesh.points.insert(mesh.points.begin(), Vec3{99, 99, 99});  // that nothing uses
    for (Triangle& t : mesh.triangles) t = {t[0] + 1, t[1] + 1, t[2] + 1};
    const std::string bytes = mz3Of(Shown(mesh).surface());
    EXPECT_EQ(bytes.substr(0, 2), "MZ");
    EXPECT_EQ(get<std::uint16_t>(bytes, 2), 3);
    EXPECT_EQ(get<std::uint32_t>(bytes, 4), 12u);
    EXPECT_EQ(get<std::uint32_t>(bytes, 8), 8u);
    ASSERT_EQ(bytes.size(), 16u + 12 * 12 + 8 * 12);
    const auto corner = get<std::int32_t>(bytes, 16);
    const std::size_t at = 16 + 12 * 12 + 12 * static_cast<std::size_t>(corner);
    const Vec3 truth = lpsToRas(mesh.points[mesh.triangles[0][0]]);
    EXPECT_EQ(get<float>(bytes, at), truth.x);
    EXPECT_EQ(get<float>(bytes, at + 4), truth.y);
    EXPECT_EQ(get<float>(bytes, at + 8), truth.z);
}

TEST(Mz3, ValuesBecomeColors) {
    const std::string bytes = mz3Of(Shown(testing::cubeMesh(), {0, 1, 2, 3, 4, 5, 6, 7}).surface());
    EXPECT_EQ(get<std::uint16_t>(bytes, 2), 7);
    EXPECT_EQ(bytes.size(), 16u + 12 * 12 + 8 * 12 + 8 * 4);
    EXPECT_EQ(static_cast<std::uint8_t>(bytes.back()), 255);  // opaque
}

TEST(Coarser, KeepsTheLimitAndTheShape) {
    const TriangleMesh fine = testing::icosphere(6, {}, 50);  // 81,920 triangles
    std::vector<double> heights;
    for (const Vec3& p : fine.points) heights.push_back(p.z + 50);
    const Shown shown(fine, heights);
    const SceneSurface coarse = coarser(shown.surface(), 5000);
    EXPECT_LE(coarse.mesh.triangleCount(), 5000);
    EXPECT_GE(coarse.mesh.triangleCount(), 4000);
    ASSERT_EQ(std::ssize(coarse.valuesMm), coarse.mesh.pointCount());
    for (VertexId v = 0; v < coarse.mesh.pointCount(); ++v) {
        // cells of 4.5 mm: planes there leave the sphere by 4.5^2 / (8 x 50) = 0.05 mm
        EXPECT_NEAR(norm(coarse.mesh.point(v)), 50, 0.1);
        EXPECT_NEAR(coarse.valuesMm[v], coarse.mesh.point(v).z + 50, 2);
    }
    // as much area as chords of that length leave: 0.3 %
    EXPECT_NEAR(surfaceArea(coarse.mesh), 4 * std::numbers::pi * 50 * 50, 100);
}

TEST(Coarser, LeavesSmallSurfacesAlone) {
    const TriangleMesh cube = testing::cubeMesh();
    EXPECT_EQ(coarserMesh(cube, 12), cube);
}

TEST(Coarser, KeepsNoEmptyCells) {
    const TriangleMesh fine = testing::icosphere(7, {}, 50);  // 327,680 triangles
    largestBlock = 0;
    const TriangleMesh coarse = coarserMesh(fine, 200'000);
    EXPECT_GT(coarse.triangles.size(), 150'000u);
    // 100,000 clusters of 112 bytes; all cells of the box would be 10^7
    EXPECT_LT(largestBlock, 20'000'000u);
}

TEST(Coarser, AnythingBecomesSomething) {
    TriangleMesh point;  // a thousand triangles without extent
    point.points.assign(3, {1, 1, 1});
    point.triangles.assign(1000, {0, 1, 2});
    EXPECT_TRUE(coarserMesh(point, 10).triangles.empty());
    EXPECT_LE(coarserMesh(testing::icosphere(4), 1).triangles.size(), 1u);
    EXPECT_TRUE(coarserMesh(testing::icosphere(4), 0).triangles.empty());
}

TEST(ShareTriangles, LeavesSmallSurfacesWhole) {
    EXPECT_EQ(shareTriangles({50, 1000, 2000}, 550), (std::vector<std::int64_t>{50, 250, 250}));
    EXPECT_EQ(shareTriangles({50, 60}, 550), (std::vector<std::int64_t>{50, 60}));
    EXPECT_TRUE(shareTriangles({}, 550).empty());
}

}  // namespace
}  // namespace adaptiso
