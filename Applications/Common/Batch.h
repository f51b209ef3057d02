#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/BatchRecord.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"

namespace adaptiso {

/// The option that says where the output of a run goes.
constexpr const char* kOutputOption = "--output";

/// The input of one run of a batch.
struct BatchItem {
    std::string name;                           ///< replaces {name}, and names the record
    std::vector<std::filesystem::path> inputs;  ///< one, or the surfaces of one head
    std::filesystem::path folder{};             ///< for outputs and record
    std::string fault{};                        ///< why it fails without being run; may be empty
    std::vector<std::string> options{};         ///< of this one alone, as BatchOptions::runOptions
};

/// The program that a batch runs.
struct BatchProgram {
    std::string name;  ///< "adaptiso-mesh"
    /// The value of --output where none is given, with "{name}" or "{file}"; may be empty.
    std::string defaultOutput{};
    /// Options that name a file to read besides the inputs ("--volume"), and files to write.
    std::vector<std::string> inputOptions{}, outputOptions{};
    /// The option of which each value makes a surface ("--iso"), and the files of these surfaces
    /// for a value of --output and these values, as far as known before the run.
    std::string surfaceOption{};
    std::function<std::vector<std::filesystem::path>(const std::filesystem::path&,
                                                     const std::vector<std::string>&)>
        surfaceFiles{};
    bool keepsRecords = true;  ///< also without --output-dir

    // set by adaptiso-bids
    std::filesystem::path executable{};  ///< empty: this program
    std::string version{};               ///< of the executable, as --version prints it
    std::string inputOption{};           ///< that takes the input ("--t1"); empty: none does
    Json request{};                      ///< the request, for the record
    /// Removes the outputs of an earlier run before another is made, so that none stays if it
    /// fails.
    bool removesFormer = false;
    /// The content of "<name>.json" beside the first output of a run that has passed.
    std::function<Json(const BatchItem&, const Json& report)> sidecar{};
};

/// A run of a batch: an item with all that the program's options mean for it.
struct PlannedRun {
    BatchItem item;
    std::filesystem::path record{};  ///< its record's file
    std::vector<std::string> arguments{};
    std::vector<RecordedOption> options{};          ///< that shape the result
    std::vector<std::filesystem::path> inputs{};    ///< the item's, and what options name
    std::vector<std::filesystem::path> surfaces{};  ///< to be made, as far as known; may be empty
    std::filesystem::path outputFolder{};           ///< of --output, from the item's folder
    std::vector<std::pair<std::string, std::filesystem::path>>
        extras{};  ///< "--report" and its file
};

/// "FOLDER/b.nii" of "a/b.nii", for commands on pages: a folder may name a patient. Parts from
/// "{name}" on, and "/" at the end, stay.
std::string withoutFolder(const std::string& path);

/// The runs of `items`, with `batch.runOptions` applied to each.
/// \param folder  that the batch writes to; may be empty
/// \throws InvalidInput  two items have one name, or would write one surface
std::vector<PlannedRun> planRuns(const BatchProgram& program, std::vector<BatchItem> items,
                                 const BatchOptions& batch, const CommonOptions& common);

/// Compares an earlier run's record with what a run would make now: version, options, and the
/// content of inputs and outputs.
struct EarlierRun {
    RecordFault fault = RecordFault::Missing;
    RunRecord record{};      ///< \pre fault is None
    bool isThere = false;    ///< a record or a surface is there
    bool isCurrent = false;  ///< version, options and inputs are the same
    std::string why{};       ///< why to run again; empty: the result would be the same
};

EarlierRun findEarlierRun(const BatchProgram& program, const PlannedRun& run,
                          const std::filesystem::path& folder);

/// Settings and callbacks of runRuns().
struct BatchRunning {
    std::filesystem::path folder;     ///< that the batch writes to; may be empty
    std::filesystem::path summary{};  ///< a page to write; may be empty
    /// For the page, as AtomicOutput takes it.
    std::filesystem::path summaryFolder{};
    std::string command{};             ///< that makes the page again; may be empty
    std::string* jsonLines = nullptr;  ///< takes the lines of --json FILE
};

/// Runs the program once for each of `runs` in processes of their own, `batch.jobs` at a time, and
/// reports each in a line, in their order. A run that fails or crashes does not affect others. Each
/// leaves its record, by which --skip-existing knows finished results and from which the page is
/// made.
/// \return a record of each; where a signal came that the caller's SignalsWait postpones, of those
///         that had ended
std::vector<RunRecord> runRuns(const BatchProgram& program, const std::vector<PlannedRun>& runs,
                               const BatchOptions& batch, const BatchRunning& running,
                               const CommonOptions& common);

/// Names an input.
using NameInput = std::function<std::string(const std::filesystem::path&)>;

/// The items of a list's text: an input a line, with a name after a tab where one is given; with
/// `areOneItem` the surfaces of one head, with tabs between.
/// \param option  "--list heads.txt", for messages
/// \throws InvalidInput, FileError
std::vector<BatchItem> listedItems(std::string_view text, const std::string& option,
                                   bool areOneItem, const NameInput& nameOf);

/// The items of a program's command line: its inputs and those of --list.
/// \param areOneItem  the inputs, and those of a line of --list, are one item
/// \throws InvalidInput, FileError
std::vector<BatchItem> findBatchItems(const BatchOptions& batch,
                                      const std::vector<std::filesystem::path>& inputs,
                                      const NameInput& nameOf, bool areOneItem = false);

/// Prints how many of `records` failed, by reason, and how many have which warning; then what was
/// written, which may be empty, and what to do next.
/// \param thing  "input"
void printTotals(const std::vector<RunRecord>& records, const std::string& thing,
                 const std::filesystem::path& written, const std::vector<std::string>& toDo);

/// The batch mode of a program: plans, runs, prints totals, writes page and JSON lines.
/// A signal ends it when the results until then are written.
/// \return kExitOk, or kExitCheckFailed if any input failed
/// \throws UsageError    options that don't go together, an output that all runs would write
/// \throws FileError     summary or report can't be written
int runBatch(const BatchProgram& program, std::vector<BatchItem> items, const BatchOptions& batch,
             const CommonOptions& common);

}  // namespace adaptiso
