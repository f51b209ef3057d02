#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class FindLabelTables : public testing::Test {
protected:
    FindLabelTables() { fs::create_directories(folder_); }
    ~FindLabelTables() override { fs::remove_all(folder_); }

    fs::path write(const fs::path& name, const std::string& bytes) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }
    /// The name that is found for the value 1 of an image.
    std::string nameFor(const fs::path& image) const {
        const FoundLabelTables found = findLabelTables(folder_ / image);
        const LabelEntry* const entry = found.table.find(1);
        return entry == nullptr ? "" : entry->name;
    }

    fs::path folder_ = fs::temp_directory_path() / ("labels-" + std::to_string(getpid()));
};

TEST_F(FindLabelTables, ByTheImagesName) {
    for (const char* const name : {"a.tsv", "b.txt", "c.nii.txt", "d.ctbl", "e_lut.txt"}) {
        write(name,
              std::string(name).ends_with(".tsv") ? "index\tname\n1\tone\n" : "1 one\n2 two\n");
    }
    for (const char* const image : {"a.nii.gz", "b.nii", "c.nii.gz", "d.nrrd", "e.mgz"}) {
        EXPECT_EQ(nameFor(image), "one") << image;
    }
    EXPECT_EQ(nameFor("f.nii"), "");
}

TEST_F(FindLabelTables, NamesFromOneAndColorsFromAnother) {
    std::string colors(768, '\0');
    colors[1] = colors[256 + 1] = colors[512 + 1] = '\x7f';
    colors[9] = '\xff';
    write("x.nii.lut", colors);
    write("x.nii.txt", "1 one 2001\n2 two 2002\n");
    const FoundLabelTables found = findLabelTables(folder_ / "x.nii.gz");
    EXPECT_EQ(found.files.size(), 2U);
    EXPECT_EQ(*found.table.find(1), (LabelEntry{1, "one", "", LabelColor{127, 127, 127}}));
    EXPECT_EQ(*found.table.find(9), (LabelEntry{9, "", "", LabelColor{255, 0, 0}}));
}

TEST_F(FindLabelTables, PassesOverWhatIsNoTableAndTellsOfFaults) {
    write("x.json", "{\"Manufacturer\": \"y\"}");
    write("x.txt", "some notes\n");
    EXPECT_TRUE(findLabelTables(folder_ / "x.nii").files.empty());
    EXPECT_TRUE(findLabelTables(folder_ / "x.nii").table.warnings.empty());
    write("x.tsv", "index\tname\nnine\tb\n");
    const FoundLabelTables found = findLabelTables(folder_ / "x.nii");
    ASSERT_EQ(found.table.warnings.size(), 1U);
    EXPECT_NE(found.table.warnings[0].text.find("x.tsv: line 2"), std::string::npos);
    EXPECT_EQ(found.table.warnings[0].text.find('/'), std::string::npos);
    EXPECT_TRUE(found.table.entries.empty());
}

TEST_F(FindLabelTables, WarnsOfColumnsThatAreNotKnownAndOfUtf16) {
    const auto textFor = [&] {
        const FoundLabelTables found = findLabelTables(folder_ / "y.nii");
        EXPECT_TRUE(found.table.entries.empty());
        return found.table.warnings.empty() ? "none" : found.table.warnings[0].line();
    };
    write("y.txt", "0 1000\n5 2000\n");  // b-values, say
    EXPECT_EQ(textFor(), "none");
    write("y.txt", "1 2001 Precentral_L\n2 2002 Precentral_R\n");
    EXPECT_NE(textFor().find("names are not used: y.txt: its columns"), std::string::npos);
    write("y.txt", std::string("\xFF\xFE"
                               "1\0 \0a\0",
                               8));
    EXPECT_NE(textFor().find("y.txt: is text in UTF-16; save it as UTF-8"), std::string::npos);
}

TEST_F(FindLabelTables, ByInheritanceInADataset) {
    const std::string anat = "sub-01/anat/";
    const std::string image = anat + "sub-01_space-T1w_desc-aseg_dseg.nii.gz";
    const auto table = [](const std::string& name) { return "index\tname\n1\t" + name + "\n"; };
    write("dseg.tsv", table("all"));
    EXPECT_EQ(nameFor(image), "") << "no dataset: nothing is looked for above";
    write("dataset_description.json", "{}");
    fs::create_directories(folder_ / anat);
    EXPECT_EQ(nameFor(image), "all");
    write("desc-aseg_dseg.tsv", table("aseg"));
    write("desc-aparc_dseg.tsv", table("aparc"));
    EXPECT_EQ(nameFor(image), "aseg");
    write(anat + "sub-01_dseg.tsv", table("subject"));
    EXPECT_EQ(nameFor(image), "subject");
    write(anat + "sub-01_space-T1w_desc-aseg_dseg.tsv", table("own"));
    EXPECT_EQ(nameFor(image), "own");
    EXPECT_EQ(nameFor(anat + "sub-01_desc-aseg_probseg.nii.gz"), "");
}

TEST_F(FindLabelTables, BesideMricronsAtlas) {
    const fs::path aal = "/usr/share/mricron/templates/aal.nii.gz";
    if (!fs::exists(aal)) GTEST_SKIP() << "mricron-data is not installed";
    const FoundLabelTables found = findLabelTables(aal);
    ASSERT_EQ(found.files.size(), 2U);
    EXPECT_EQ(found.files[0].filename(), "aal.nii.txt");
    EXPECT_EQ(found.files[1].filename(), "aal.nii.lut");
    EXPECT_EQ(*found.table.find(2),
              (LabelEntry{2, "Precentral_R", "", LabelColor{0xcc, 0xcc, 0xcc}}));
}

}  // namespace
}  // namespace adaptiso
