#include "SelfTest.h"

#include <iostream>
#include <vector>

#include "Common/AtomicOutput.h"
#include "Common/ExitCodes.h"
#include "Common/Progress.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "SelfTestCases.h"
#include "SelfTestReport.h"

namespace adaptiso {
namespace {

constexpr const char* kProgram = "adaptiso-check";

void tellFailures(const selftest::SelfTest& test) {
    for (const selftest::Measurement& m : test.measurements) {
        if (m.hasPassed()) continue;
        printError(kProgram, "self-test failed: " + m.subject + ": " + m.quantity +
                                 (m.error.empty() ? "" : ": " + m.error));
    }
}

}  // namespace

int runSelfTest(const CheckOptions& options) {
    const ThreadLimit threads(options.common);
    ProgressLine progress(options.common.isQuiet);
    checkReportOutputs(options.report, {});
    const bool hasJsonFile = options.common.wantsJson() && !options.common.wantsJsonOnStdout();
    if (hasJsonFile) checkOutput(options.common.json);

    StageTimer timer;
    selftest::SelfTest test = timer.time("measure", [&] {
        return selftest::runSelfTestCases([&](const std::string& what) { progress.show(what); });
    });
    const selftest::Machine machine = selftest::thisMachine();
    const std::string date = reportDate();

    const PictureFolder pictures(options.report.pictures);
    std::vector<AtomicOutput> outputs;
    if (options.report.isWanted()) {
        progress.show("report");
        Report page = selftest::reportPage(test, machine);
        timer.time("report", [&] { writeReport(page, kProgram, options.report, outputs); });
    }
    const std::string json = selftest::jsonText(test, machine, date, timer);
    if (hasJsonFile) outputs.emplace_back(options.common.json).writeText(json);
    AtomicOutput::commit(outputs);
    progress.clear();
    if (options.common.wantsJsonOnStdout()) {
        std::cout << json;
    } else if (!options.common.isQuiet) {
        selftest::printText(std::cout, test, machine, date, timer);
    }
    if (!std::cout.flush()) throw FileError("standard output: can't be written");
    if (options.common.isQuiet || options.common.wantsJsonOnStdout()) tellFailures(test);
    return test.hasPassed() ? kExitOk : kExitCheckFailed;
}

}  // namespace adaptiso
