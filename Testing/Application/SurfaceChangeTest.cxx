#include <gtest/gtest.h>

#include "Common/SurfaceChange.h"
#include "Support/Pages.h"

namespace adaptiso {
namespace {

TEST(SummaryFigures, StandInTheTableOfTheirPage) {
    const std::string lines = figureLines(summaryFigures(), ".");
    const std::string folder = APPLICATIONS;
    testing::expectOnPage((folder + "/adaptiso-simplify/README.md").c_str(), "| `.file`",
                          "| `input.sound`", lines);
    testing::expectOnPage((folder + "/adaptiso-mend/README.md").c_str(), "| `.file`", "| `found`",
                          lines);
}

}  // namespace
}  // namespace adaptiso
