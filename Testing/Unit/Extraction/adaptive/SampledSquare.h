#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptive/collapse/ChangedStar.h"

namespace adaptiso::testing {

/// A square of 4 x 4 cells at z = 0, 1 mm each, with a sample at each vertex, and the star of the
/// vertex at (2, 2).
struct SampledSquare {
    detail::Patch patch = patchOf(planeMesh(4, 4));
    detail::ChangedStar changed;
    static constexpr std::uint32_t kMiddle = 12;

    SampledSquare() {
        addSamples(patch);
        EXPECT_TRUE(detail::PatchTopology(patch).starOf(kMiddle, changed.star));
        shape({2, 2, 0});
    }
    void shape(const Vec3& vertex) {
        changed.vertex = vertex;
        EXPECT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
    }
    /// At (2.4, 2.2), assigned to the star's triangle there. \return its number
    std::size_t addSample(double height) {
        detail::Sample& sample = patch.samples.emplace_back();
        sample.setPoint({2.4, 2.2, height});
        sample.setNormal({0, 0, 1});
        const auto at = std::find(patch.triangles.begin(), patch.triangles.end(),
                                  std::array<std::uint32_t, 3>{kMiddle, 13, 18});
        patch.sampleTriangle.push_back(static_cast<std::uint32_t>(at - patch.triangles.begin()));
        return patch.samples.size() - 1;
    }
};

}  // namespace adaptiso::testing
