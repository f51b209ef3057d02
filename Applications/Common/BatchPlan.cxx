#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <thread>

#include "Common/Batch.h"
#include "Common/BatchSummary.h"
#include "Common/Log.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Common/UsageWords.h"
#include "Common/Verdict.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kName = "{name}";

bool isIn(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// "--output" and its value, of "--output=value".
std::pair<std::string, std::string> split(const std::string& option) {
    const std::size_t equals = option.find('=');
    if (equals == std::string::npos) return {option, ""};
    return {option.substr(0, equals), option.substr(equals + 1)};
}

std::string folderName(const fs::path& file) {
    const fs::path folder = fs::weakly_canonical(fs::absolute(file)).parent_path();
    return folder.has_filename() ? folder.filename().string() : "surfaces";
}

std::string textOf(const fs::path& list, const std::string& option) {
    std::ifstream file;
    if (list != "-") file.open(list);
    if (!file || fs::is_directory(list)) throw FileError(option + ": can't be read");
    std::istream& in = list == "-" ? std::cin : file;
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (in.bad()) throw FileError(option + ": can't be read");
    return text;
}

/// Advice on the first input that is no file and looks like the value of an option; empty if none
/// does.
std::string strayValue(std::span<const BatchItem> items) {
    for (const BatchItem& item : items) {
        for (const fs::path& input : item.inputs) {
            std::error_code error;
            const bool isName = input.has_extension() && !parseFiniteNumber(input.string());
            if (isName || input.has_parent_path() || fs::exists(input, error)) continue;
            return shown(input.string()) +
                   ": no such file; several values of an option are given with commas (--labels "
                   "1,2), or the option again (--iso 80 --iso 100)";
        }
    }
    return {};
}

void checkOptions(const BatchProgram& program, const BatchOptions& batch,
                  std::span<const BatchItem> items) {
    const auto require = [](bool isGood, const std::string& message) {
        if (!isGood) throw UsageError(message);
    };
    require(!batch.skipsExisting || program.keepsRecords || !batch.outputFolder.empty(),
            "--skip-existing: needs --output-dir, where records are kept");
    for (const std::string& option : batch.runOptions) {
        const auto [name, value] = split(option);
        if (!isIn(program.outputOptions, name)) continue;
        require(name != kOutputOption || batch.outputFolder.empty() || staysBelow(value),
                name + " " + value + ": must be a name below --output-dir");
        const fs::path folder = fs::path(value).parent_path();
        const bool isFile = name == kOutputOption || name == "--report";
        if (isFile && !folder.empty() && !holdsName(folder)) {
            checkOutput(batch.outputFolder / value);  // once for all inputs
        }
        if (holdsName(value) || items.size() == 1) continue;
        const std::string stray = strayValue(items);
        if (!stray.empty()) throw UsageError(stray);
        throw UsageError(name + " " + value + ": needs {name} in it" +
                         (name == kOutputOption ? " (or / at its end, for a folder)" : "") +
                         ", or the runs for all inputs would write the same");
    }
}

/// "2 failed: holds no label: a.nii, b.nii".
void printReasons(std::span<const SummaryReason> reasons, const std::string& words) {
    constexpr std::size_t kMostGroups = 6, kMostNames = 4;
    for (std::size_t n = 0; n < std::min(kMostGroups, reasons.size()); ++n) {
        std::vector<std::string> names = reasons[n].names;
        const std::size_t count = names.size();
        if (count > kMostNames) names.resize(kMostNames);
        std::cout << oneLine("  " + std::to_string(count) + " " + words + " " + reasons[n].reason +
                             ": " + joined(names) + (count > kMostNames ? ", ..." : ""))
                  << '\n';
    }
    if (reasons.size() > kMostGroups) {
        std::cout << "  and " << reasons.size() - kMostGroups << " more kinds\n";
    }
}

/// The command that makes the page again. Folders, which may name a patient, are left out, those
/// of options' values replaced by FOLDER.
std::string commandOf(const BatchProgram& program, const BatchOptions& batch) {
    std::string words = program.name;
    const auto lastOf = [](const fs::path& path) {
        return baseName(path.has_filename() ? path : path.parent_path());
    };
    const auto add = [&](const char* option, const fs::path& path) {
        if (!path.empty()) words += std::string(" ") + option + " " + shellQuoted(lastOf(path));
    };
    if (batch.list.empty()) words += " INPUT...";
    add("--list", batch.list);
    for (const std::string& option : batch.runOptions) {
        const auto [name, value] = split(option);
        const bool isPath = value.find('/') != std::string::npos;
        words += " " + shellQuoted(isPath ? name + "=" + withoutFolder(value) : option);
    }
    add("--output-dir", batch.outputFolder);
    add("--summary", batch.summary);
    return words + (program.keepsRecords || !batch.outputFolder.empty() ? " --skip-existing" : "");
}

}  // namespace

