#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <optional>

#include "Common/Batch.h"
#include "Common/BatchSummary.h"
#include "Common/Log.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

RecordedFile described(const std::string& option, const std::string& name, const fs::path& path) {
    RecordedFile file;
    file.file = name;
    try {
        file = describeFile(name, path);
    } catch (const FileError&) {
        // without a checksum it will count as changed
    }
    file.option = option;
    return file;
}

/// The inputs of a run with checksums; empty if one can't be read, which the run will report.
std::vector<RecordedFile> describedInputs(const PlannedRun& run, const fs::path& folder) {
    std::vector<RecordedFile> inputs;
    try {
        for (const fs::path& path : run.inputs) {
            inputs.push_back(describeInput(path, folder));
            if (folder.empty()) continue;
            const fs::path file = fs::absolute(path).lexically_normal();
            const std::string inFolder =
                file.lexically_relative(fs::absolute(folder).lexically_normal()).string();
            if (inFolder.empty() || inFolder.starts_with("..")) continue;
            const fs::path place =
                file.lexically_relative(fs::absolute(run.item.folder).lexically_normal());
            if (staysBelow(place)) inputs.back().place = place.string();
        }
    } catch (const FileError&) {
        inputs.clear();
    }
    return inputs;
}

using Files = std::vector<std::string>;

/// A value of resultJson(); `missing` where the report has none.
template <class Value>
Value resultOf(const Json& report, const char* key, const Value& missing) {
    return report.value("result", Json::object()).value(key, missing);
}

/// "a.json" of "a.vtp" and of "a/walls.vtp".
std::string sidecarName(const fs::path& output) {
    const std::string top = *output.begin();
    return top.substr(0, top.find('.')) + ".json";
}

/// What requireNoLink() says of `files`; may be empty.
std::string linkFaultOf(const std::vector<fs::path>& files, const fs::path& folder) {
    try {
        for (const fs::path& file : files) {
            if (!file.empty()) requireNoLink(file, folder);
        }
        return {};
    } catch (const FileError& error) {
        return error.what();
    }
}

/// Why nothing may be written where `run` puts its files: a link that nobody named stands there.
/// May be empty. \param folder  that the batch writes to; may be empty
std::string linkFault(const BatchProgram& program, const PlannedRun& run, const fs::path& folder) {
    std::vector<fs::path> files{run.surfaces};
    if (!run.outputFolder.empty()) files.push_back(run.item.folder / run.outputFolder);
    if (program.sidecar) {
        for (std::size_t n = files.size(); n-- > 0;) {
            files.push_back(files[n].parent_path() / sidecarName(files[n].filename()));
        }
    }
    files.insert(files.end(), {run.item.folder, run.record});
    for (const auto& extra : run.extras) files.push_back(extra.second);
    return linkFaultOf(files, folder);
}

class BatchRun {
public:
    BatchRun(const BatchProgram& program, const std::vector<PlannedRun>& runs,
             const BatchOptions& batch, const BatchRunning& running, const CommonOptions& common)
        : program_(program),
          runs_(runs),
          batch_(batch),
          running_(running),
          common_(common),
          keepsRecords_(program.keepsRecords || !running.folder.empty()),
          ended_(runs.size()),
          reasons_(runs.size()),
          areCurrent_(runs.size()),
          inputs_(runs.size()),
          progress_(common.isQuiet) {
        for (const PlannedRun& run : runs_) {
            linkFaults_.push_back(linkFault(program_, run, running_.folder));
        }
    }

