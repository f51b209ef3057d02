#include <gtest/gtest.h>

#include <algorithm>

#include "Support/Meshes.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

TEST(AreaCheck, IsAskedWithTheLimitOfItsRow) {
    TriangleMesh ball = testing::icosphere(3, {}, 80);
    const SurfaceFacts facts = measureSurface(ball, {}, 10);
    const auto row = std::ranges::find(
        ruleOptions(), "max-area", [](const Option<CheckRules>& each) { return each.facts.name; });
    ASSERT_NE(row, ruleOptions().end());
    for (const double limitMm2 : {facts.areaMm2 / 2, facts.areaMm2 * 2}) {
        CheckRules rules;
        row->put(rules, limitMm2);
        const std::vector<Check> checks = judgeSurface(facts, rules);
        const auto check = std::ranges::find(checks, "area", &Check::key);
        ASSERT_NE(check, checks.end());
        EXPECT_EQ(check->hasFailed(), limitMm2 < facts.areaMm2);
    }
}

}  // namespace
}  // namespace adaptiso
