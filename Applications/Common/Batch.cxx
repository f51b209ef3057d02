#include "Common/Batch.h"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>
#include <utility>

#include "Common/AtomicOutput.h"
#include "Common/BatchPlan.h"
#include "Common/BatchRecord.h"
#include "Common/BatchRows.h"
#include "Common/Bids.h"
#include "Common/EarlierRuns.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class BatchRun {
public:
    BatchRun(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common)
        : program_(program),
          batch_(batch),
          common_(common),
          plan_(program, batch, common),
          items_(plan_.items()),
          records_(items_.size()),
          reasons_(items_.size()),
          earlier_(program, plan_),
          expected_(findExpected()),
          progress_(common.isQuiet) {}

    int run() {
        try {
            return runAll();
        } catch (...) {
            removeUnused();
            throw;
        }
    }

private:
    using Planned = std::vector<PlannedRecord>;

    int runAll() {
        if (batch_.skipsExisting) findEarlierRuns();
        std::vector<std::size_t> waiting;
        for (std::size_t n = 0; n < items_.size(); ++n) {
            if (!records_[n]) waiting.push_back(n);
        }
        announce(waiting);
        writePage();
        tellThoseNext();
        std::erase_if(waiting, [&](std::size_t n) { return failsUnrun(n); });
        runChildren(
            waiting.size(), batch_.jobs.value_or(1),
            [&](std::size_t n) { return start(waiting[n]); },
            [&](std::size_t n, const ChildResult& result) { finish(waiting[n], result); },
            program_.executable);
        progress_.clear();
        writeFiles();
        if (!common_.isQuiet && !common_.wantsJsonOnStdout() && !program_.isPartOfApp) {
            printTotals();
        }
        flushResults();
        return failedCount() == 0 ? kExitOk : kExitCheckFailed;
    }

    void findEarlierRuns() {
        for (std::size_t n = 0; n < items_.size(); ++n) {
            if (!items_[n].fault.empty()) continue;
            std::vector<EarlierRecord> found = earlier_.look(n);
            if (EarlierRuns::areDone(found)) {
                keepWhatIsAsked(n, found);
                records_[n] = together(found);
            }
            reasons_[n] = EarlierRuns::reasonOf(found);
        }
    }

    /// True if an earlier run made what this one asks for, perhaps by other option words.
    void keepWhatIsAsked(std::size_t n, const std::vector<EarlierRecord>& found) const {
        const Planned planned = plan_.records(items_[n]);
        for (std::size_t k = 0; k < found.size(); ++k) {
            if (program_.asked.is_null() || found[k].record->asked == program_.asked) continue;
            KeptRecord record = *found[k].record;
            record.asked = program_.asked;
            writeRecord(planned[k].file, record);
        }
    }

    /// An item with a fault fails alone. \return whether it has one
    bool failsUnrun(std::size_t n) {
        if (items_[n].fault.empty()) return false;
        start(n);
        ChildResult result;
        result.exitCode = kExitBadInput;
        result.errors = items_[n].fault;
        finish(n, result);
        return true;
    }

    /// The run that made all of `found`, or would have.
    static BatchRecord together(std::vector<EarlierRecord>& found) {
        BatchRecord run = std::move(found.front().record->run);
        for (std::size_t n = 1; n < found.size(); ++n) {
            BatchRecord& other = found[n].record->run;
            run.outputs.insert(run.outputs.end(), other.outputs.begin(), other.outputs.end());
            if (run.report.contains(kSurfaces) && other.report.contains(kSurfaces)) {
                for (const Json& surface : other.report[kSurfaces]) {
                    run.report[kSurfaces].push_back(surface);
                }
            }
        }
        run.isOfEarlierRun = true;
        return run;
    }

    /// What has no record gets one that says that it has not ended: if this batch is killed, nobody
    /// who builds the page takes what it left for all.
    void announce(const std::vector<std::size_t>& waiting) {
        if (!plan_.keepsRecords()) return;
        for (const std::size_t n : waiting) {
            if (!items_[n].folder.empty()) makeFolders(items_[n].folder);
            for (const PlannedRecord& planned : plan_.records(items_[n])) {
                if (fs::exists(planned.file)) continue;
                writeRecord(planned.file, newRecord(n, planned));
                announced_.push_back(planned);
            }
        }
    }

    /// This batch ends before its time, and lives to tell: of what it has announced and not made
    /// nothing stays.
    void removeUnused() const {
        for (const PlannedRecord& planned : announced_) {
            std::error_code error;
            if (!planned.surface.empty() && fs::exists(planned.surface, error)) continue;
            RecordFault fault = RecordFault::None;
            const std::optional<KeptRecord> record = readRecord(planned.file, fault);
            if (record && !record->hasEnded) fs::remove(planned.file, error);
        }
    }

    /// Another batch on this folder has made it since this one has looked.
    bool isMadeMeanwhile(std::size_t n) {
        constexpr bool kTrustsTimes = true;
        std::vector<EarlierRecord> found = earlier_.look(n, kTrustsTimes);
        if (!EarlierRuns::areDone(found)) return false;
        records_[n] = together(found);
        tellThoseNext();
        return true;
    }

    /// \return none: there is nothing to do any more
    std::vector<std::string> start(std::size_t n) {
        const BatchItem& item = items_[n];
        if (item.fault.empty() && batch_.skipsExisting && isMadeMeanwhile(n)) return {};
        if (!item.folder.empty()) makeFolders(item.folder);
        earlier_.forgetInputs(n);  // they may have changed since they were looked at
        if (program_.removesFormer) removeFormerOutputs(n);
        earlier_.inputs(n);
        if (plan_.keepsRecords()) {
            removeFormerRecord(item);
            for (const auto& [file, record] : notFinished(n)) writeRecord(file, record);
        }
        return plan_.arguments(item);
    }

    /// Versions before this one kept one record for each input.
    void removeFormerRecord(const BatchItem& item) const {
        const fs::path file = item.folder / (item.name + "." + program_.name + ".json");
        RecordFault fault = RecordFault::None;
        readRecord(file, fault);
        if (fault == RecordFault::OfAnotherVersion) fs::remove(file);
    }

    /// What a run has made that would come out otherwise now: if the run to come fails, or ends
    /// before its time, no file of an old input or of old options stands for it.
    void removeFormerOutputs(std::size_t n) {
        const BatchItem& item = items_[n];
        std::vector<EarlierRecord> found = earlier_.look(n);
        for (const EarlierRecord& one : found) {
            if (!one.record || one.why.empty()) continue;  // what is as it should be stays
            for (const KeptOutput& output : one.record->outputs) {
                const fs::path path = item.folder / output.file.file;
                constexpr bool kTrustsTimes = false;
                if (changeOf(output.file, path, kTrustsTimes) != FileChange::None) continue;
                std::error_code error;
                fs::remove(path, error);
                for (fs::path folder = path.parent_path(); folder != item.folder && !error;
                     folder = folder.parent_path()) {
                    if (!fs::is_empty(folder, error) || !fs::remove(folder, error)) break;
                }
            }
        }
    }

    KeptRecord newRecord(std::size_t n, const PlannedRecord& planned) const {
        KeptRecord record{program_.name, program_.versionText()};
        record.run.name = items_[n].name;
        for (const fs::path& input : items_[n].inputs) {
            record.run.files.push_back(baseName(input));
        }
        record.date = recordDate();
        record.asked = program_.asked;
        record.options = planned.options;
        return record;
    }

    Records notFinished(std::size_t n) const {
        Records records;
        for (const PlannedRecord& planned : plan_.records(items_[n])) {
            records.emplace(planned.file, newRecord(n, planned));
        }
        return records;
    }

    void finish(std::size_t n, const ChildResult& result) {
        const BatchItem& item = items_[n];
        BatchRecord record = recordOf(item, result, program_.name);
        record.madeAgain = reasons_[n];
        if (record.report.is_object()) {
            record.outputs = plan_.outputs(item, program_.outputs(record.report));
        }
        if (result.signal != 0) {
            detail::removeLeftTemporaries(item.folder.empty() ? "." : item.folder, result.process);
        }
        if (!record.isFinished() && item.fault.empty() && batch_.skipsExisting) {
            // of two batches on one folder the slower may fail where the other has all in place
            earlier_.forgetInputs(n);
            std::vector<EarlierRecord> found = earlier_.look(n);
            if (EarlierRuns::areDone(found)) record = together(found);
        }
        if (!record.isOfEarlierRun) keep(n, record);
        if (program_.ended) program_.ended(item, record);
        records_[n] = std::move(record);
        tellThoseNext();
        constexpr std::chrono::seconds kBetweenPages(30);
        if (Clock::now() - pageWritten_ > kBetweenPages) writePage();
    }

    void keep(std::size_t n, const BatchRecord& run) {
        const Planned planned = plan_.records(items_[n]);
        const std::vector<KeptInput> inputs = earlier_.unchangedInputs(n);
        const std::vector<KeptOutput> extras =
            run.isFinished() ? keptExtras(items_[n]) : std::vector<KeptOutput>{};
        for (std::size_t k = 0; k < planned.size(); ++k) {
            KeptRecord record = newRecord(n, planned[k]);
            record.hasEnded = true;
            record.run = planned.size() > 1 ? partOf(run, k) : run;
            record.says = says(record.run);
            record.inputs = inputs;
            for (const std::string& output : record.run.outputs) {
                record.outputs.push_back({kOutputOption, kept(output, items_[n].folder / output)});
            }
            if (record.run.hasPassed()) addSidecars(items_[n], record);
            record.outputs.insert(record.outputs.end(), extras.begin(), extras.end());
            if (plan_.keepsRecords()) {
                writeRecord(planned[k].file, record);
            } else {
                own_[planned[k].file] = std::move(record);
            }
        }
    }

    /// Beside what the run has made, and part of it: "a.json" of "a.vtp" and of the folder "a".
    void addSidecars(const BatchItem& item, KeptRecord& record) const {
        if (!program_.sidecar || record.run.outputs.empty()) return;
        const std::string& made = record.run.outputs.front();
        const std::string top = made.substr(0, made.find('/'));
        const std::string name = top.substr(0, top.find('.')) + ".json";
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(item.folder / name)
            .writeText(jsonText(program_.sidecar(item, record.run.report)) + "\n");
        AtomicOutput::commit(outputs);
        record.outputs.push_back({kOutputOption, kept(name, item.folder / name)});
    }

    /// What tells of the n-th surface.
    static BatchRecord partOf(const BatchRecord& run, std::size_t n) {
        BatchRecord part = run;
        if (n < run.outputs.size()) part.outputs = {run.outputs[n]};
        if (run.report.is_object() && run.report.contains(kSurfaces) &&
            n < run.report[kSurfaces].size()) {
            part.report[kSurfaces] = Json::array({run.report[kSurfaces][n]});
        }
        return part;
    }

    /// A file that can't be read is one that will have changed.
    static KeptFile kept(const std::string& name, const fs::path& path) {
        try {
            return keptFile(name, path);
        } catch (const FileError&) {
            KeptFile file;
            file.file = name;
            return file;
        }
    }

    std::vector<KeptOutput> keptExtras(const BatchItem& item) const {
        std::vector<KeptOutput> outputs;
        for (const auto& [option, path] : plan_.extras(item)) {
            std::vector<fs::path> files{path};
            if (fs::is_directory(path)) files = filesOfInput(path, {});
            for (const fs::path& file : files) {
                if (!fs::exists(file)) continue;
                const std::string name =
                    file.lexically_proximate(item.folder.empty() ? "." : item.folder).string();
                outputs.push_back({option, kept(name, file)});
            }
        }
        return outputs;
    }

    std::string says(const BatchRecord& record) const {
        if (!record.error.empty()) return record.error;
        if (!record.report.is_object()) return "";
        if (!record.report.value("failedByWarnings", false)) return program_.says(record.report);
        return strictFailure(common_, record.warnings, "");
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
        printWarnings(program_.name, common_, record.warnings);
        if (common_.wantsJson()) {
            const std::string line = jsonText(toJson(record, program_.name), -1) + "\n";
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
                  << " s" << (record.madeAgain.empty() ? "" : "; made again: " + record.madeAgain)
                  << std::endl;
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

    /// The page as of now: what of this batch has not ended counts as not finished.
    void writePage() {
        pageWritten_ = Clock::now();
        if (plan_.summary().empty()) return;
        Records own = own_;
        for (std::size_t n = 0; n < items_.size(); ++n) {
            if (!records_[n]) own.merge(notFinished(n));
        }
        writeSummary(plan_.summary(), {plan_.folder(), !batch_.bids.empty()}, own, expected_);
    }

    void writeFiles() {
        writePage();
        if (program_.jsonLines != nullptr) *program_.jsonLines += jsonLines_;
        if (!common_.wantsJson() || common_.wantsJsonOnStdout() || program_.isPartOfApp) return;
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(common_.json).writeText(jsonLines_);
        AtomicOutput::commit(outputs);
    }

    /// The scans of a BIDS dataset, all of which a reader of the page expects there.
    std::vector<BatchItem> findExpected() const {
        if (batch_.bids.empty() || program_.isPartOfApp) return {};
        try {
            return findBidsScans(batch_.bids, {}, plan_.folder());
        } catch (const InvalidInput&) {
            return {};  // surfaces alone are here
        }
    }

    using Clock = std::chrono::steady_clock;

    static constexpr const char* kSurfaces = "surfaces";

    const BatchProgram& program_;
    const BatchOptions& batch_;
    const CommonOptions& common_;
    const BatchPlan plan_;
    const std::vector<BatchItem>& items_;
    std::vector<std::optional<BatchRecord>> records_;  ///< none: not ended yet
    std::vector<std::string> reasons_;  ///< why it is made again; empty: it was not made before
    EarlierRuns earlier_;
    Records own_;        ///< that are kept in no file
    Planned announced_;  ///< whose records were not there before
    const std::vector<BatchItem> expected_;
    Clock::time_point pageWritten_{};
    ProgressLine progress_;
    std::size_t told_ = 0;
    std::string jsonLines_;
};

}  // namespace

int runBatch(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common) {
    return BatchRun(program, batch, common).run();
}

}  // namespace adaptiso
