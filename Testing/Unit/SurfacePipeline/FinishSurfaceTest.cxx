#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso {
namespace {

TEST(FinishSurface, MeasuresWhatIsKept) {
    const TriangleMesh two = testing::merged(
        {testing::cubeMesh({0, 0, 0}, {2, 3, 4}), testing::cubeMesh({9, 0, 0}, {10, 1, 1})});
    SurfaceRecord record;
    FinishOptions options;
    options.selection.largestOnly = true;
    const FinishedSurface finished = finishSurface(two, options, record);
    EXPECT_EQ(finished.mesh.triangles.size(), 12u);
    EXPECT_EQ(record.topology.components.size(), 1u);
    EXPECT_DOUBLE_EQ(record.areaMm2, 52);
    ASSERT_TRUE(record.volumeMm3);
    EXPECT_DOUBLE_EQ(*record.volumeMm3, 24);
}

TEST(FinishSurface, CountsCrossingsOfMethodsThatMayMakeThem) {
    const TriangleMesh crossing = testing::crossingSpheres(2);
    FinishOptions options;
    options.method = Method::MarchingCubes;
    options.maxCrossingPairs = 3;
    SurfaceRecord record;
    EXPECT_EQ(finishSurface(crossing, options, record).crossings.size(), 3u);
    EXPECT_GT(record.crossingPairs.value_or(0), 3);

    SurfaceRecord uncounted;
    options.countsCrossings = false;
    EXPECT_TRUE(finishSurface(crossing, options, uncounted).crossings.empty());
    EXPECT_FALSE(uncounted.crossingPairs);

    SurfaceRecord proved;
    options.method = Method::Adaptive;
    finishSurface(testing::cubeMesh(), options, proved);
    EXPECT_EQ(proved.crossingPairs, 0);
}

TEST(FinishSurface, RefusesWhatIsNotSound) {
    SurfaceRecord record;
    EXPECT_THROW(finishSurface(testing::withHole(testing::cubeMesh()), {}, record), InternalError);
    EXPECT_THROW(finishSurface(testing::withUnusedVertex(testing::cubeMesh()), {}, record),
                 InternalError);
    FinishOptions open;
    open.border = Border::Open;
    SurfaceRecord opened;
    finishSurface(testing::withHole(testing::cubeMesh()), open, opened);
    EXPECT_FALSE(opened.volumeMm3);
    EXPECT_EQ(opened.topology.count(TopologyDefect::BoundaryEdge), 3);
}

TEST(FinishSurface, SaysWhenNoPieceIsLargeEnough) {
    SurfaceRecord record;
    FinishOptions options;
    options.selection.minVolumeMm3 = 2;
    EXPECT_THROW(finishSurface(testing::cubeMesh(), options, record), NothingLeft);
}

TEST(FinishSurface, RunsItsStagesInOrder) {
    std::vector<std::string> stages;
    FinishOptions options;
    options.selection.fillCavities = true;
    options.method = Method::Boxes;
    options.runStage = [&](std::string_view stage, const std::function<void()>& work) {
        stages.emplace_back(stage);
        work();
    };
    SurfaceRecord record;
    finishSurface(testing::cubeMesh(), options, record);
    EXPECT_EQ(stages, (std::vector<std::string>{"pieces", "check", "crossings"}));
}

/// Boundaries that face outward, where the second lies in the first.
TriangleMesh nestedOutward() {
    TriangleMesh both =
        testing::merged({testing::icosphere(2, {0, 0, 0}, 9), testing::icosphere(2, {1, 0, 0}, 3)});
    both.normals = {};
    return both;
}

TEST(FinishSurface, FindsPiecesThatAreInsideOut) {
    SurfaceRecord record;
    FinishOptions options;
    EXPECT_THROW(finishSurface(nestedOutward(), options, record), InternalError);
    options.method = Method::Boxes;
    finishSurface(nestedOutward(), options, record);
    EXPECT_EQ(record.insideOutPieces, 1);
    SurfaceRecord sound;
    finishSurface(testing::cubeMesh(), {}, sound);
    EXPECT_EQ(sound.insideOutPieces, 0);
}

FileDigits stlDigits(std::optional<double> requestedBoundMm) {
    return {&findMeshFormat("a.stl"), lpsToFrame(CoordinateFrame::Ras, std::nullopt),
            requestedBoundMm};
}

// at 4e5 mm single precision has steps of 1/32 mm
TEST(FinishSurface, BoundsTheSurfaceAsTheFileHoldsIt) {
    TriangleMesh sphere = testing::icosphere(2, {4e5 + 0.3, -4e5, 4e5}, 50);
    sphere.normals = {};
    SurfaceRecord record;
    record.statistics.errorBoundMm = 0.05;
    FinishOptions options;
    options.digits = stlDigits(0.05);
    const FinishedSurface finished = finishSurface(sphere, options, record);
    double farthestMm = 0;
    for (const Vec3& p : sphere.points) {
        const Vec3 rounded{static_cast<float>(p.x), static_cast<float>(p.y),
                           static_cast<float>(p.z)};
        farthestMm = std::max(farthestMm, norm(rounded - p));
    }
    EXPECT_GT(farthestMm, 0.01);
    EXPECT_NEAR(record.roundingMm.value(), farthestMm, 1e-9);
    EXPECT_NEAR(*record.errorBoundMm(), 0.05 + farthestMm, 1e-9);

    options.digits = stlDigits(0.01);
    EXPECT_THROW(finishSurface(sphere, options, record), TooFewDigits);
    options.digits = stlDigits(std::nullopt);  // a count was asked for
    EXPECT_NO_THROW(finishSurface(sphere, options, record));
}

TEST(FinishSurface, RefusesDigitsWithWhichTheSurfaceIsNotSound) {
    TriangleMesh sphere = testing::icosphere(3, {1e8, 1e8, 1e8}, 5);
    sphere.normals = {};
    FinishOptions options;
    options.digits = stlDigits(std::nullopt);
    for (const bool counts : {true, false}) {
        for (const Method method : {Method::Adaptive, Method::MarchingCubes}) {
            options.method = method;
            options.countsCrossings = counts;
            SurfaceRecord record;
            EXPECT_THROW(finishSurface(sphere, options, record), TooFewDigits);
        }
    }
}

/// A ball of radius 12 and 26 of radius 2 around it.
Volume ballAndSpecks() {
    const auto n = static_cast<std::int64_t>(48);
    std::vector<float> samples;
    for (std::int64_t k = 0; k < n; ++k) {
        for (std::int64_t j = 0; j < n; ++j) {
            for (std::int64_t i = 0; i < n; ++i) {
                const Vec3 p{static_cast<double>(i) - 23.5, static_cast<double>(j) - 23.5,
                             static_cast<double>(k) - 23.5};
                Vec3 q = p;  // from the nearest speck
                for (int a = 0; a < 3; ++a) q[a] -= 18 * std::clamp(std::round(p[a] / 18), -1., 1.);
                samples.push_back(static_cast<float>(std::max(12 - norm(p), 2 - norm(q))));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), {{n, n, n}, {0, 0, 0}, {}});
}

TEST(ExtractPieces, SpendsACountOnThePiecesThatAreKept) {
    const Volume volume = ballAndSpecks();
    const Extractor extractor = [&](const ExtractionOptions& options) {
        return extractSurface(volume.view(), options);
    };
    ExtractionOptions options;
    options.adaptive.maxTriangles = 300;
    ComponentSelection largest, minVolume;
    largest.largestOnly = true;
    minVolume.minVolumeMm3 = 500;
    for (const ComponentSelection& selection : {largest, minVolume}) {
        SurfaceRecord record;
        TriangleMesh mesh = extractPieces(extractor, options, selection, record);
        EXPECT_TRUE(record.isPart);
        FinishOptions finish;
        finish.selection = selection;
        finishSurface(std::move(mesh), finish, record);
        EXPECT_EQ(record.topology.components.size(), 1u);
        EXPECT_TRUE(record.countMet().value_or(false));
        EXPECT_GT(record.topology.triangles, 270);
        // a sphere's caps of 300 triangles are about 12 (2.7 / 12)^2 / 6 high
        EXPECT_LT(*record.errorBoundMm(), 0.4);
        EXPECT_NEAR(*record.volumeMm3, 4 / 3. * 3.14159 * 12 * 12 * 12, 200);
    }
    // where no piece goes, and where no count is asked for, nothing changes
    SurfaceRecord record;
    ComponentSelection all;
    all.minVolumeMm3 = 1;
    EXPECT_EQ(extractPieces(extractor, options, all, record).points,
              extractor(options).mesh.points);
    EXPECT_FALSE(record.isPart);
    options.adaptive = {};
    EXPECT_EQ(extractPieces(extractor, options, largest, record).points,
              extractor(options).mesh.points);
}

TEST(AskedBound, IsTheDefaultUnlessACountIsAskedFor) {
    const ImageGeometry volume{{9, 9, 9}, {0, 0, 0}, {{Vec3{2, 0, 0}, {0, 2, 0}, {0, 0, 3}}}};
    ExtractionOptions options;
    EXPECT_NEAR(*requestedBoundMm(options, volume), 0.3, 1e-12);
    options.adaptive.maxTriangles = 5;
    EXPECT_FALSE(requestedBoundMm(options, volume));
    options.adaptive.maxErrorMm = 0.7;
    EXPECT_EQ(requestedBoundMm(options, volume), 0.7);
    options = {};
    options.method = Method::MarchingCubes;
    EXPECT_FALSE(requestedBoundMm(options, volume));
}

TEST(IsovalueFault, TellsValuesThatCutNothing) {
    const ValueRange range{10, 20};
    EXPECT_EQ(isovalueFault(20.5, range), "no voxel reaches it");
    EXPECT_EQ(isovalueFault(10, range), "every voxel reaches it, so there is no surface");
    EXPECT_FALSE(isovalueFault(10.5, range));
    EXPECT_FALSE(isovalueFault(20, range));
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(isovalueFault(0, {kInfinity, -kInfinity}), "no voxel reaches it");  // NaN alone
}

}  // namespace
}  // namespace adaptiso
