#include "SelfTest.h"

#include <ostream>
#include <vector>

#include "Common/AtomicOutput.h"
#include "Common/ExitCodes.h"
#include "Common/Progress.h"
#include "Common/ReportOutput.h"
#include "Common/ResultOutput.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
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

    ReportResult page;  // its folder goes, if empty, after what lies in it
    std::vector<AtomicOutput> outputs;
    if (options.report.isWanted()) {
        progress.show("report");
        page = timer.time("report", [&] {
            return writeReport([&] { return selftest::reportPage(test, machine); }, kProgram,
                               options.report, outputs);
        });
    }
    Verdict verdict{test.hasPassed() ? kExitOk : kExitCheckFailed};
    verdict.failReport(page.failure);
    const std::string json = selftest::jsonText(test, verdict, machine, date, timer);
    if (hasJsonFile) outputs.emplace_back(options.common.json).writeText(json);
    progress.clear();
    printResults(options.common, json,
                 [&](std::ostream& out) { selftest::printText(out, test, machine, date, timer); });
    AtomicOutput::commit(outputs);
    if (options.common.isQuiet || options.common.wantsJsonOnStdout()) tellFailures(test);
    return printVerdict(kProgram, verdict, "the self-test is done");
}

}  // namespace adaptiso