    std::vector<RunRecord> run() {
        try {
            runAll();
        } catch (...) {
            removeAnnounced();
            throw;
        }
        std::vector<RunRecord> records;
        for (auto& record : ended_) {
            if (record) records.push_back(std::move(*record));
        }
        return records;
    }

private:
    void runAll() {
        std::vector<std::size_t> waiting;
        for (std::size_t n = 0; n < runs_.size(); ++n) {
            if (detail::SignalsWait::hasCome()) return printNext();
            if (!takeEarlier(n, true)) waiting.push_back(n);
        }
        waiting_ = waiting.size();
        for (const std::size_t n : waiting) announce(n);
        writePage();
        printNext();
        for (const std::size_t n : waiting) {
            if (fault(n).empty()) continue;
            finish(n, {.exitCode = kExitBadInput, .errors = fault(n)});
        }
        waiting_ -= finished_;
        finished_ = 0;
        start_ = Clock::now();
        runChildren(
            waiting.size(), batch_.jobs.value_or(1),
            [&](std::size_t n) { return start(waiting[n]); },
            [&](std::size_t n, const ChildResult& result) { finish(waiting[n], result); },
            program_.executable);
        printNext();
        progress_.clear();
        writePage();
    }

    /// Why a run fails without being started; may be empty.
    const std::string& fault(std::size_t n) const {
        return linkFaults_[n].empty() ? runs_[n].item.fault : linkFaults_[n];
    }

    bool keepsRecord(std::size_t n) const { return keepsRecords_ && linkFaults_[n].empty(); }

    /// With --skip-existing, takes the result of an earlier run, or of another batch meanwhile.
    /// \param isFirst  its record does not say yet that it is running
    bool takeEarlier(std::size_t n, bool isFirst = false) {
        if (!batch_.skipsExisting || !fault(n).empty()) return false;
        EarlierRun earlier = findEarlierRun(program_, runs_[n], running_.folder);
        if (isFirst) {
            reasons_[n] = earlier.isThere ? earlier.why : "";
            areCurrent_[n] = earlier.isCurrent;
        }
        if (!earlier.why.empty()) return false;
        if (!program_.request.is_null() && earlier.record.request != program_.request) {
            earlier.record.request = program_.request;  // the same result, in other words
            writeRecord(runs_[n].record, earlier.record);
        }
        earlier.record.isOfEarlierRun = true;
        ended_[n] = std::move(earlier.record);
        return true;
    }

    RunRecord newRecord(std::size_t n) const {
        const PlannedRun& run = runs_[n];
        RunRecord record{program_.name, program_.version};
        if (record.version.empty()) record.version = versionText(program_.name);
        record.name = run.item.name;
        for (const fs::path& input : run.item.inputs) record.files.push_back(baseName(input));
        record.date = recordDate();
        record.request = program_.request;
        record.options = run.options;
        return record;
    }

    /// Leaves a record of a run to come, so that pages name it even if this batch is killed.
    void announce(std::size_t n) {
        if (!keepsRecord(n)) return;
        if (!runs_[n].item.folder.empty()) makeFolders(runs_[n].item.folder, running_.folder);
        if (fs::exists(runs_[n].record)) return;
        writeRecord(runs_[n].record, newRecord(n));
        announced_.push_back(runs_[n].record);
    }

    void removeAnnounced() const {
        RunRecord record;
        std::error_code error;
        for (const fs::path& file : announced_) {
            const bool isRead = readRecord(file, record) == RecordFault::None;
            if (isRead && !record.hasEnded) fs::remove(file, error);
        }
    }

    /// \return the arguments; empty: there is nothing left to do
    std::vector<std::string> start(std::size_t n) {
        const PlannedRun& run = runs_[n];
        if (ended_[n]) return {};
        if (takeEarlier(n)) {
            --waiting_;
            printNext();
            return {};
        }
        if (!run.item.folder.empty()) makeFolders(run.item.folder, running_.folder);
        if (program_.removesFormer && !areCurrent_[n]) removeFormer(run);
        inputs_[n] = describedInputs(run, running_.folder);
        if (keepsRecord(n)) writeRecord(run.record, newRecord(n));
        return run.arguments;
    }

    /// Files that were edited since stay.
    void removeFormer(const PlannedRun& run) const {
        RunRecord former;
        if (readRecord(run.record, former) != RecordFault::None) return;
        for (const RecordedFile& output : former.recordedOutputs) {
            const fs::path path = run.item.folder / output.file;
            std::error_code error;
            // neither another folder's file nor one of an annex, which is for reading
            if (!linkFaultOf({path}, run.item.folder).empty()) continue;
            if (changeOf(output, path) != FileChange::None) continue;
            fs::remove(path, error);
            for (fs::path folder = path.parent_path(); folder != run.item.folder && !error;
                 folder = folder.parent_path()) {
                if (!fs::is_empty(folder, error) || !fs::remove(folder, error)) break;
            }
        }
    }

