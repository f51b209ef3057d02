#include <gtest/gtest.h>

#include <algorithm>

#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {
namespace {

TEST(RadiusEdge, GoesFromItsRowToTheMesher) {
    const auto row =
        std::ranges::find(elementOptions(), "radius-edge",
                          [](const Option<MesherOptions>& each) { return each.facts.name; });
    ASSERT_NE(row, elementOptions().end());
    EXPECT_EQ(helpText(row->facts, row->kind),
              "Largest radius by shortest edge (a number above 1; default: 1.4)");
    MesherOptions options;
    options.mesher = "tetgen";
    row->put(options, 1.2);
    EXPECT_EQ(mesherRun({}, options).arguments.front(), "-pq1.2/10aAQ");
}

}  // namespace
}  // namespace adaptiso
