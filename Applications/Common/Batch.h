#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/BatchOptions.h"
#include "Common/BatchRecord.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"

namespace adaptiso {

/// What a program brings to a batch of its runs.
struct BatchProgram {
    std::string name;                           ///< "adaptiso-mesh"
    std::vector<std::filesystem::path> inputs;  ///< of the command line
    bool isOneItem = false;    ///< the inputs, and those of a line of --list, belong together
    bool keepsRecords = true;  ///< also where no folder is named
    /// Options that name a file that a run reads besides its inputs: "--volume".
    std::vector<std::string> inputOptions{};
    /// The option of which each value makes a surface ("--iso"), and the files of the surfaces that
    /// a run with this --output and these values makes, as far as they can be told before it. The
    /// n-th of `surfaces` in the run's report tells of the n-th. Empty: a run makes no surface.
    std::string surfaceOption{};
    std::function<std::vector<std::filesystem::path>(const std::filesystem::path&,
                                                     const std::vector<std::string>&)>
        surfaceFiles{};
    /// Options that name what a run writes: "--output". Relative names go into the item's folder.
    std::vector<std::string> outputOptions;
    /// Given to every run that has no --output; empty: none. With --bids the second.
    std::string defaultOutput, defaultBidsOutput;
    /// The same where it depends on the item, in place of both.
    std::function<std::string(const BatchItem&)> defaultOutputOf{};
    std::function<std::string(const std::filesystem::path&)> nameOf;
    /// findBidsScans() or findBidsSurfaces()
    std::function<std::vector<BatchItem>(const std::filesystem::path&,
                                         const std::vector<std::string>&,
                                         const std::filesystem::path&)>
        findInBids;
    /// From the report of a run: its result in a few words; the files that it wrote under
    /// --output, without the folders of that ({name} stands for the item's name).
    std::function<std::string(const Json&)> says;
    std::function<std::vector<std::string>(const Json&)> outputs;

    // of a program that runs others, one batch of each after the other
    std::filesystem::path executable{};  ///< empty: this very program
    std::string inputOption{};           ///< that takes the input ("--t1"); empty: none does
    std::string version{};               ///< what the executable's --version prints; empty: ours
    /// The page, the dataset's description and the totals are the caller's business, and so is the
    /// file of --json: its lines go to `jsonLines`.
    bool isPartOfApp = false;
    std::string* jsonLines = nullptr;
    /// The caller's own request, kept in every record; may be null.
    Json asked{};
    /// Before an item is made again what it has left goes, where that is still as it was made.
    bool removesFormer = false;
    /// From the report of a run that has passed: what stands in "<name>.json" beside its surface,
    /// or its folder. Counts as made by the run.
    std::function<Json(const BatchItem&, const Json&)> sidecar{};
    /// Told of every run when its record is kept.
    std::function<void(const BatchItem&, const BatchRecord&)> ended{};

    std::string versionText() const {
        return version.empty() ? adaptiso::versionText(name) : version;
    }
};

/// The option of a surface, or of the folder of several, in records.
inline constexpr const char* kOutputOption = "--output";

/// Runs the program once for every input, in processes of their own, `batch.jobs` at a time, and
/// tells of each in a line, in the order of the inputs: as text, or as JSON with --json. A run that
/// fails or crashes does not keep others from running. Every run leaves a record of each surface in
/// the item's folder (BatchRecord.h), by which --skip-existing knows what need not be made again,
/// and from which, and those of other batches and programs there, the summary page is built.
///
/// In the values of options {name} stands for the item's name.
/// \return kExitOk, or kExitCheckFailed when any input failed
/// \throws UsageError    options that don't go together, an output that all runs would write
/// \throws InvalidInput  no inputs, or two of one name
/// \throws FileError     list, summary or report can't be read or written
int runBatch(const BatchProgram& program, const BatchOptions& batch, const CommonOptions& common);

}  // namespace adaptiso