    void finish(std::size_t n, const ChildResult& result) {
        const PlannedRun& run = runs_[n];
        const fs::path folder = run.item.folder.empty() ? fs::path(".") : run.item.folder;
        RunRecord record = newRecord(n);
        record.madeAgain = reasons_[n];
        ++finished_;
        addResult(result, run.item.inputs, record);
        if (result.signal != 0) detail::removeLeftTemporaries(folder, result.process);
        // of two batches in one folder the slower may fail where the other has finished
        if (record.isFinished() || !takeEarlier(n)) {
            addFiles(n, record);
            if (keepsRecord(n)) writeRecord(run.record, record);
            ended_[n] = std::move(record);
        }
        printNext();
        constexpr std::chrono::seconds kBetweenPages(30);
        if (Clock::now() - pageWritten_ > kBetweenPages) writePage();
    }

    /// Inputs and outputs with checksums; and the result in words.
    void addFiles(std::size_t n, RunRecord& record) const {
        const PlannedRun& run = runs_[n];
        record.inputs = inputs_[n];
        for (std::size_t k = 0; k < record.inputs.size(); ++k) {
            // changed meanwhile: the run may have read either content
            if (!hasTimes(record.inputs[k], run.inputs[k], running_.folder)) {
                record.inputs[k].sha256.clear();
            }
        }
        record.says = says(record);
        if (!record.report.is_object()) return;
        const auto add = [&](const std::string& option, const std::string& name) {
            record.recordedOutputs.push_back(described(option, name, run.item.folder / name));
        };
        for (const std::string& file : resultOf(record.report, "files", Files())) {
            record.outputs.push_back((run.outputFolder.parent_path() / file).string());
            add(kOutputOption, record.outputs.back());
        }
        if (record.hasPassed() && program_.sidecar) {
            std::vector<Json> parts{record.report};  // one for each surface
            for (std::size_t k = 0; program_.surfaceFiles && k < record.outputs.size(); ++k) {
                parts.resize(k + 1, record.report);
                parts[k]["surfaces"] = Json::array({record.report.at("surfaces").at(k)});
            }
            const std::vector<std::string> made = record.outputs;
            for (std::size_t k = 0; k < std::min(parts.size(), made.size()); ++k) {
                const std::string name = sidecarName(made[k]);
                writeWhole(run.item.folder / name,
                           jsonText(program_.sidecar(run.item, parts[k])) + "\n", run.item.folder);
                add(kOutputOption, name);
            }
        }
        for (const auto& [option, path] : run.extras) {
            const bool mayBeEarlier = !record.isFinished() && option != "--report";
            if (mayBeEarlier) continue;  // pictures of another run
            for (const fs::path& file : filesOfInput(path, {})) {
                if (!fs::exists(file)) continue;
                const fs::path base = run.item.folder.empty() ? "." : run.item.folder;
                const fs::path name = file.lexically_proximate(base);
                if (staysBelow(name)) add(option, name.string());
            }
        }
    }

    std::string says(const RunRecord& record) const {
        if (!record.error.empty()) return record.error;
        if (!record.report.is_object()) return "";
        if (!record.report.value("failedByWarnings", false)) {
            return resultOf(record.report, "says", std::string());
        }
        return strictFailure(common_, record.warnings, "");
    }

    /// Reports the runs whose turn has come: in the order of the inputs, whichever ended first.
    void printNext() {
        progress_.clear();
        const bool isLast = detail::SignalsWait::hasCome();
        for (; printed_ < runs_.size() && (ended_[printed_] || isLast); ++printed_) {
            if (ended_[printed_]) print(runs_[printed_].item, *ended_[printed_]);
        }
        if (printed_ < runs_.size()) {
            progress_.show(std::to_string(printed_) + " of " + std::to_string(runs_.size()) +
                           timeLeft());
        }
    }

