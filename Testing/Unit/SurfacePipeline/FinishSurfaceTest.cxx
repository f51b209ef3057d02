#include <gtest/gtest.h>

#include <limits>
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
