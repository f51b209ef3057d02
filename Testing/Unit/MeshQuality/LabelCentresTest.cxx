#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/LabelCentres.h"

namespace adaptiso {
namespace {

/// The faces between voxels of different labels, two triangles each: right by construction. The
/// lines of voxels run through the middle of faces, where their two triangles meet.
struct VoxelFaces {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    std::vector<std::array<std::int32_t, 2>> labels;

    VoxelFaces(const std::vector<std::int32_t>& map, const ImageGeometry& geometry) {
        const Index3& size = geometry.size;
        const auto labelAt = [&](Index3 v) {
            for (int axis = 0; axis < 3; ++axis) {
                if (v[axis] < 0 || v[axis] >= size[axis]) return 0;
            }
            return map[v[0] + size[0] * (v[1] + size[1] * v[2])];
        };
        for (std::int64_t k = -1; k < size[2]; ++k) {
            for (std::int64_t j = -1; j < size[1]; ++j) {
                for (std::int64_t i = -1; i < size[0]; ++i) {
                    for (int axis = 0; axis < 3; ++axis) {
                        Index3 next{i, j, k};
                        ++next[axis];
                        const std::int32_t a = labelAt({i, j, k}), b = labelAt(next);
                        if (a != b) addFace(Index3{i, j, k}, axis, a, b, geometry);
                    }
                }
            }
        }
    }
    LabelledWalls walls() const { return {points, triangles, labels}; }

private:
    void addFace(const Index3& voxel, int axis, std::int32_t from, std::int32_t to,
                 const ImageGeometry& geometry) {
        std::array<VertexId, 4> corners;
        for (int n = 0; n < 4; ++n) {
            Index3 at{2 * voxel[0], 2 * voxel[1], 2 * voxel[2]};  // in half voxels
            at[axis] += 1;
            at[(axis + 1) % 3] += n == 1 || n == 2 ? 1 : -1;
            at[(axis + 2) % 3] += n >= 2 ? 1 : -1;
            const auto [place, isNew] = numbers_.emplace(at, std::ssize(points));
            if (isNew) {
                points.push_back(geometry.toPhysical(
                    {0.5 * double(at[0]), 0.5 * double(at[1]), 0.5 * double(at[2])}));
            }
            corners[n] = place->second;
        }
        // counter-clockwise seen from the next voxel
        if (geometry.isMirrored()) std::swap(corners[1], corners[3]);
        triangles.push_back({corners[0], corners[1], corners[2]});
        triangles.push_back({corners[0], corners[2], corners[3]});
        labels.insert(labels.end(), 2, {from, to});
    }

    std::map<Index3, VertexId> numbers_;
};

ImageGeometry geometryOf(int kind, const Index3& size) {
    const Mat3 steps[] = {Mat3::diagonal(1, 1, 1),
                          Mat3::diagonal(-0.7, 1.3, 2),
                          {{Vec3{0.9, 0.3, 0.1}, Vec3{-0.2, 1.1, 0.4}, Vec3{0.3, 0.1, -1.5}}}};
    return {size, {-12.25, 7.5, 31.125}, steps[kind]};
}

std::vector<std::int32_t> noise(std::mt19937& random, const Index3& size, int labels) {
    std::vector<std::int32_t> map(static_cast<std::size_t>(size[0] * size[1] * size[2]));
    for (std::int32_t& label : map) label = static_cast<std::int32_t>(random() % labels);
    return map;
}

std::vector<std::int32_t> labelsOf(const std::vector<std::int32_t>& map) {
    std::set<std::int32_t> labels(map.begin(), map.end());
    labels.erase(0);
    return {labels.begin(), labels.end()};
}

TEST(LabelCentres, AreRightWithinVoxelFaces) {
    std::mt19937 random(1);
    for (int round = 0; round < 60; ++round) {
        const Index3 size{1 + round % 5, 1 + round % 4, 1 + round % 7};
        const ImageGeometry geometry = geometryOf(round % 3, size);
        const auto map = noise(random, size, 5);
        const VoxelFaces faces(map, geometry);
        EXPECT_EQ(
            findMislabelledCentres(faces.walls(), {map.data(), geometry}, labelsOf(map)).count, 0)
            << round;
    }
}

TEST(LabelCentres, AreWrongWhereTheMapSaysOtherwise) {
    std::mt19937 random(2);
    const Index3 size{6, 5, 4};
    for (int kind = 0; kind < 3; ++kind) {
        const ImageGeometry geometry = geometryOf(kind, size);
        const auto map = noise(random, size, 4);
        const VoxelFaces faces(map, geometry);
        auto other = map;
        const std::size_t changed[] = {7, 50, 119};
        for (const std::size_t n : changed) other[n] = map[n] == 3 ? 1 : map[n] + 1;
        const MislabelledCentres found =
            findMislabelledCentres(faces.walls(), {other.data(), geometry}, {1, 2, 3});
        EXPECT_EQ(found.count, 3);
        EXPECT_EQ(found.first, (Index3{1, 1, 0}));
    }
}

TEST(LabelCentres, AreWrongWhereAWallHasMovedAcrossOne) {
    const Index3 size{5, 5, 5};
    const ImageGeometry geometry = geometryOf(2, size);
    std::vector<std::int32_t> map(125, 0);
    map[62] = 7;  // the middle voxel
    VoxelFaces faces(map, geometry);
    ASSERT_EQ(faces.points.size(), 8U);
    const auto count = [&] {
        return findMislabelledCentres(faces.walls(), {map.data(), geometry}, {7}).count;
    };
    EXPECT_EQ(count(), 0);
    // by 0.9 of a voxel: beyond its own centre and the next one
    for (Vec3& point : faces.points) point = point + geometry.indexToPhysical * Vec3{0.9, 0, 0};
    EXPECT_EQ(count(), 2) << "the voxel and the next one";
    for (auto& labels : faces.labels) std::swap(labels[0], labels[1]);
    EXPECT_GE(count(), 1) << "inside out";
}

TEST(LabelCentres, OfChosenRegionsNeedTheirWallsAlone) {
    std::mt19937 random(3);
    const Index3 size{5, 6, 7};
    const ImageGeometry geometry = geometryOf(1, size);
    const auto map = noise(random, size, 5);
    VoxelFaces faces(map, geometry);
    for (std::size_t t = faces.triangles.size(); t-- > 0;) {
        const auto [a, b] = faces.labels[t];
        if (a == 2 || b == 2) continue;
        faces.triangles.erase(faces.triangles.begin() + static_cast<std::ptrdiff_t>(t));
        faces.labels.erase(faces.labels.begin() + static_cast<std::ptrdiff_t>(t));
    }
    EXPECT_EQ(findMislabelledCentres(faces.walls(), {map.data(), geometry}, {2}).count, 0);
    EXPECT_GT(findMislabelledCentres(faces.walls(), {map.data(), geometry}, {1, 2}).count, 0);
}

TEST(LabelCentres, RefuseWallsThatAreNone) {
    const std::vector<std::int32_t> map(8, 1);
    const ImageGeometry geometry = geometryOf(0, {2, 2, 2});
    VoxelFaces faces(map, geometry);
    faces.labels.pop_back();
    EXPECT_THROW(findMislabelledCentres(faces.walls(), {map.data(), geometry}, {1}), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