    /// ", about 40 min left", by the runs that have ended; empty before the first.
    std::string timeLeft() const {
        constexpr double kMinute = 60, kLongMinutes = 90;
        if (finished_ == 0) return "";
        const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count(),
                     left = elapsed / static_cast<double>(finished_) *
                            static_cast<double>(waiting_ - std::min(waiting_, finished_));
        const double minutes = std::ceil(left / kMinute);
        return minutes <= kLongMinutes ? ", about " + formatRounded(minutes) + " min left"
                                       : ", about " + formatRounded(minutes / kMinute) + " h left";
    }

    void print(const BatchItem& item, const RunRecord& record) const {
        const std::string name = item.inputs.front().string();
        printWarnings(program_.name, common_, record.warnings);
        const std::string json = jsonText(lineJson(record), -1) + "\n";
        if (common_.wantsJsonOnStdout()) std::cout << json << std::flush;
        if (running_.jsonLines != nullptr) *running_.jsonLines += json;
        const char* const state = !record.hasPassed()     ? "FAILED"
                                  : record.isOfEarlierRun ? "before"
                                                          : "done  ";
        const std::string again =
            record.madeAgain.empty() ? "" : "; made again: " + record.madeAgain;
        const auto line = [&](const std::string& of) {
            return oneLine(std::string(state) + "  " + of + ": " + says(record) + ", " +
                           formatFixed(record.seconds, 2) + " s" + again);
        };
        addToLog(line(joined(record.files)));
        if (!common_.isQuiet && !common_.wantsJsonOnStdout()) {
            std::cout << line(name) << std::endl;
        } else if (!record.hasPassed()) {
            printError(program_.name, "failed: " + name + ": " + says(record));
        }
    }

    /// The page as of now, on which runs that have not ended are not finished.
    void writePage() {
        pageWritten_ = Clock::now();
        if (running_.summary.empty()) return;
        std::map<fs::path, RunRecord> own;
        for (std::size_t n = 0; n < runs_.size(); ++n) {
            if (!ended_[n]) own.emplace(runs_[n].record, newRecord(n));
            if (ended_[n] && !keepsRecord(n)) own.emplace(runs_[n].record, *ended_[n]);
        }
        Summary summary{.program = program_.name + " " + programVersion(),
                        .command = running_.command};
        writeSummary(running_.summary, running_.folder, own, running_.summaryFolder,
                     std::move(summary));
    }

    using Clock = std::chrono::steady_clock;

    const BatchProgram& program_;
    const std::vector<PlannedRun>& runs_;
    const BatchOptions& batch_;
    const BatchRunning& running_;
    const CommonOptions& common_;
    const bool keepsRecords_;
    std::vector<std::optional<RunRecord>> ended_;    ///< empty while it has not ended
    std::vector<std::string> linkFaults_;            ///< linkFault(), which is no run's
    std::vector<std::string> reasons_;               ///< to run again
    std::vector<bool> areCurrent_;                   ///< EarlierRun::isCurrent
    std::vector<std::vector<RecordedFile>> inputs_;  ///< as of the run's start
    std::vector<fs::path> announced_;                ///< records that were not there before
    Clock::time_point pageWritten_{};
    ProgressLine progress_;
    std::size_t printed_ = 0;
    Clock::time_point start_{};               ///< of the first run
    std::size_t waiting_ = 0, finished_ = 0;  ///< runs to make, and those that have ended
};

std::string differenceOf(const std::vector<RecordedOption>& before,
                         const std::vector<RecordedOption>& now) {
    const bool haveSameNames = std::equal(
        before.begin(), before.end(), now.begin(), now.end(),
        [](const RecordedOption& a, const RecordedOption& b) { return a.name == b.name; });
    if (!haveSameNames) return "other options were given";
    const auto [was, is] = std::mismatch(before.begin(), before.end(), now.begin(), now.end());
    return is == now.end() ? "" : "another " + is->name + " was given";
}

