#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::testing {

/// A label map and its samples.
struct Map {
    ImageGeometry geometry;
    std::vector<Label> labels;

    Map(const ImageGeometry& of, const std::function<Label(const Index3&)>& labelAt)
        : geometry(of) {
        for (std::int64_t k = 0; k < of.size[2]; ++k) {
            for (std::int64_t j = 0; j < of.size[1]; ++j) {
                for (std::int64_t i = 0; i < of.size[0]; ++i) labels.push_back(labelAt({i, j, k}));
            }
        }
    }
    static Map inSpace(const ImageGeometry& of, const std::function<Label(const Vec3&)>& labelAt) {
        return {of, [&](const Index3& index) {
                    return labelAt(
                        of.toPhysical({static_cast<double>(index[0]), static_cast<double>(index[1]),
                                       static_cast<double>(index[2])}));
                }};
    }
    VolumeView view() const { return {labels.data(), geometry}; }
    Label at(std::int64_t i, std::int64_t j, std::int64_t k) const {
        const Index3& n = geometry.size;
        const bool isInside = i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2];
        return isInside ? labels[i + n[0] * (j + n[1] * k)] : 0;
    }
    Vec3 centre(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return geometry.toPhysical(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
    }
};

/// Random labels 0 ... kinds - 1.
Map noise(const ImageGeometry& geometry, int kinds, std::uint64_t seed);

/// Cells of random sites, in a long map: it is simplified in several cubes side by side.
Map longCells(const ImageGeometry& geometry, std::uint64_t seed);

/// Two half-balls that meet in the plane x = 0, half-way between voxel centres.
Map halfBalls(double radius);

LabelOptions fullResolution();

/// Everything that extractLabels promises of any map.
::testing::AssertionResult keepsPromises(const Map& map, const LabelOptions& options = {});

}  // namespace adaptiso::testing