std::string withoutFolder(const std::string& path) {
    const std::size_t name = path.find("{name}"), last = path.find_last_not_of('/');
    const std::size_t end = path.rfind('/', std::min(name, last));
    return end == std::string::npos ? path : "FOLDER" + path.substr(end);
}

std::vector<BatchItem> findBatchItems(const BatchOptions& batch,
                                      const std::vector<fs::path>& inputs, const NameInput& nameOf,
                                      bool areOneItem) {
    std::vector<BatchItem> items;
    if (areOneItem && !inputs.empty()) items.push_back({folderName(inputs.front()), inputs});
    if (!areOneItem) {
        for (const fs::path& input : inputs) items.push_back({nameOf(input), {input}});
    }
    if (!batch.list.empty()) {
        const std::string option = "--list " + batch.list.string();
        const NameInput nameItem = areOneItem ? folderName : nameOf;
        for (BatchItem& item :
             listedItems(textOf(batch.list, option), option, areOneItem, nameItem)) {
            items.push_back(std::move(item));
        }
    }
    for (BatchItem& item : items) item.folder = batch.outputFolder;
    return items;
}

std::vector<PlannedRun> planRuns(const BatchProgram& program, std::vector<BatchItem> items,
                                 const BatchOptions& batch, const CommonOptions& common) {
    std::map<fs::path, const PlannedRun*> names, files;
    const auto refuse = [&](const BatchItem& a, const PlannedRun* b, const std::string& why) {
        throw InvalidInput(a.inputs.front().string() + " and " + b->item.inputs.front().string() +
                           ": both " + why);
    };
    std::string threads;
    if (common.threads) {
        threads = "--threads=" + std::to_string(*common.threads);
    } else if (batch.jobs.value_or(1) > 1) {
        const int machine = static_cast<int>(std::thread::hardware_concurrency());
        threads = "--threads=" + std::to_string(std::max(1, machine / *batch.jobs));
    }
    std::vector<PlannedRun> runs;
    runs.reserve(items.size());
    for (BatchItem& each : items) {
        PlannedRun& run = runs.emplace_back(PlannedRun{std::move(each)});
        const BatchItem& item = run.item;
        run.inputs = item.inputs;
        // an input "...nii" has the stem ".."
        if (!staysBelow(item.name) || item.name == ".") {
            throw InvalidInput(item.inputs.front().string() + ": " + shown(item.name) +
                               " is no name for files; rename the file");
        }
        // a run of it would be many inputs again, and so without end
        if (holdsName(item.name)) {
            throw InvalidInput(item.inputs.front().string() +
                               ": the name has {name} in it, which stands for the inputs' names; "
                               "rename the file");
        }
        std::string output =
            replaced(program.defaultOutput, "{file}", item.inputs.front().filename().string());
        std::vector<std::string> surfaceValues;
        std::vector<std::string> options = batch.runOptions;
        options.insert(options.end(), item.options.begin(), item.options.end());
        for (const std::string& option : options) {
            const auto [name, pattern] = split(option);
            const std::string value = replaced(pattern, kName, item.name);
            if (name == kOutputOption) {
                output = pattern;
            } else if (isIn(program.outputOptions, name)) {
                run.extras.emplace_back(name, item.folder / value);
                run.arguments.push_back(name + "=" + (item.folder / value).string());
            } else {
                run.arguments.push_back(replaced(option, kName, item.name));
                if (isIn(program.inputOptions, name)) {
                    run.inputs.emplace_back(value);
                    continue;
                }
                run.options.push_back({name, sha256Of(value)});
                if (name == program.surfaceOption) surfaceValues.push_back(value);
            }
        }
        output = replaced(output, kName, item.name);
        run.record = item.folder / item.name;
        if (!output.empty()) {
            run.outputFolder = output;
            run.arguments.push_back(std::string(kOutputOption) + "=" +
                                    (item.folder / output).string());
            if (program.surfaceFiles && !surfaceValues.empty()) {
                run.surfaces = program.surfaceFiles(item.folder / output, surfaceValues);
                run.record = run.surfaces.front();
            }
        }
        run.record = recordFile(item.folder, run.record, program.name);
        if (!threads.empty()) run.arguments.push_back(threads);
        run.arguments.insert(run.arguments.end(), {"--quiet", "--no-warnings", "--json=-"});
        if (program.inputOption.empty()) run.arguments.emplace_back("--");
        for (const fs::path& input : item.inputs) {
            run.arguments.push_back((program.inputOption.empty() ? "" : program.inputOption + "=") +
                                    input.string());
        }
        if (const auto [at, isNew] = names.emplace(item.folder / item.name, &run); !isNew) {
            refuse(item, at->second,
                   "are named '" + item.name +
                       "'; give a --list with a line each: the file, a tab and its name");
        }
        for (const fs::path& surface : run.surfaces) {
            if (const auto [at, isNew] = files.emplace(surface, &run); !isNew) {
                refuse(item, at->second, "would write " + surface.filename().string());
            }
        }
    }
    return runs;
}

