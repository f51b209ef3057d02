#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "Common/AtomicFolder.h"
#include "Common/AtomicOutput.h"
#include "Common/TemporaryNames.h"
#include "FolderTest.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class TemporaryNamesTest : public FolderTest {};

/// Makes temporaries in a process that ends as by SIGKILL, with what is written so far.
/// \return the name of the first  \pre no thread runs
std::vector<fs::path> leave(const fs::path& folder) {
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
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(folder)) left.push_back(entry.path());
    return left;
}

/// "Death" in the name: googletest runs it first, while there is one thread.
using TemporaryNamesDeathTest = TemporaryNamesTest;

TEST_F(TemporaryNamesDeathTest, ThoseOfAnEndedProcessGo) {
    EXPECT_EQ(leave(folder_).size(), 2u);
    detail::removeLeftTemporaries(folder_);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(TemporaryNamesDeathTest, TheNextOutputInTheFolderRemovesThem) {
    leave(folder_);
    { const AtomicOutput next(folder_ / "c.txt"); }
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(TemporaryNamesDeathTest, ThoseOfAnotherContainerGoWhenNobodyKeepsTheirLock) {
    const std::vector<fs::path> left = leave(folder_);
    // as if made in another PID namespace, where the process can't be seen from here
    const std::string name = left.front().filename().string();
    const std::size_t pid = name.find('-') + 1, start = name.find('-', pid) + 1,
                      space = name.find('-', start) + 1, boot = name.find('-', space);
    ASSERT_NE(boot, std::string::npos);
    const fs::path foreign = folder_ / (name.substr(0, space) + "1" + name.substr(boot));
    for (const fs::path& path : left) {
        if (path == left.front()) fs::rename(path, foreign);
    }
    detail::removeLeftTemporaries(folder_);
    EXPECT_TRUE(fs::exists(foreign));  // its maker may not have locked it yet
}

TEST_F(TemporaryNamesTest, ThoseOfThisProcessStay) {
    const AtomicOutput first(folder_ / "a.txt");
    detail::removeLeftTemporaries(folder_);
    EXPECT_TRUE(fs::exists(first.temporary()));
}

TEST_F(TemporaryNamesTest, ALockIsKeptForAsLongAsTheyLive) {
    const AtomicOutput output(folder_ / "a.txt");
    const std::string name = output.temporary().filename().string();
    if (name.find("k.part") == std::string::npos) GTEST_SKIP() << "no locks on this file system";
    const int file = ::open(output.temporary().c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(file, 0);
    EXPECT_NE(flock(file, LOCK_EX | LOCK_NB), 0);
    ::close(file);
}

TEST_F(TemporaryNamesTest, OtherNamesStay) {
    for (const char* name :
         {".adaptiso-", ".adaptiso-1-0.part.stl", ".adaptiso-1-2-3-4-5-6.part",
          ".adaptiso-x-2-3-4-5-6.part", ".adaptiso-999999999-1-1-1-1-1k.part", ".adaptiso-notes"}) {
        put(name, "x");
    }
    detail::removeLeftTemporaries(folder_);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 6);
}

}  // namespace
}  // namespace adaptiso
