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
#include "Common/Numbers.h"
#include "Common/Progress.h"
#include "Common/ResultOutput.h"
#include "Common/RunApp.h"
#include "Common/TemporaryNames.h"
#include "Common/Warnings.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// A name in the words of a reason: of a file, not of the folders that it lies in.
std::string nameOf(const fs::path& path) {
    return path.filename().string();
}

std::vector<std::string> namesOf(const std::vector<KeptOption>& options) {
    std::vector<std::string> names;
    for (const KeptOption& option : options) names.push_back(option.name);
    return names;
}

/// "--method" where only its value differs.
std::string differenceOf(const std::vector<KeptOption>& before,
                         const std::vector<KeptOption>& now) {
    if (namesOf(before) != namesOf(now)) return "other options were given";
    for (std::size_t n = 0; n < now.size(); ++n) {
        if (before[n] != now[n]) return "another " + now[n].name + " was given";
    }
    return {};
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
          inputs_(items_.size()),
          reasons_(items_.size()),
          expected_(findExpected()),
          progress_(common.isQuiet) {}

    int run() {
        if (batch_.skipsExisting) findEarlierRuns();
        std::vector<std::size_t> waiting;
        for (std::size_t n = 0; n < items_.size(); ++n) {
            if (!records_[n]) waiting.push_back(n);
        }
        announce(waiting);
        writePage();
        tellThoseNext();
        runChildren(
            waiting.size(), batch_.jobs.value_or(1),
            [&](std::size_t n) { return start(waiting[n]); },
            [&](std::size_t n, const ChildResult& result) { finish(waiting[n], result); });
        progress_.clear();
        writeFiles();
        if (!common_.isQuiet && !common_.wantsJsonOnStdout()) printTotals();
        flushResults();
        return failedCount() == 0 ? kExitOk : kExitCheckFailed;
    }

private:
    using Planned = std::vector<PlannedRecord>;

    void findEarlierRuns() {
        for (std::size_t n = 0; n < items_.size(); ++n) {
            const Planned planned = plan_.records(items_[n]);
            std::vector<KeptRecord> kept;
            for (const PlannedRecord& record : planned) {
                reasons_[n] = whyAgain(n, record, kept);
                if (!reasons_[n].empty() || kept.empty()) break;
            }
            if (reasons_[n].empty() && kept.size() == planned.size()) {
                records_[n] = together(kept);
            }
            if (reasons_[n] == kNothingThere) reasons_[n].clear();
        }
    }

    /// Why a surface has to be made again; nothing, and its record, when it has not.
    std::string whyAgain(std::size_t n, const PlannedRecord& planned,
                         std::vector<KeptRecord>& kept) {
        RecordFault fault = RecordFault::None;
        std::optional<KeptRecord> record = readRecord(planned.file, fault);
        std::error_code error;
        switch (fault) {
            case RecordFault::None:
                break;
            case RecordFault::Missing:
                return !planned.surface.empty() && fs::exists(planned.surface, error)
                           ? nameOf(planned.surface) + " has no record"
                           : kNothingThere;
            case RecordFault::Damaged:
                return "its record is damaged";
            case RecordFault::OfAnotherVersion:
                return "its record is of another version";
        }
        if (!record->hasEnded) return "its last run did not end";
        if (!record->run.isFinished()) return "its last run failed";
        if (record->version != versionText(program_.name)) return "another version has made it";
        std::string why = differenceOf(record->options, planned.options);
        if (why.empty()) why = changeOfInputs(n, *record);
        if (why.empty()) why = changeOfOutputs(items_[n], *record, planned);
        if (why.empty()) kept.push_back(std::move(*record));
        return why;
    }

    std::string changeOfInputs(std::size_t n, const KeptRecord& record) {
        const std::vector<KeptInput>& now = inputsOf(n);
        if (now.size() != record.inputs.size()) return "its input can't be read, or could not";
        for (std::size_t k = 0; k < now.size(); ++k) {
            if (changeOf(record.inputs[k].file, now[k].file) != FileChange::None) {
                return "the input " + now[k].file.file + " has changed";
            }
        }
        return {};
    }

    /// Surfaces, and what is asked for besides; of what else was written nobody wants to know.
    std::string changeOfOutputs(const BatchItem& item, const KeptRecord& record,
                                const PlannedRecord& planned) const {
        const auto extras = plan_.extras(item);
        for (const auto& [option, path] : extras) {
            if (!isKept(item, record, option, path)) return nameOf(path) + " was not made";
        }
        if (!planned.surface.empty() && record.run.outputs.empty()) return "it holds no surface";
        for (const KeptOutput& output : record.outputs) {
            const bool isAsked = output.option == kOutput ||
                                 std::any_of(extras.begin(), extras.end(), [&](const auto& extra) {
                                     return extra.first == output.option;
                                 });
            if (!isAsked) continue;
            const fs::path path = item.folder / output.file.file;
            constexpr bool kTrustsTimes = false;
            switch (changeOf(output.file, path, kTrustsTimes)) {
                case FileChange::None:
                    break;
                case FileChange::Gone:
                    return nameOf(path) + " is gone";
                case FileChange::Changed:
                    return nameOf(path) + " has changed";
            }
        }
        return {};
    }

    /// The record tells of what an option asks for: of the file, or of one in the folder.
    static bool isKept(const BatchItem& item, const KeptRecord& record, const std::string& option,
                       const fs::path& path) {
        return std::any_of(record.outputs.begin(), record.outputs.end(), [&](const auto& output) {
            const fs::path file = (item.folder / output.file.file).lexically_normal();
            return output.option == option &&
                   (file == path.lexically_normal() ||
                    file.parent_path() == (path / "").lexically_normal().parent_path());
        });
    }

    /// The run that made all of `kept`, or would have.
    static BatchRecord together(std::vector<KeptRecord>& kept) {
        BatchRecord run = std::move(kept.front().run);
        for (std::size_t n = 1; n < kept.size(); ++n) {
            BatchRecord& other = kept[n].run;
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

    /// What the item's run reads, as it was when this was first asked; none when it can't be read.
    const std::vector<KeptInput>& inputsOf(std::size_t n) {
        if (inputs_[n]) return *inputs_[n];
        std::vector<KeptInput>& inputs = inputs_[n].emplace();
        try {
            for (const fs::path& path : plan_.inputs(items_[n])) {
                inputs.push_back({keptInput(path, plan_.folder()), placeOf(items_[n], path)});
            }
        } catch (const FileError&) {
            inputs.clear();  // the run will say so
        }
        return inputs;
    }

    /// From the record's folder, of an input in the folder that all is written to.
    std::string placeOf(const BatchItem& item, const fs::path& input) const {
        if (plan_.folder().empty()) return {};
        const fs::path file = fs::absolute(input).lexically_normal();
        const std::string inBase =
            file.lexically_relative(fs::absolute(plan_.folder()).lexically_normal()).string();
        if (inBase.empty() || inBase.starts_with("..")) return {};
        return file.lexically_relative(fs::absolute(item.folder).lexically_normal()).string();
    }

    /// What has no record gets one that says that it has not ended: if this batch is killed, nobody
    /// who builds the page takes what it left for all.
    void announce(const std::vector<std::size_t>& waiting) const {
        if (!plan_.keepsRecords()) return;
        for (const std::size_t n : waiting) {
            if (!items_[n].folder.empty()) fs::create_directories(items_[n].folder);
            for (const auto& [file, record] : notFinished(n)) {
                if (!fs::exists(file)) writeRecord(file, record);
            }
        }
    }

    std::vector<std::string> start(std::size_t n) {
        const BatchItem& item = items_[n];
        if (!item.folder.empty()) fs::create_directories(item.folder);
        inputs_[n].reset();  // they may have changed since they were looked at
        inputsOf(n);
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

    KeptRecord newRecord(std::size_t n, const PlannedRecord& planned) const {
        KeptRecord record{program_.name, versionText(program_.name)};
        record.run.name = items_[n].name;
        for (const fs::path& input : items_[n].inputs) {
            record.run.files.push_back(baseName(input));
        }
        record.date = recordDate();
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
            detail::removeLeftTemporaries(item.folder.empty() ? "." : item.folder);
        }
        keep(n, record);
        records_[n] = std::move(record);
        tellThoseNext();
        constexpr std::chrono::seconds kBetweenPages(30);
        if (Clock::now() - pageWritten_ > kBetweenPages) writePage();
    }

    void keep(std::size_t n, const BatchRecord& run) {
        const Planned planned = plan_.records(items_[n]);
        const std::vector<KeptInput> inputs = unchangedInputs(n);
        const std::vector<KeptOutput> extras =
            run.isFinished() ? keptExtras(items_[n]) : std::vector<KeptOutput>{};
        for (std::size_t k = 0; k < planned.size(); ++k) {
            KeptRecord record = newRecord(n, planned[k]);
            record.hasEnded = true;
            record.run = planned.size() > 1 ? partOf(run, k) : run;
            record.says = says(record.run);
            record.inputs = inputs;
            for (const std::string& output : record.run.outputs) {
                record.outputs.push_back({kOutput, kept(output, items_[n].folder / output)});
            }
            record.outputs.insert(record.outputs.end(), extras.begin(), extras.end());
            if (plan_.keepsRecords()) {
                writeRecord(planned[k].file, record);
            } else {
                own_[planned[k].file] = std::move(record);
            }
        }
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

    /// None that nobody can tell whether the run has read them before or after they were changed.
    std::vector<KeptInput> unchangedInputs(std::size_t n) {
        std::vector<KeptInput> inputs = inputsOf(n);
        const std::vector<fs::path> paths = plan_.inputs(items_[n]);
        for (std::size_t k = 0; k < inputs.size(); ++k) {
            if (!hasTimesOf(inputs[k].file, paths[k], plan_.folder())) inputs[k].file.sha256 = "";
        }
        return inputs;
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
        if (!common_.wantsJson() || common_.wantsJsonOnStdout()) return;
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(common_.json).writeText(jsonLines_);
        AtomicOutput::commit(outputs);
    }

    /// The scans of a BIDS dataset, all of which a reader of the page expects there.
    std::vector<BatchItem> findExpected() const {
        if (batch_.bids.empty()) return {};
        try {
            return findBidsScans(batch_.bids, {}, plan_.folder());
        } catch (const InvalidInput&) {
            return {};  // surfaces alone are here
        }
    }

    using Clock = std::chrono::steady_clock;

    static constexpr const char* kNothingThere = "nothing is there";
    static constexpr const char* kOutput = "--output";
    static constexpr const char* kSurfaces = "surfaces";

    const BatchProgram& program_;
    const BatchOptions& batch_;
    const CommonOptions& common_;
    const BatchPlan plan_;
    const std::vector<BatchItem>& items_;
    std::vector<std::optional<BatchRecord>> records_;  ///< none: not ended yet
    std::vector<std::optional<std::vector<KeptInput>>> inputs_;
    std::vector<std::string> reasons_;  ///< why it is made again; empty: it was not made before
    Records own_;                       ///< that are kept in no file
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
