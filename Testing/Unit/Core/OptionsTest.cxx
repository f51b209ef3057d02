#include <gtest/gtest.h>

#include <array>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/SimplifyAims.h"

namespace adaptiso {
namespace {

enum class Shape { Round, Flat };

struct Settings {
    bool isQuick = false;
    double lengthMm = 2;
    std::optional<double> angleDeg;
    std::optional<std::int64_t> count;
    Shape shape = Shape::Round;
    int side = 4;
    std::string name;
};

constexpr std::array<std::string_view, 2> kShapes{"round", "flat"}, kSides{"4", "8"};

Options<Settings> settingsOptions() {
    return {option<&Settings::isQuick>({.name = "quick"}),
            option<&Settings::lengthMm>({.name = "length"}),
            option<&Settings::angleDeg>({.name = "angle"}),
            option<&Settings::count>({.name = "count"}),
            option<&Settings::shape>({.name = "shape", .words = kShapes}),
            option<&Settings::side>({.name = "side", .words = kSides}),
            option<&Settings::name>({.name = "name"})};
}

TEST(Options, KindsFollowFromTheMember) {
    constexpr std::array kKinds{OptionKind::Flag,  OptionKind::Number, OptionKind::Number,
                                OptionKind::Count, OptionKind::Choice, OptionKind::Choice,
                                OptionKind::Text};
    const auto rows = settingsOptions();
    for (std::size_t n = 0; n < rows.size(); ++n) {
        EXPECT_EQ(rows[n].kind, kKinds[n]) << rows[n].facts.name;
        EXPECT_EQ(rows[n].isOptional, n == 2 || n == 3) << rows[n].facts.name;
    }
}

TEST(Options, AreReadAndPut) {
    const auto rows = settingsOptions();
    Settings settings;
    const std::array<OptionValue, 7> defaults{
        false,           2.0,          std::monostate{}, std::monostate{}, std::string("round"),
        std::int64_t{4}, std::string()};
    const std::array<OptionValue, 7> others{
        true, 3.5, 30.0, std::int64_t{7}, std::string("flat"), std::string("8"), std::string("x")};
    for (std::size_t n = 0; n < rows.size(); ++n) {
        EXPECT_EQ(rows[n].valueOf(settings), defaults[n]) << rows[n].facts.name;
        rows[n].put(settings, others[n]);
    }
    EXPECT_TRUE(settings.isQuick);
    EXPECT_EQ(settings.lengthMm, 3.5);
    EXPECT_EQ(settings.angleDeg, 30);
    EXPECT_EQ(settings.count, 7);
    EXPECT_EQ(settings.shape, Shape::Flat);
    EXPECT_EQ(settings.side, 8);
    EXPECT_EQ(settings.name, "x");
    rows[2].put(settings, {});
    EXPECT_FALSE(settings.angleDeg);
}

TEST(Options, RulesInWordsAreTheRulesKept) {
    const NumberRule above{.least = 0, .isAbove = true, .unit = "mm"};
    EXPECT_EQ(toWords(above), "a number above 0, in mm");
    EXPECT_FALSE(above.allows(0));
    EXPECT_TRUE(above.allows(1e-300));
    const NumberRule range{.least = 0, .most = 40, .unit = "degrees"};
    EXPECT_EQ(toWords(range), "a number from 0 to 40, in degrees");
    EXPECT_TRUE(range.allows(0));
    EXPECT_TRUE(range.allows(40));
    EXPECT_FALSE(range.allows(40.1));
    EXPECT_EQ(toWords({}), "a finite number");
    EXPECT_EQ(countRule(0, kAnyCount), "a whole number, 0 or more");
    EXPECT_EQ(countRule(1, 3), "a whole number from 1 to 3");
}

TEST(Options, HelpHasRuleAndDefault) {
    EXPECT_EQ(
        helpText({.name = "a", .help = "Turn", .standard = "0", .rule = {.least = 0, .most = 9}},
                 OptionKind::Number),
        "Turn (a number from 0 to 9; default: 0)");
    EXPECT_EQ(helpText({.name = "a", .help = "Turn"}, OptionKind::Flag), "Turn");
}

TEST(SimplifyAims, OfEverySurfaceHaveOneName) {
    for (const auto surface : {AimedSurface::OfScan, AimedSurface::Mesh, AimedSurface::Walls}) {
        const auto& rows = aimOptions(surface);
        ASSERT_EQ(rows.size(), 4u);
        constexpr std::array<std::string_view, 4> kNames{"max-error", "triangles", "reduction",
                                                         "min-angle"};
        for (std::size_t n = 0; n < rows.size(); ++n) EXPECT_EQ(rows[n].facts.name, kNames[n]);
        EXPECT_EQ(rows[0].facts.rule.allows(0), surface == AimedSurface::Walls);
    }
}

TEST(SimplifyAims, OutOfRangeAreRefusedByName) {
    SimplifyAims aims;
    requireInRange(aims, "f");
    aims.maxErrorMm = 0;
    EXPECT_THROW(requireInRange(aims, "f"), InvalidInput);
    EXPECT_NO_THROW(requireInRange(aims, "f", true));
    aims = {};
    aims.minAngleDeg = 41;
    try {
        requireInRange(aims, "f");
        ADD_FAILURE() << "41 degrees were taken";
    } catch (const InvalidInput& refusal) {
        EXPECT_STREQ(refusal.what(), "f: minAngleDeg must lie between 0 and 40");
    }
}

}  // namespace
}  // namespace adaptiso
