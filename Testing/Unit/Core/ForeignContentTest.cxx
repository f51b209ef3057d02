#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "adaptiso/Core/ForeignContent.h"

namespace adaptiso::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;

const std::string kLfsPointer =
    "version https://git-lfs.github.com/spec/v1\n"
    "oid sha256:4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a4d7a\nsize 1234\n";

std::string lineOf(const std::optional<ForeignContent>& content) {
    return content ? content->fault + "; " + content->remedy : "";
}

std::string tarOf(const std::string& name) {
    std::string block(512, '\0');
    return block.replace(0, name.size(), name).replace(257, 5, "ustar");
}

class ForeignFiles : public ::testing::Test {
protected:
    void SetUp() override {
        // a folder each: ctest runs them side by side
        folder_ = fs::path(::testing::TempDir()) /
                  ::testing::UnitTest::GetInstance()->current_test_info()->name();
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path put(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    fs::path folder_;
};

TEST(ForeignContent, NamesPackingsAndTheCommandThatUnpacksThem) {
    struct Case {
        std::string bytes, line;
    };
    const std::vector<Case> cases{
        {"BZh91AY&SY\x12"s, "is packed with bzip2; unpack it: bunzip2 -k a.nii"},
        {"\xFD"
         "7zXZ\0\0\4"s,
         "is packed with xz; unpack it: unxz -k a.nii"},
        {"\x28\xB5\x2F\xFD\x24"s, "is packed with Zstandard; unpack it: unzstd a.nii"},
        {"\x1F\x8B\x08"s, "is packed with gzip; unpack it: gunzip -k a.nii"},
        {"PK\x03\x04\x14"s, "is a zip archive; unpack it: unzip a.nii"},
        {"7z\xBC\xAF\x27\x1C"s, "is a 7z archive; unpack it: 7z x a.nii"},
        {"Rar!\x1A\x07\1"s, "is a rar archive; unpack it: unrar x a.nii"},
        {tarOf("x.nii"), "is a tar archive; unpack it: tar -xf a.nii"}};
    for (const Case& each : cases) {
        const auto content = foreignContentOf(each.bytes, "folder/a.nii");
        EXPECT_EQ(lineOf(content), each.line);
        EXPECT_EQ(content.value_or(ForeignContent{}).kind, ForeignKind::Packed) << each.line;
    }
    EXPECT_EQ(lineOf(foreignContentOf(tarOf("x"), "a.nii.gz", true)),
              "is a tar archive packed with gzip; unpack it: tar -xzf a.nii.gz");
    EXPECT_EQ(lineOf(foreignContentOf("PK\x03\x04", "a.nii.gz", true)),
              "is packed with gzip, and what is inside is a zip archive; unpack it: unzip a.nii");
}

TEST(ForeignContent, PutsNoNameIntoCommandsThatAShellWouldCutUp) {
    EXPECT_EQ(lineOf(foreignContentOf("BZh91AY&SY", "my scan; rm -r.nii")),
              "is packed with bzip2; unpack it: bunzip2 -k FILE");
    EXPECT_EQ(lineOf(foreignContentOf("BZh91AY&SY", "-f.nii")),
              "is packed with bzip2; unpack it: bunzip2 -k FILE");
}

TEST(ForeignContent, TellsPointersFromData) {
    const std::string annex =
        "fetch them: git annex get x.stl, or datalad get x.stl, in their folder";
    EXPECT_EQ(
        lineOf(foreignContentOf(kLfsPointer, "x.stl")),
        "is a git-lfs pointer, its 1234 bytes of data are not here; fetch them: git lfs pull, "
        "in their repository");
    EXPECT_EQ(lineOf(foreignContentOf("/annex/objects/SHA256E-s77--ab12.nii.gz\n", "x.stl")),
              "is a git-annex pointer, its 77 bytes of data are not here; " + annex);
    EXPECT_EQ(lineOf(foreignContentOf("../.git/annex/objects/Gz/9x/MD5E-s5--a.nii/MD5E-s5--a.nii",
                                      "x.stl")),
              "is a git-annex pointer, its 5 bytes of data are not here; " + annex);
    EXPECT_NE(lineOf(foreignContentOf("../raw/x.stl", "x.stl")).find("a link that git checked out"),
              std::string::npos);
    EXPECT_NE(
        lineOf(foreignContentOf("outs:\n- md5: ab\n  size: 3\n", "x.stl")).find("dvc pull x.stl"),
        std::string::npos);
}

TEST(ForeignContent, KnowsServersAnswers) {
    for (const std::string page :
         {"<!DOCTYPE html><html>", "\xEF\xBB\xBF\r\n <HTML lang='de'>",
          "<?xml version='1.0'?>\n<!DOCTYPE html PUBLIC>", "<!-- a --><html>"}) {
        EXPECT_EQ(lineOf(foreignContentOf(page, "x.nii")),
                  "is a web page; download the file again, logged in where it needs that")
            << page;
    }
    for (const std::string text :
         {"404: Not Found", "<?xml version=\"1.0\"?><Error><Code>AccessDenied</Code></Error>"}) {
        EXPECT_NE(lineOf(foreignContentOf(text, "x.nii")).find("error message of a server"),
                  std::string::npos)
            << text;
    }
    EXPECT_NE(lineOf(foreignContentOf("{\"message\": \"Not Found\"}", "x.nii")).find("JSON"),
              std::string::npos);
}

TEST(ForeignContent, LeavesWhatReadersKnow) {
    for (const std::string& head :
         {"NRRD0004\ntype: short"s, "ObjectType = Image"s, "ply\nformat ascii 1.0"s, "solid a\n"s,
          "# vtk DataFile Version 3.0"s, "<?xml version=\"1.0\"?>\n<VTKFile"s, "\xFF\xFF\xFE by x"s,
          "404 1 2\n3 4 5\n"s, "- 12\n0 0 0"s, "some text"s, "\\\x01\0\0\0\0"s}) {
        EXPECT_EQ(lineOf(foreignContentOf(head, "x")), "") << head;
    }
}

TEST_F(ForeignFiles, OfZerosAloneAreToldWhateverTheirLength) {
    std::string bytes(3'000'000, '\0');
    const std::string line =
        "holds zeros alone: its copy or download broke off; get the file again";
    EXPECT_EQ(lineOf(findForeignContent(put("a.nii", bytes))), line);
    EXPECT_EQ(lineOf(findForeignContent(put("b.nii", std::string(3, '\0')))), line);
    bytes.back() = 1;
    EXPECT_EQ(lineOf(findForeignContent(put("c.nii", bytes))), "");
    EXPECT_EQ(lineOf(findForeignContent(put("d.nii", ""))), "is an empty file; get the file again");
}

TEST_F(ForeignFiles, OfGitAnnexAreNamedWhereTheirLinkLeadsNowhere) {
    fs::create_symlink("../.git/annex/objects/a/b/MD5E-s12--c.nii/MD5E-s12--c.nii",
                       folder_ / "a.nii");
    fs::create_symlink("nowhere", folder_ / "b.nii");
    EXPECT_EQ(
        lineOf(findForeignContent(folder_ / "a.nii")),
        "is a git-annex pointer, its 12 bytes of data are not here; fetch them: git annex get "
        "a.nii, or datalad get a.nii, in their folder");
    EXPECT_EQ(lineOf(findForeignContent(folder_ / "b.nii")), "");
    EXPECT_EQ(lineOf(findForeignContent(folder_ / "missing")), "");
    EXPECT_EQ(lineOf(findForeignContent(folder_)), "");
}

TEST_F(ForeignFiles, OfCloudFoldersAreToldByTheirNames) {
    EXPECT_NE(lineOf(findForeignContent(put(".IM1.dcm.icloud", "bplist00\xD1"))).find("iCloud"),
              std::string::npos);
    EXPECT_NE(
        lineOf(findForeignContent(put("a.nii.nextcloud", " "))).find("placeholder of a cloud"),
        std::string::npos);
}

}  // namespace
}  // namespace adaptiso::testing
