#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso {
namespace {

TEST(ListedTables, AreReadAndFoundBesideAnImage) {
    const std::string text = "labels in their order\nLeft femur\nRight femur\n";
    const LabelTable table = decodeLabelTable(text, "x");
    EXPECT_EQ(table.format, "listed names");
    ASSERT_EQ(table.entries.size(), 2U);
    EXPECT_EQ(table.entries[1], (LabelEntry{2, "Right femur", "", {}}));
    EXPECT_NE(labelTableNames().find("listed names"), std::string::npos);

    const std::filesystem::path folder = "recipe";
    std::filesystem::create_directory(folder);
    std::ofstream(folder / "seg.listed") << text;
    std::ofstream(folder / "seg.nii") << "x";
    EXPECT_EQ(findLabelTables(folder / "seg.nii").table.entries, table.entries);
}

}  // namespace
}  // namespace adaptiso
