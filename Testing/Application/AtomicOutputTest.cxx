#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class AtomicOutputTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / ("AtomicOutput-" + std::string(test->name()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_)) {
            names.push_back(entry.path().filename().string());
        }
        return names;
    }
    static std::string text(const fs::path& path) {
        std::ifstream file(path);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    fs::path folder_;
};

using Names = std::vector<std::string>;

TEST_F(AtomicOutputTest, AppearsWithItsCommit) {
    const fs::path target = folder_ / "a.txt";
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(target).writeText("whole");
    EXPECT_FALSE(fs::exists(target));
    EXPECT_EQ(outputs[0].temporary().extension(), ".txt");
    EXPECT_EQ(outputs[0].temporary().parent_path(), folder_);
    AtomicOutput::commit(outputs);
    outputs.clear();
    EXPECT_EQ(text(target), "whole");
    EXPECT_EQ(names(), Names{"a.txt"});
}

TEST_F(AtomicOutputTest, LeavesNothingWithoutACommit) {
    std::ofstream(folder_ / "a.txt") << "old";
    AtomicOutput(folder_ / "a.txt").writeText("new");
    EXPECT_EQ(names(), Names{"a.txt"});
    EXPECT_EQ(text(folder_ / "a.txt"), "old");
}

TEST_F(AtomicOutputTest, NamesTheTargetWhenTheWriterFails) {
    AtomicOutput output(folder_ / "a.txt");
    try {
        output.write([](const fs::path& path) { throw FileError(path.string() + ": disk full"); });
        FAIL() << "the error was swallowed";
    } catch (const FileError& error) {
        EXPECT_EQ(error.what(), (folder_ / "a.txt").string() + ": disk full");
    }
}

TEST_F(AtomicOutputTest, NoticesAWriterThatLeavesNoFile) {
    AtomicOutput output(folder_ / "a.txt");
    EXPECT_THROW(output.write([](const fs::path& path) { fs::remove(path); }), FileError);
}

TEST_F(AtomicOutputTest, TwoOfOneTargetDoNotMeet) {
    const AtomicOutput first(folder_ / "a.txt");
    const AtomicOutput second(folder_ / "a.txt");
    EXPECT_NE(first.temporary(), second.temporary());
}

TEST_F(AtomicOutputTest, TakesTheLongestNames) {
    const std::string name = std::string(251, 'n') + ".txt";  // NAME_MAX is 255
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / name).writeText("x");
    AtomicOutput::commit(outputs);
    EXPECT_EQ(names(), Names{name});
}

TEST_F(AtomicOutputTest, FollowsALinkThatLeadsToNoFileYet) {
    fs::create_symlink("real.txt", folder_ / "link.txt");
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "link.txt").writeText("x");
    AtomicOutput::commit(outputs);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
    EXPECT_EQ(text(folder_ / "real.txt"), "x");
}

TEST_F(AtomicOutputTest, FollowsNoLinkUnderANameThatTheProgramChose) {
    fs::create_directory(folder_ / "in");
    fs::create_symlink("../real.txt", folder_ / "in/link.txt");
    fs::create_symlink("in", folder_ / "way");
    EXPECT_THROW(AtomicOutput(folder_ / "in/link.txt", folder_ / "in"), FileError);
    EXPECT_THROW(AtomicOutput(folder_ / "way/a.txt", folder_), FileError);
    EXPECT_THROW(makeFolders(folder_ / "way/deeper", folder_), FileError);
    EXPECT_FALSE(fs::exists(folder_ / "in/deeper"));
    EXPECT_FALSE(fs::exists(folder_ / "real.txt"));
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "way/a.txt", folder_ / "way").writeText("x");
    fs::create_symlink("../real.txt", folder_ / "in/a.txt");  // meanwhile
    EXPECT_THROW(AtomicOutput::commit(outputs), FileError);
    EXPECT_FALSE(fs::exists(folder_ / "real.txt"));
}

TEST_F(AtomicOutputTest, RefusesTargetsThatCanNotBeFiles) {
    EXPECT_THROW(AtomicOutput(folder_ / "missing" / "a.txt"), FileError);
    EXPECT_THROW(AtomicOutput{folder_}, FileError);
    EXPECT_THROW(AtomicOutput("/dev/null"), FileError);
    EXPECT_EQ(names(), Names{});
}

TEST_F(AtomicOutputTest, ASignalRemovesTheTemporaryAndEndsTheProcess) {
    EXPECT_EXIT(
        {
            removeOutputsOnSignals();
            AtomicOutput output(folder_ / "a.txt");
            output.writeText("half");
            raise(SIGTERM);
        },
        ::testing::KilledBySignal(SIGTERM), "");
    EXPECT_EQ(names(), Names{});
}

