#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Files/AtomicOutput.h"

/// In the C library's place: NFS, 9p and FUSE know no flags.
extern "C" int renameat2(int from, const char* old, int to, const char* made,
                         unsigned flags) noexcept {
    if (flags == 0) return static_cast<int>(syscall(SYS_renameat2, from, old, to, made, flags));
    errno = EINVAL;
    return -1;
}

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class AtomicFolderTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / ("AtomicFolder-" + std::string(test->name()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    static std::vector<std::string> names(const fs::path& folder) {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder)) {
            names.push_back(entry.path().filename().string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }
    static std::string text(const fs::path& path) {
        std::ifstream file(path);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static void put(const fs::path& path, const std::string& content) {
        std::ofstream(path) << content;
    }

    fs::path folder_;
};

using Names = std::vector<std::string>;
const OwnNames kOwn = [](std::string_view name) { return name == "a.txt" || name == "b.txt"; };

TEST_F(AtomicFolderTest, AppearsWithItsCommitAndTheOutputsWithIt) {
    {
        AtomicFolder model(folder_ / "model", {});
        model.writeText("a.txt", "one");
        put(model.place("b.txt"), "two");
        EXPECT_FALSE(fs::exists(folder_ / "model"));
        EXPECT_EQ(model.files(), (std::vector<std::pair<std::string, std::uintmax_t>>{
                                     {"a.txt", 3}, {"b.txt", 3}}));
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(folder_ / "c.txt").writeText("three");
        model.commit(outputs);
    }
    EXPECT_EQ(names(folder_), (Names{"c.txt", "model"}));
    EXPECT_EQ(names(folder_ / "model"), (Names{"a.txt", "b.txt"}));
    EXPECT_EQ(text(folder_ / "model" / "b.txt"), "two");
}

TEST_F(AtomicFolderTest, LeavesNothingWithoutACommit) {
    {
        AtomicFolder model(folder_ / "model", {});
        model.writeText("a.txt", "one");
        model.place("never-written.txt");
        EXPECT_EQ(names(folder_).size(), 1u);
    }
    EXPECT_EQ(names(folder_), Names{});
}

TEST_F(AtomicFolderTest, ASignalDuringACommitWaitsForItsEnd) {
    put(folder_ / "c.txt", "old");
    const auto interrupted = [&] {
        removeOutputsOnSignals();
        AtomicFolder model(folder_ / "model", {});
        model.writeText("a.txt", "one");
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(folder_ / "c.txt").writeText("new");
        const detail::SignalsWait asInACommit;
        std::raise(SIGTERM);
        model.commit(outputs);
    };
    EXPECT_EXIT(interrupted(), ::testing::KilledBySignal(SIGTERM), "");
    EXPECT_EQ(names(folder_), (Names{"c.txt", "model"}));
    EXPECT_EQ(text(folder_ / "model" / "a.txt"), "one");
    EXPECT_EQ(text(folder_ / "c.txt"), "new");
}

TEST_F(AtomicFolderTest, FillsAnEmptyFolderAndTakesATrailingSlash) {
    fs::create_directory(folder_ / "model");
    AtomicFolder model(folder_ / "model" / "", {});
    model.writeText("a.txt", "one");
    model.commit();
    EXPECT_EQ(names(folder_ / "model"), Names{"a.txt"});
}

TEST_F(AtomicFolderTest, ReplacesItsOwnKindAndNothingElse) {
    const fs::path target = folder_ / "model";
    fs::create_directory(target);
    put(target / "a.txt", "old");
    EXPECT_THROW(AtomicFolder(target, {}), FileError);
    {
        AtomicFolder model(target, kOwn);
        model.writeText("b.txt", "new");
        EXPECT_EQ(names(target), Names{"a.txt"});  // until the very end
        model.commit();
    }
    EXPECT_EQ(names(target), Names{"b.txt"});
    EXPECT_EQ(names(folder_), Names{"model"});

    put(target / "thesis.tex", "precious");
    EXPECT_THROW(AtomicFolder(target, kOwn), FileError);
    fs::remove(target / "thesis.tex");
    fs::create_symlink("elsewhere", target / "a.txt");
    EXPECT_THROW(AtomicFolder(target, kOwn), FileError);
    fs::remove(target / "a.txt");
    fs::create_directory(target / "a.txt");
    EXPECT_THROW(AtomicFolder(target, kOwn), FileError);
}

TEST_F(AtomicFolderTest, ComesBackWhenAnOutputCanNotBePutInPlace) {
    const fs::path target = folder_ / "model";
    fs::create_directory(target);
    put(target / "a.txt", "old");
    {
        AtomicFolder model(target, kOwn);
        model.writeText("b.txt", "new");
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(folder_ / "c.txt").writeText("new");
        fs::remove(outputs[0].temporary());
        EXPECT_THROW(model.commit(outputs), FileError);
        EXPECT_EQ(names(target), Names{"a.txt"});
    }
    EXPECT_EQ(names(folder_), Names{"model"});
    EXPECT_EQ(text(target / "a.txt"), "old");
}

TEST_F(AtomicFolderTest, KeepsTheModesOfWhatItReplaces) {
    const fs::path target = folder_ / "model";
    fs::create_directory(target);
    put(target / "a.txt", "old");
    fs::permissions(target, static_cast<fs::perms>(0750));
    fs::permissions(target / "a.txt", static_cast<fs::perms>(0600));
    AtomicFolder model(target, kOwn);
    model.writeText("a.txt", "new");
    model.writeText("b.txt", "new");
    model.commit();
    EXPECT_EQ(static_cast<unsigned>(fs::status(target).permissions()), 0750U);
    EXPECT_EQ(static_cast<unsigned>(fs::status(target / "a.txt").permissions()), 0600U);
}

TEST_F(AtomicFolderTest, LooksAgainBeforeItReplaces) {
    const fs::path target = folder_ / "model";
    AtomicFolder model(target, {});
    model.writeText("a.txt", "one");
    fs::create_directory(target);
    put(target / "precious.txt", "came meanwhile");
    EXPECT_THROW(model.commit(), FileError);
    EXPECT_EQ(names(target), Names{"precious.txt"});
}

TEST_F(AtomicFolderTest, NamesTheTargetInMessages) {
    AtomicFolder model(folder_ / "model", {});
    const fs::path place = model.place("a.txt");
    try {
        model.fill([&] { throw FileError(place.string() + ": can't be written"); });
        ADD_FAILURE();
    } catch (const FileError& error) {
        EXPECT_EQ(error.what(), (folder_ / "model" / "a.txt").string() + ": can't be written");
    }
}

TEST_F(AtomicFolderTest, ASignalRemovesFilesAndFolder) {
    const auto interrupted = [&] {
        removeOutputsOnSignals();
        AtomicFolder model(folder_ / "model", {});
        model.writeText("a.txt", "one");
        model.writeText("regions/1.vtp", "two");
        AtomicOutput other(folder_ / "b.txt");
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(interrupted(), ::testing::KilledBySignal(SIGTERM), "");
    EXPECT_EQ(names(folder_), Names{});
}

TEST_F(AtomicFolderTest, HoldsFoldersOfFiles) {
    {
        AtomicFolder labels(folder_ / "labels", {});
        labels.writeText("regions/1.vtp", "one");
        labels.writeText("regions/2.vtp", "two");
    }
    EXPECT_EQ(names(folder_), Names{});
    AtomicFolder labels(folder_ / "labels", {});
    for (int n = 0; n < 100; ++n) {  // so many are forced to disk together
        labels.writeText("regions/" + std::to_string(n), "x");
    }
    labels.commit();
    EXPECT_EQ(names(folder_), Names{"labels"});
    EXPECT_EQ(names(folder_ / "labels" / "regions").size(), 100u);
}

TEST_F(AtomicFolderTest, ReplacesFoldersOfItsOwnFilesAlone) {
    const OwnNames own([](std::string_view name) { return name.starts_with("regions/"); });
    const auto write = [&](const char* text) {
        AtomicFolder labels(folder_ / "labels", own);
        labels.writeText("regions/1", text);
        labels.commit();
    };
    write("one");
    write("two");
    EXPECT_EQ(text(folder_ / "labels" / "regions" / "1"), "two");
    EXPECT_EQ(names(folder_), Names{"labels"}) << "the former folder is gone whole";
    fs::create_directory(folder_ / "labels" / "regions" / "deeper");
    EXPECT_THROW(write("three"), FileError);
    fs::remove(folder_ / "labels" / "regions" / "deeper");
    put(folder_ / "labels" / "mine.txt", "");
    EXPECT_THROW(write("three"), FileError);
    EXPECT_EQ(text(folder_ / "labels" / "regions" / "1"), "two");
}

}  // namespace
}  // namespace adaptiso