void printTotals(const std::vector<RunRecord>& records, const std::string& thing,
                 const fs::path& written, const std::vector<std::string>& toDo) {
    std::vector<SummaryRow> rows;
    for (const RunRecord& record : records) rows.push_back(recordRow(record));
    const std::vector<SummaryReason> reasons = reasonsOf(rows);
    const auto warnings =
        std::ranges::find_if(reasons, std::mem_fn(&SummaryReason::isWarning)) - reasons.begin();
    const auto failed = std::ranges::count_if(records, std::not_fn(&RunRecord::hasPassed));
    const auto before = std::ranges::count_if(records, std::mem_fn(&RunRecord::isOfEarlierRun));
    std::cout << counted(std::ssize(records), thing) << ", " << failed << " failed";
    if (before > 0) std::cout << ", " << before << " of an earlier run";
    std::cout << '\n';
    const std::span<const SummaryReason> all(reasons.data(), reasons.size());
    printReasons(all.first(static_cast<std::size_t>(warnings)), "failed:");
    printReasons(all.subspan(static_cast<std::size_t>(warnings)), "with the warning");
    std::string line = written.empty() ? "" : "Wrote " + written.string();
    if (!toDo.empty()) line += (line.empty() ? "Next: " : "; next: ") + joined(toDo, "; ");
    if (!line.empty()) std::cout << oneLine(line) << '\n';
}

int runBatch(const BatchProgram& program, std::vector<BatchItem> items, const BatchOptions& batch,
             const CommonOptions& common) {
    checkOptions(program, batch, items);
    BatchRunning running{batch.outputFolder, batch.summary};
    running.command = commandOf(program, batch);
    const std::vector<PlannedRun> runs = planRuns(program, std::move(items), batch, common);
    if (!running.folder.empty()) makeFolders(running.folder);
    if (running.summary.empty() && !running.folder.empty()) {
        running.summary = running.folder / "summary.html";
        running.summaryFolder = running.folder;
    }
    if (batch.table == "-") throw UsageError("--csv -: give a file");
    std::set<fs::path> outputs;
    struct Output {
        std::string option;
        fs::path file;
        std::optional<TextKind> kind;
    };
    for (const auto& [option, file, kind] :
         {Output{"--summary", running.summary, TextKind::Page},
          Output{"--csv", batch.table, TextKind::Table},
          Output{"--json", fs::path(common.json), TextKind::Report},
          Output{"--log", logFile(), {}}}) {
        if (file.empty() || file == "-") continue;
        std::error_code error;
        if (!outputs.insert(fs::weakly_canonical(fs::absolute(file, error), error)).second) {
            throw UsageError(option + " " + file.string() + ": is the name of another output too");
        }
        if (!batch.list.empty() && batch.list != "-") checkNotInput(file, batch.list);
        checkOutput(file, file == running.summary ? running.summaryFolder : fs::path());
        for (const PlannedRun& run : runs) {
            for (const fs::path& input : run.inputs) checkNotInput(file, input);
        }
        if (kind) requireKind(option, file, *kind);
    }
    const detail::SignalsWait untilResultsAreWritten;
    std::string lines;
    running.jsonLines = &lines;
    const std::vector<RunRecord> records = runRuns(program, runs, batch, running, common);
    const bool isInterrupted = detail::SignalsWait::hasCome();
    if (!isInterrupted || !records.empty()) {  // what is there may be of a whole batch
        if (common.wantsJson() && !common.wantsJsonOnStdout()) writeWhole(common.json, lines);
        if (!batch.table.empty()) writeWhole(batch.table, batchTable(records));
    }
    if (isInterrupted) {
        printError(program.name,
                   "interrupted after " + std::to_string(records.size()) + " of " +
                       counted(std::ssize(runs), "input") +
                       (program.keepsRecords || !running.folder.empty()
                            ? "; the same command with --skip-existing does the others"
                            : ""));
        flushResults();
        return kExitCheckFailed;  // as the signal ends the program
    }
    const bool haveAllPassed = std::ranges::all_of(records, std::mem_fn(&RunRecord::hasPassed));
    if (!common.isQuiet && !common.wantsJsonOnStdout()) {
        std::vector<std::string> toDo;
        if (!running.summary.empty()) {
            toDo.push_back("open " + shellQuoted(running.summary.string()) + " in a browser");
        }
        if (!haveAllPassed && (program.keepsRecords || !running.folder.empty())) {
            toDo.emplace_back("mend what failed, run again with --skip-existing");
        }
        printTotals(records, "input", running.summary, toDo);
    }
    flushResults();
    return haveAllPassed ? kExitOk : kExitCheckFailed;
}

}  // namespace adaptiso
