#include "Common/Batch.h"

#include <algorithm>
#include <iostream>
#include <optional>
#include <utility>

#include "Common/AtomicOutput.h"
#include "Common/BatchPlan.h"
#include "Common/BatchRecord.h"
#include "Common/BatchSummary.h"
#include "Common/Numbers.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// What a run that crashed, and could not clean up, has left: files named by its process.
void removeTemporaries(const BatchItem& item, int process) {
    const std::string prefix = ".adaptiso-" + std::to_string(process) + "-";
    std::error_code error;
    const fs::path folder = item.folder.empty() ? "." : item.folder;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().filename().string().starts_with(prefix)) {
            fs::remove_all(entry.path(), error);
        }
    }
}

class BatchRun {
public:
    BatchRun(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common)
        : program_(program),
          batch_(batch),
          common_(common),
          plan_(program, batch, common),
          items_(plan_.items()),
          records_(items_.size()),
          progress_(common.isQuiet) {}

    int run() {
        if (batch_.skipsExisting) findEarlierRuns();
        std::vector<std::size_t> waiting;
        for (std::size_t n = 0; n < items_.size(); ++n) {
            if (!records_[n]) waiting.push_back(n);
        }
        tellThoseNext();
        runChildren(
            waiting.size(), batch_.jobs.value_or(1),
            [&](std::size_t n) { return start(items_[waiting[n]]); },
            [&](std::size_t n, const ChildResult& result) { finish(waiting[n], result); });
        progress_.clear();
        writeFiles();
        if (!common_.isQuiet && !common_.wantsJsonOnStdout()) printTotals();
        if (!std::cout.flush()) throw FileError("standard output: can't be written");
        return failedCount() == 0 ? kExitOk : kExitCheckFailed;
    }

private:
    std::string fingerprintOf(const BatchItem& item) const {
        return fingerprint(item, plan_.options(item), program_.name);
    }

    void findEarlierRuns() {
        for (std::size_t n = 0; n < items_.size(); ++n) {
            records_[n] = readRecord(items_[n], program_.name, fingerprintOf(items_[n]));
        }
    }

    std::vector<std::string> start(const BatchItem& item) {
        if (!item.folder.empty()) fs::create_directories(item.folder);
        if (plan_.keepsRecords()) fs::remove(recordFile(item, program_.name));  // until it is done
        return plan_.arguments(item);
    }

    void finish(std::size_t n, const ChildResult& result) {
        const BatchItem& item = items_[n];
        BatchRecord record = recordOf(item, result, program_.name);
        if (record.report.is_object()) {
            record.outputs = plan_.outputs(item, program_.outputs(record.report));
        }
        if (result.signal != 0) removeTemporaries(item, result.process);
        if (plan_.keepsRecords() && record.isFinished()) {
            keepRecord(item, record, program_.name, fingerprintOf(item));
        }
        records_[n] = std::move(record);
        tellThoseNext();
    }

    std::string says(const BatchRecord& record) const {
        if (!record.error.empty()) return record.error;
        if (!record.report.is_object()) return "";
        if (!record.report.value("failedByWarnings", false)) return program_.says(record.report);
        return strictFailure(warningsOf(record), "");
    }

    static std::vector<std::string> warningsOf(const BatchRecord& record) {
        if (!record.report.is_object()) return {};
        return record.report.value("warnings", std::vector<std::string>{});
    }

    /// Tells of the items whose turn has come: in the order of the inputs, whatever ended first.
    void tellThoseNext() {
        progress_.clear();
        for (; told_ < items_.size() && records_[told_]; ++told_)
            tell(items_[told_], *records_[told_]);
        if (told_ < items_.size()) {
            progress_.show(std::to_string(told_) + " of " + std::to_string(items_.size()));
        }
    }

    void tell(const BatchItem& item, const BatchRecord& record) {
        const std::string name = item.inputs.front().string();
        printWarnings(program_.name, common_, warningsOf(record));
        if (common_.wantsJson()) {
            const std::string line =
                toJson(record, program_.name).dump(-1, ' ', false, Json::error_handler_t::replace) +
                "\n";
            if (common_.wantsJsonOnStdout())
                std::cout << line << std::flush;
            else
                jsonLines_ += line;
        }
        if (common_.isQuiet || common_.wantsJsonOnStdout()) {
            if (!record.hasPassed())
                printError(program_.name, "failed: " + name + ": " + says(record));
            return;
        }
        std::cout << (!record.hasPassed()     ? "FAILED"
                      : record.isOfEarlierRun ? "before"
                                              : "done  ")
                  << "  " << name << ": " << says(record) << ", " << formatFixed(record.seconds, 2)
                  << " s" << std::endl;
    }

    std::size_t failedCount() const {
        return static_cast<std::size_t>(
            std::count_if(records_.begin(), records_.end(),
                          [](const auto& record) { return !record->hasPassed(); }));
    }

    void printTotals() const {
        const auto before = std::count_if(records_.begin(), records_.end(), [](const auto& record) {
            return record->isOfEarlierRun;
        });
        std::cout << items_.size() << " input" << (items_.size() == 1 ? "" : "s") << ", "
                  << failedCount() << " failed";
        if (before > 0) std::cout << ", " << before << " of an earlier run";
        std::cout << '\n';
    }

    SummaryRow rowOf(const BatchItem& item, const BatchRecord& record) const {
        SummaryRow row{record.name,
                       record.files.front(),
                       record.hasPassed(),
                       record.isOfEarlierRun,
                       says(record),
                       record.seconds,
                       {},
                       {},
                       {}};
        for (std::size_t n = 1; n < record.files.size(); ++n) row.file += ", " + record.files[n];
        for (const std::string& output : record.outputs)
            row.outputs.push_back(item.folder / output);
        row.report = plan_.written(item, "--report");
        row.pictures = plan_.written(item, "--pictures");
        return row;
    }

    void writeFiles() {
        std::vector<AtomicOutput> outputs;
        if (!plan_.summary().empty()) {
            std::vector<SummaryRow> rows;
            for (std::size_t n = 0; n < items_.size(); ++n) {
                rows.push_back(rowOf(items_[n], *records_[n]));
            }
            outputs.emplace_back(plan_.summary())
                .writeText(summaryPage(program_.name, rows, plan_.summary()));
        }
        if (common_.wantsJson() && !common_.wantsJsonOnStdout()) {
            outputs.emplace_back(common_.json).writeText(jsonLines_);
        }
        AtomicOutput::commit(outputs);
    }

    const BatchProgram& program_;
    const BatchOptions& batch_;
    const CommonOptions& common_;
    const BatchPlan plan_;
    const std::vector<BatchItem>& items_;
    std::vector<std::optional<BatchRecord>> records_;  ///< none: not ended yet
    ProgressLine progress_;
    std::size_t told_ = 0;
    std::string jsonLines_;
};

}  // namespace

int runBatch(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common) {
    return BatchRun(program, batch, common).run();
}

}  // namespace adaptiso
