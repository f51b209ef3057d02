#include "BoundaryTestSupport.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/Nesting.h"

namespace adaptiso::testing {

HeadShapes smallHead() {
    return sphericalHead(kCentre, 26, 30, 35);
}

BoundaryOptions quick() {
    BoundaryOptions options;
    options.closingMm = 5;
    return options;
}

double largestError(const HeadBoundaries& head, const HeadShapes& truth) {
    return std::max({surfaceError(head.solids[0], truth.innerSkull).largestMm,
                     surfaceError(head.solids[1], truth.outerSkull).largestMm,
                     surfaceError(head.solids[2], truth.skin).largestMm});
}

std::vector<double> gapsOf(const HeadBoundaries& head) {
    std::vector<double> gaps;
    for (std::size_t n = 0; n + 1 < head.solids.size(); ++n) {
        const NestingReport nesting =
            checkNesting(surfaceOf(head.solids[n]), surfaceOf(head.solids[n + 1]));
        EXPECT_TRUE(nesting.isStrictlyNested());
        gaps.push_back(nesting.gap.nearest.distanceMm);
    }
    return gaps;
}

void expectRefused(const std::function<void()>& call, const std::string& message) {
    try {
        call();
        ADD_FAILURE() << "should say: " << message;
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
}

}  // namespace adaptiso::testing
