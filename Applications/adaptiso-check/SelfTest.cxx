#include "SelfTest.h"

#include <ostream>

#include "Common/ProgramRun.h"
#include "Common/RunApp.h"

namespace adaptiso::checker {
namespace {

void printFailures(const selftest::SelfTest& test) {
    for (const selftest::Measurement& m : test.measurements) {
        if (m.hasPassed()) continue;
        printError(kProgram, "self-test failed: " + m.subject + ": " + m.quantity +
                                 (m.error.empty() ? "" : ": " + m.error));
    }
}

}  // namespace

int runSelfTest(const CheckOptions& options) {
    ProgramRun run(kProgram, options.common, options.report, "");
    OutputPlan({}).check(options.common, options.report);
    selftest::SelfTest test = run.timer.time("measure", [&] {
        return selftest::runSelfTestCases(
            [&](const std::string& what) { run.progress.show(what); });
    });
    const selftest::Machine machine = selftest::thisMachine();
    const std::string date = reportDate();

    if (options.report.isWanted()) {
        run.writePage([&] { return selftest::reportPage(test, machine); });
    }
    run.verdict.exitCode = test.hasPassed() ? kExitOk : kExitCheckFailed;
    run.deliver(
        [&] { return selftest::jsonText(test, run.verdict, machine, date, run.timer); },
        [&](std::ostream& out) { selftest::printText(out, test, machine, date, run.timer); });
    if (options.common.isQuiet || options.common.wantsJsonOnStdout()) printFailures(test);
    return run.end("the self-test is done");
}

}  // namespace adaptiso::checker
