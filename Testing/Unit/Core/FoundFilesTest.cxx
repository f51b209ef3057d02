#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class FoundFiles : public ::testing::Test {
protected:
    void SetUp() override {
        root_ = fs::temp_directory_path() / ("adaptiso-found-" + std::to_string(getpid()));
        fs::create_directories(root_ / "in/deep");
        fs::create_directories(root_ / "out");
        put("in/own", "own");
        put("in/deep/own", "deep");
        put("out/secret", "secret");
    }
    void TearDown() override { fs::remove_all(root_); }

    void put(const std::string& name, const std::string& text) {
        std::ofstream(root_ / name) << text;
    }
    void link(const std::string& target, const std::string& name) {
        fs::create_symlink(target, root_ / name);
    }

    fs::path root_;
};

TEST_F(FoundFiles, LieInAFolderWithAllLinksFollowed) {
    link("deep/own", "in/link");
    link("../out/secret", "in/leaves");
    link("../out", "in/folder");
    link("nowhere", "in/dangling");
    link("in", "way");
    const fs::path in = root_ / "in";
    for (const char* name : {"own", "deep/own", "link", "deep"}) {
        EXPECT_TRUE(liesIn(in / name, in)) << name;
        EXPECT_TRUE(liesIn(in / name, root_ / "way")) << name;
        EXPECT_NO_THROW(requireIn(in / name, in)) << name;
    }
    for (const char* name : {"leaves", "folder", "folder/secret", "../out/secret", "dangling"}) {
        EXPECT_FALSE(liesIn(in / name, in)) << name;
        EXPECT_THROW(requireIn(in / name, in), FileError) << name;
    }
    EXPECT_FALSE(liesIn(in, in));
    EXPECT_NO_THROW(requireIn(in / "missing", in));
}

TEST_F(FoundFiles, OfAnAnnexLieInItsObjects) {
    fs::create_directories(root_ / ".git/annex/objects/a");
    put(".git/annex/objects/a/key", "x");
    link("../.git/annex/objects/a/key", "in/annexed");
    EXPECT_TRUE(liesIn(root_ / "in/annexed", root_ / "in"));
}

TEST_F(FoundFiles, BesideALinkMayLieBesideItsTarget) {
    link("../out/secret", "in/image");
    put("out/names", "x");
    link("../out/names", "in/names");
    EXPECT_TRUE(liesBeside(root_ / "in/names", root_ / "in/image"));
    EXPECT_FALSE(liesBeside(root_ / "in/names", root_ / "in/own"));
    EXPECT_THROW(requireBeside(root_ / "in/names", root_ / "in/own"), FileError);
}

TEST_F(FoundFiles, OutputsHaveNoLinkBelowTheNamedFolder) {
    link("../out/secret", "in/table");
    link("../out", "in/sub");
    link("nowhere", "in/new");
    link("in", "way");
    const fs::path in = root_ / "in";
    EXPECT_NO_THROW(requireNoLink(in / "own", in));
    EXPECT_NO_THROW(requireNoLink(in / "deep/missing", in));
    EXPECT_NO_THROW(requireNoLink(root_ / "way/own", root_ / "way"));
    for (const char* name : {"table", "sub/a", "sub/deeper/a", "new", "./sub/../sub/a"}) {
        EXPECT_THROW(requireNoLink(in / name, in), FileError) << name;
    }
    const fs::path before = fs::current_path();
    fs::current_path(in);
    EXPECT_THROW(requireNoLink("table", ""), FileError);
    EXPECT_THROW(requireNoLink("table", "."), FileError);
    EXPECT_NO_THROW(requireNoLink("own", "."));
    fs::current_path(before);
}

TEST_F(FoundFiles, PathsOfFilesStayBelow) {
    for (const char* path : {"a", "a/b", "./a", "a..b/..c", "a/."}) EXPECT_TRUE(staysBelow(path));
    for (const char* path : {"", "/a", "..", "../a", "a/../../b", "a/.."}) {
        EXPECT_FALSE(staysBelow(path)) << path;
    }
    EXPECT_FALSE(staysBelow(std::string("a\0b", 3)));
}

TEST_F(FoundFiles, AreReadWithoutWaiting) {
    EXPECT_EQ(readSmallFile(root_ / "in/own"), "own");
    EXPECT_EQ(readSmallFile(root_ / "in/missing"), std::nullopt);
    EXPECT_EQ(readSmallFile(root_ / "in/own/below"), std::nullopt);
    EXPECT_THROW(readSmallFile(root_ / "in/own", 2), FileError);
#ifndef __EMSCRIPTEN__  // whose mkfifo() makes a file
    ASSERT_EQ(mkfifo((root_ / "in/pipe").c_str(), 0600), 0);
    EXPECT_THROW(readSmallFile(root_ / "in/pipe"), FileError);
#endif
    EXPECT_THROW(readSmallFile("/dev/zero"), FileError);
    EXPECT_THROW(readSmallFile(root_ / "in"), FileError);
    link("../out/secret", "in/leaves");
    EXPECT_THROW(readFoundFile(root_ / "in/leaves", root_ / "in"), FileError);
    EXPECT_EQ(readFoundFile(root_ / "in/own", root_ / "in"), "own");
}

}  // namespace
}  // namespace adaptiso