TEST_F(AtomicOutputTest, OfSeveralThatCanNotAllBePutInPlaceNoneIs) {
    std::ofstream(folder_ / "a.txt") << "old";
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "a.txt").writeText("new");
    outputs.emplace_back(folder_ / "b.txt").writeText("new");
    outputs.emplace_back(folder_ / "c.txt").writeText("new");
    fs::remove(outputs[2].temporary());
    EXPECT_THROW(AtomicOutput::commit(outputs), FileError);
    EXPECT_EQ(text(folder_ / "a.txt"), "old");
    EXPECT_FALSE(fs::exists(folder_ / "b.txt"));
    outputs.clear();
    EXPECT_EQ(names(), Names{"a.txt"});
}

/// Makes a temporary file and folder in a process that ends as by SIGKILL.
void leave(const fs::path& folder) {
    const pid_t child = fork();
    if (child == 0) {
        auto* const output = new AtomicOutput(folder / "a.txt");
        output->writeText("half");
        auto* const model = new AtomicFolder(folder / "model", {});
        model->writeText("b.txt", "half");
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
}

TEST_F(AtomicOutputTest, TemporariesOfAKilledProcessAreRemovedByTheNextOutput) {
    leave(folder_);
    EXPECT_EQ(names().size(), 2u);
    std::ofstream(folder_ / ".adaptiso-notes") << "a user's";
    const AtomicOutput file(folder_ / "c.txt");
    const AtomicFolder model(folder_ / "model", {});
    const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(25);
    fs::last_write_time(file.temporary(), yesterday);  // a living process may take that long
    const AtomicOutput next(folder_ / "d.txt");
    std::vector<std::string> left = names();
    std::sort(left.begin(), left.end());
    Names expected{file.temporary().filename().string(), model.path().filename().string(),
                   next.temporary().filename().string(), ".adaptiso-notes"};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(left, expected);
}

TEST_F(AtomicOutputTest, LooksAgainBeforeItReplaces) {
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "a.txt").writeText("new");
    fs::create_directory(folder_ / "a.txt");
    EXPECT_THROW(AtomicOutput::commit(outputs), FileError);
    EXPECT_TRUE(fs::is_directory(folder_ / "a.txt"));
}

TEST_F(AtomicOutputTest, KeepsTheModeOfTheFileReplaced) {
    const fs::path target = folder_ / "a.txt";
    for (const unsigned mode : {0600U, 0640U, 0664U, 0755U, 0666U}) {
        std::ofstream(target) << "old";
        fs::permissions(target, static_cast<fs::perms>(mode));
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(target).writeText("new");
        // nobody else reads what nobody else may read when it is in place
        const auto others = fs::perms::group_all | fs::perms::others_all;
        EXPECT_EQ(fs::status(outputs[0].temporary()).permissions() & others, fs::perms::none);
        AtomicOutput::commit(outputs);
        EXPECT_EQ(static_cast<unsigned>(fs::status(target).permissions()), mode);
        EXPECT_EQ(text(target), "new");
    }
}

TEST_F(AtomicOutputTest, KeepsTheModeOfTheFileThatALinkLeadsTo) {
    std::ofstream(folder_ / "real.txt") << "old";
    fs::permissions(folder_ / "real.txt", static_cast<fs::perms>(0600));
    fs::create_symlink("real.txt", folder_ / "link.txt");
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "link.txt").writeText("new");
    AtomicOutput::commit(outputs);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
    EXPECT_EQ(static_cast<unsigned>(fs::status(folder_ / "real.txt").permissions()), 0600U);
}

TEST_F(AtomicOutputTest, KeepsOwnerAndGroupWherePermitted) {
    if (getuid() != 0) GTEST_SKIP() << "only root may give files away";
    constexpr unsigned kOwner = 1234, kGroup = 2345;
    const fs::path target = folder_ / "a.txt";
    std::ofstream(target) << "old";
    ASSERT_EQ(chown(target.c_str(), kOwner, kGroup), 0);
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(target).writeText("new");
    AtomicOutput::commit(outputs);
    struct stat status {};
    ASSERT_EQ(stat(target.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, kOwner);
    EXPECT_EQ(status.st_gid, kGroup);
}

TEST_F(AtomicOutputTest, OtherHardLinksKeepTheOldFile) {
    std::ofstream(folder_ / "a.txt") << "old";
    fs::create_hard_link(folder_ / "a.txt", folder_ / "b.txt");
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(folder_ / "a.txt").writeText("new");
    AtomicOutput::commit(outputs);
    EXPECT_EQ(text(folder_ / "a.txt"), "new");
    EXPECT_EQ(text(folder_ / "b.txt"), "old");
}

}  // namespace
}  // namespace adaptiso
