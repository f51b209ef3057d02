#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "Support/Meshes.h"
#include "Support/Pages.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

CheckRules allOf(Profile profile) {
    CheckRules rules;
    rules.profile = profile;
    rules.measuresWalls = true;
    return rules;
}

std::set<std::string_view> keysOf(const std::vector<Check>& checks) {
    std::set<std::string_view> keys;
    for (const Check& check : checks) keys.insert(check.key);
    return keys;
}

TEST(CheckRules, HaveARowForEveryCheckAndNoOther) {
    TriangleMesh ball = testing::icosphere(3, {}, 80);
    const CheckRules rules = allOf(Profile::Bem);
    SurfaceFacts facts = measureSurface(ball, sizeLimitsOf(Profile::Bem), 10);
    measureWallsOf(ball, rules.wallLimitMm(), facts);
    std::set<std::string_view> keys = keysOf(judgeSurface(facts, rules)), rows;
    keys.insert(judgeDeviation({}, 1, rules).key);
    keys.merge(keysOf(judgeNesting(NestingReport{}, "a", "b", {}, rules)));
    for (const CheckRule& rule : checkRules()) rows.insert(rule.key);
    EXPECT_EQ(keys, rows);
    EXPECT_EQ(rows.size(), checkRules().size());
}

TEST(CheckRules, AreRequiredByTheProfilesOfTheirRow) {
    TriangleMesh ball = testing::icosphere(3, {}, 80);
    const SurfaceFacts facts = measureSurface(ball, {}, 10);
    for (const Profile profile : {Profile::Bem, Profile::Print, Profile::View}) {
        for (const Check& check : judgeSurface(facts, allOf(profile))) {
            const auto row = std::ranges::find(checkRules(), check.key, &CheckRule::key);
            ASSERT_NE(row, checkRules().end()) << check.key;
            EXPECT_EQ(check.isRequired, row->isRequiredBy(profile)) << check.key;
            EXPECT_EQ(check.name, row->name);
        }
    }
}

TEST(CheckRules, StandInTheTableOfTheirPage) {
    std::string table;
    for (const CheckRule& rule : checkRules()) {
        table += "| `" + std::string(rule.key) + "` | " + std::string(rule.meaning) + " |";
        for (const bool isRequired : {rule.bem, rule.print, rule.view}) {
            table += isRequired ? " x |" : " |";
        }
        table += "\n";
    }
    testing::expectOnPage(CHECK_PAGE, "| `finiteCoordinates`", "\nA profile says", table);
}

TEST(CheckRules, InUseFillInEveryDefault) {
    CheckRules rules;
    EXPECT_EQ(rules.inUse().profile, Profile::Print);
    EXPECT_EQ(rules.inUse().minGapMm, CheckRules::kLeastGapMm);
    EXPECT_EQ(rules.inUse().minAngleDeg, CheckRules::kLeastAngleDeg);
    EXPECT_FALSE(rules.inUse().minWallMm);
    rules.isNested = rules.measuresWalls = true;
    rules.minAngleDeg = 3;
    EXPECT_EQ(rules.inUse().profile, Profile::Bem);
    EXPECT_EQ(rules.inUse().minAngleDeg, 3);
    EXPECT_EQ(rules.inUse().minWallMm, CheckRules::kDefaultMinWallMm);
}

}  // namespace
}  // namespace adaptiso
