#include "Pipeline.h"

#include <iostream>

#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Dataset.h"
#include "Jobs.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso::bids {
namespace {

constexpr const char* kProgram = "adaptiso-bids";

/// Makes everything asked for of `chosen` that does not exist yet; a faulty participant and a scan
/// that fails affect only themselves. Writes below their own folders of OUT_DIR only.
class ParticipantLevel {
public:
    ParticipantLevel(const BidsOptions& options, const ChosenSubjects& chosen)
        : options_(options), chosen_(chosen) {
        running_.folder = options.output;
        running_.jsonLines = &lines_;
    }

    int run() {
        const CommonOptions& common = options_.common;
        const bool writesJson = common.wantsJson() && !common.wantsJsonOnStdout();
        checkReportFile(common, options_.dataset);
        const std::vector<Job> jobs = findJobs(options_, chosen_.folders);
        makeFolders(options_.output);
        for (const auto& [subject, reason] : chosen_.faulty) printFailed(subject, reason);
        const detail::SignalsWait untilResultsAreWritten;
        for (const Job& job : jobs) run(job);
        if (options_.makes("check")) run(checkJob(options_, jobs.front()));
        const bool isInterrupted = detail::SignalsWait::hasCome();
        if (writesJson && !(isInterrupted && lines_.empty())) writeWhole(common.json, lines_);
        if (isInterrupted) {
            printError(kProgram, "interrupted after " + counted(std::ssize(records_), "run") +
                                     "; the same command goes on");
        } else if (!common.isQuiet && !common.wantsJsonOnStdout()) {
            printTotals(records_, "run", options_.output,
                        {"the level group, with the same options, for quality.tsv and a page"});
        }
        flushResults();
        return wasRefused_  ? kExitUsage
               : hasBroken_ ? kExitInternalError
               : wasShort_  ? kExitBadInput
               : hasFailed_ ? kExitCheckFailed
                            : kExitOk;
    }

private:
    /// A participant or a scan of whom nothing can be run.
    void printFailed(const std::string& subject, const std::string& reason) {
        hasFailed_ = true;
        RunRecord& record = records_.emplace_back();
        record.name = subject;
        record.hasEnded = true;
        record.exitCode = kExitBadInput;
        record.error = reason;
        if (options_.common.isQuiet || options_.common.wantsJsonOnStdout()) {
            printError(kProgram, "failed: " + subject + ": " + reason);
        } else {
            std::cout << "FAILED  " << subject << ": " << reason << std::endl;
        }
    }

    void run(const Job& job) {
        if (detail::SignalsWait::hasCome()) return;
        for (const std::string& subject : job.without) {
            printFailed(subject, job.product + ": no " + job.needs);
        }
        for (RunRecord& record :
             runRuns(job.program, job.runs, job.batch, running_, options_.common)) {
            const bool hasExited = record.signal == 0;
            hasFailed_ = hasFailed_ || !record.hasPassed();
            wasShort_ = wasShort_ || record.wasShort;
            hasBroken_ = hasBroken_ || (hasExited && record.exitCode == kExitInternalError);
            wasRefused_ = wasRefused_ || (hasExited && record.exitCode == kExitUsage);
            record.report = nullptr;  // of many regions large
            records_.push_back(std::move(record));
        }
    }

    const BidsOptions& options_;
    const ChosenSubjects& chosen_;
    BatchRunning running_;
    std::vector<RunRecord> records_;
    std::string lines_;
    bool hasFailed_ = false, wasShort_ = false, hasBroken_ = false, wasRefused_ = false;
};

}  // namespace

int runBids(const BidsOptions& options) {
    const ChosenSubjects chosen = chooseSubjects(options);
    printWarnings(kProgram, options.common, chosen.warnings);
    Verdict verdict{options.level == BidsLevel::Participant
                        ? ParticipantLevel(options, chosen).run()
                        : runGroup(options, chosen)};
    if (verdict.exitCode == kExitOk) verdict.failStrict(options.common, chosen.warnings, "");
    return printVerdict(kProgram, verdict, "");
}

}  // namespace adaptiso::bids
