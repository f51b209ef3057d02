#include "Common/ResultOutput.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <iostream>
#include <vector>

#include "Common/AtomicOutput.h"
#include "Common/Verdict.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

void checkReportFile(const CommonOptions& common, const std::filesystem::path& input) {
    if (!common.wantsJson() || common.wantsJsonOnStdout()) return;
    checkNotInput(common.json, input);
    checkOutput(common.json);
}

void flushResults() {
    const auto fail = [] {
        throw FileError("standard output: can't be written: " + detail::reason());
    };
    errno = 0;
    if (!std::cout.flush()) {
        if (errno == 0) throw FileError("standard output: can't be written");
        fail();
    }
    // some file systems tell only now that there is no room; pipes and terminals can't be forced
    struct stat status {};
    const bool isFile = fstat(STDOUT_FILENO, &status) == 0 && S_ISREG(status.st_mode);
    if (isFile && fsync(STDOUT_FILENO) != 0 && errno != EINVAL && errno != EROFS) fail();
}

void printResults(const CommonOptions& common, const std::string& json,
                  const std::function<void(std::ostream&)>& printText) {
    if (common.wantsJsonOnStdout()) {
        markReported();
        std::cout << json;
    } else if (!common.isQuiet) {
        printText(std::cout);
    }
    flushResults();
}

void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText) {
    std::vector<AtomicOutput> outputs;
    if (common.wantsJson() && !common.wantsJsonOnStdout()) {
        checkReportFile(common, input);
        outputs.emplace_back(common.json).writeText(json);
    }
    printResults(common, json, printText);
    AtomicOutput::commit(outputs);
}

}  // namespace adaptiso
