// The check before anything is written finds the faults that it is there for: each is planted in
// walls that are sound.
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "adaptiso-labels/Regions.h"

namespace adaptiso::labels {
namespace {

/// Two boxes of 2 x 4 x 4 voxels side by side, one voxel from the border; walls are voxel faces.
class LabelsCheckTest : public ::testing::Test {
protected:
    LabelsCheckTest() : map_(6 * 6 * 6) {
        geometry_.size = {6, 6, 6};
        geometry_.indexToPhysical = Mat3::diagonal(1, -1.5, 2);
        for (std::int64_t k = 0; k < 6; ++k) {
            for (std::int64_t j = 0; j < 6; ++j) {
                for (std::int64_t i = 0; i < 6; ++i) map_[i + 6 * (j + 6 * k)] = labelAt({i, j, k});
            }
        }
        addFaces();
    }

    static Label labelAt(const Index3& at) {
        for (const std::int64_t n : at) {
            if (n < 1 || n > 4) return 0;
        }
        return at[0] < 3 ? 3 : 8;
    }

    void addFaces() {
        for (std::int64_t k = 0; k < 5; ++k) {
            for (std::int64_t j = 0; j < 5; ++j) {
                for (std::int64_t i = 0; i < 5; ++i) {
                    for (int axis = 0; axis < 3; ++axis) {
                        Index3 next{i, j, k};
                        ++next[axis];
                        addFace({i, j, k}, axis, labelAt({i, j, k}), labelAt(next));
                    }
                }
            }
        }
    }

    void addFace(const Index3& at, int axis, Label from, Label to) {
        if (from == to) return;
        std::array<VertexId, 4> corners{};
        for (int n = 0; n < 4; ++n) {
            Index3 corner = at;  // the lattice of corners: one step above a voxel's own number
            ++corner[axis];
            corner[(axis + 1) % 3] += n == 1 || n == 2 ? 1 : 0;
            corner[(axis + 2) % 3] += n >= 2 ? 1 : 0;
            const auto [place, isNew] = numbers_.emplace(corner, std::ssize(complex_.points));
            if (isNew) {
                complex_.points.push_back(geometry_.toPhysical(
                    {double(corner[0]) - 0.5, double(corner[1]) - 0.5, double(corner[2]) - 0.5}));
            }
            corners[n] = place->second;
        }
        bool isTurned = geometry_.isMirrored();
        if (to != 0 && (from == 0 || to < from)) {
            std::swap(from, to);
            isTurned = !isTurned;
        }
        if (isTurned) std::swap(corners[1], corners[3]);
        complex_.triangles.push_back({corners[0], corners[1], corners[2]});
        complex_.triangles.push_back({corners[0], corners[2], corners[3]});
        complex_.labels.insert(complex_.labels.end(), 2, {from, to});
    }

    /// Which of the four checks fail.
    std::vector<int> failing() {
        LabelsRun run{options_, "out"};
        run.map.geometry = geometry_;
        for (const Label label : {3, 8}) {
            Region& region = run.regions.emplace_back();
            region.label = label;
            for (RegionMeasure& measure : measureRegions(complex_)) {
                if (measure.label == label) region.measure = measure;
            }
        }
        const RegionSurfaces surfaces(complex_, labelsOf(run.regions));
        checkComplex(complex_, surfaces, {map_.data(), geometry_}, run);
        std::vector<int> failing;
        for (std::size_t n = 0; n < run.checks.size(); ++n) {
            if (run.checks[n].isPassed) continue;
            failing.push_back(static_cast<int>(n));
            EXPECT_FALSE(run.checks[n].finding.empty());
            EXPECT_FALSE(run.checks[n].pointsMm.empty());
        }
        EXPECT_EQ(run.checks.size(), 4u);
        EXPECT_EQ(run.holdsPromises(), failing.empty());
        return failing;
    }

    using Failing = std::vector<int>;
    static constexpr int kSurfaces = 0, kSides = 1, kCrossings = 2, kCentres = 3;

    LabelsOptions options_;
    ImageGeometry geometry_;
    std::vector<Label> map_;
    std::map<Index3, VertexId> numbers_;
    LabelComplex complex_;
};

TEST_F(LabelsCheckTest, SoundWallsPass) {
    EXPECT_EQ(failing(), Failing{});
}

TEST_F(LabelsCheckTest, AHoleIsFound) {
    complex_.triangles.pop_back();
    complex_.labels.pop_back();
    const Failing found = failing();
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front(), kSurfaces);
}

TEST_F(LabelsCheckTest, ATriangleTheWrongWayRoundIsFound) {
    std::swap(complex_.triangles[5][0], complex_.triangles[5][1]);
    EXPECT_EQ(failing().front(), kSurfaces);
}

TEST_F(LabelsCheckTest, WallsInsideOutAreFound) {
    for (auto& labels : complex_.labels) std::swap(labels[0], labels[1]);
    EXPECT_EQ(failing(), (Failing{kSurfaces, kCentres}));
}

TEST_F(LabelsCheckTest, AWallOfOneRegionIsFound) {
    complex_.labels.front() = {3, 3};
    const Failing found = failing();
    EXPECT_NE(std::find(found.begin(), found.end(), kSides), found.end());
}

TEST_F(LabelsCheckTest, CrossingWallsAreFound) {
    // a corner of one side pushed through the wall between and out at the other side
    const VertexId corner = numbers_.at({1, 2, 2});
    complex_.points[corner] = complex_.points[corner] + Vec3{9, 0, 0};
    const Failing found = failing();
    EXPECT_NE(std::find(found.begin(), found.end(), kCrossings), found.end());
}

TEST_F(LabelsCheckTest, ACentreOnTheWrongSideIsFound) {
    map_[2 + 6 * (2 + 6 * 2)] = 8;
    EXPECT_EQ(failing(), Failing{kCentres});
}

TEST_F(LabelsCheckTest, ALostRegionIsFound) {
    for (auto& labels : complex_.labels) {
        for (Label& label : labels) label = label == 8 ? 5 : label;
    }
    EXPECT_EQ(failing().front(), kSurfaces);
}

}  // namespace
}  // namespace adaptiso::labels