std::string changeOfInputs(const PlannedRun& run, const RunRecord& record, const fs::path& folder) {
    bool areSame = run.inputs.size() == record.inputs.size();
    for (std::size_t k = 0; areSame && k < run.inputs.size(); ++k) {
        areSame =
            !record.inputs[k].sha256.empty() && hasTimes(record.inputs[k], run.inputs[k], folder);
    }
    if (areSame) return {};
    const std::vector<RecordedFile> now = describedInputs(run, folder);
    if (now.size() != record.inputs.size()) return "its input can't be read, or could not";
    for (std::size_t k = 0; k < now.size(); ++k) {
        if (!isSameContent(record.inputs[k], now[k])) {
            return "the input " + now[k].file + " has changed";
        }
    }
    return {};
}

/// Compares surfaces and requested extras; other outputs are ignored.
std::string changeOfOutputs(const PlannedRun& run, const RunRecord& record) {
    for (const auto& extra : run.extras) {
        const fs::path wanted = extra.second.lexically_normal(), folder = wanted / "";
        const bool isRecorded =
            std::ranges::any_of(record.recordedOutputs, [&](const RecordedFile& output) {
                const fs::path file = (run.item.folder / output.file).lexically_normal();
                return output.option == extra.first &&
                       (file == wanted || file.parent_path() / "" == folder);
            });
        // one elsewhere is in no record
        const bool isElsewhere = !staysBelow(wanted.lexically_proximate(run.item.folder / ""));
        if (!isRecorded && !(isElsewhere && fs::exists(wanted))) {
            return wanted.filename().string() + " was not made";
        }
    }
    if (record.outputs.size() < run.surfaces.size()) return "it lacks a surface";
    for (const std::string& output : record.outputs) {
        const bool isRecorded = std::ranges::any_of(record.recordedOutputs, [&](const auto& file) {
            return file.option == kOutputOption && file.file == output;
        });
        if (!isRecorded) return "its record is damaged";
    }
    for (const RecordedFile& output : record.recordedOutputs) {
        const bool isWanted = output.option == kOutputOption ||
                              std::ranges::any_of(run.extras, [&](const auto& extra) {
                                  return extra.first == output.option;
                              });
        const fs::path path = run.item.folder / output.file;
        const FileChange change = isWanted ? changeOf(output, path) : FileChange::None;
        if (change != FileChange::None) return path.filename().string() + " " + changeText(change);
    }
    return {};
}

}  // namespace

EarlierRun findEarlierRun(const BatchProgram& program, const PlannedRun& run,
                          const fs::path& folder) {
    EarlierRun earlier;
    earlier.fault = readRecord(run.record, earlier.record);
    const RunRecord& record = earlier.record;
    std::error_code error;
    const auto surface = std::ranges::find_if(
        run.surfaces, [&](const fs::path& file) { return fs::exists(file, error); });
    earlier.isThere = earlier.fault != RecordFault::Missing || surface != run.surfaces.end();
    const std::string version =
        program.version.empty() ? versionText(program.name) : program.version;
    if (!earlier.isThere) {
        earlier.why = "nothing is there";
    } else if (earlier.fault == RecordFault::Missing) {
        earlier.why = surface->filename().string() + " has no record";
    } else if (earlier.fault == RecordFault::Damaged) {
        earlier.why = "its record is damaged";
    } else if (earlier.fault == RecordFault::OfAnotherVersion) {
        earlier.why = "its record is of another version";
    } else if (!record.hasEnded) {
        earlier.why = "it was not run to its end";
    } else if (!record.isFinished()) {
        earlier.why = "its last run failed";
    } else if (record.version != version) {
        earlier.why = "another version has made it";
    } else {
        earlier.why = differenceOf(record.options, run.options);
        if (earlier.why.empty()) earlier.why = changeOfInputs(run, record, folder);
        earlier.isCurrent = earlier.why.empty();
        if (earlier.isCurrent) earlier.why = changeOfOutputs(run, record);
    }
    return earlier;
}

std::vector<RunRecord> runRuns(const BatchProgram& program, const std::vector<PlannedRun>& runs,
                               const BatchOptions& batch, const BatchRunning& running,
                               const CommonOptions& common) {
    return BatchRun(program, runs, batch, running, common).run();
}

}  // namespace adaptiso
