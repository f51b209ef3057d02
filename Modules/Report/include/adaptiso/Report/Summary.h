#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Outliers.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// The state of a run, the worst first.
enum class RunState {
    Failed,
    CheckFailed,  ///< finished, with a failed check
    Changed,      ///< done, but an output or an input is gone or has changed since
    NotFinished,  ///< started, or its record can't be read
    NotRun,       ///< only its input is there
    Unusual,      ///< done, and unlike the others' results
    Warned,       ///< done, with warnings
    Done,
};

/// One run of many.
struct SummaryRow {
    std::string program{};  ///< may be empty
    std::string name{};
    std::string file{};
    RunState state = RunState::NotRun;
    std::string says{};    ///< the result, or the error
    std::string reason{};  ///< of what is not done: alike in runs of a kind
    std::string date{};    ///< of the run's end, ISO 8601; may be empty
    double seconds = 0;
    std::vector<std::filesystem::path> outputs{};
    std::filesystem::path report{};    ///< a page of --report; may be empty
    std::filesystem::path pictures{};  ///< a folder of --pictures; may be empty
    std::vector<Warning> warnings{};   ///< without notes
    /// Name (may be empty) and volume of each of its surfaces.
    std::vector<std::pair<std::string, double>> volumesMm3{};
};

/// What must be looked at first comes first: by state, then by the number of warnings.
void sortByNeed(std::vector<SummaryRow>& rows);

/// "1 failed: closed: a.stl": how many runs of which reason or warning, and which, most first.
struct SummaryReason {
    std::string reason;
    std::vector<std::string> names;  ///< of the runs
    bool isWarning = false;
};

/// The reasons of the rows that are not done, then the warnings; a row counts once for its reason
/// and once for each warning.
std::vector<SummaryReason> reasonsOf(const std::vector<SummaryRow>& rows);

/// Many runs, for one page.
struct Summary {
    std::vector<SummaryRow> rows{};    ///< in the page's order
    std::string title{};               ///< "Group of 12 participants"; empty: by the rows
    std::string program{};             ///< that makes the page, with its version
    std::string command{};             ///< that makes the page again; may be empty
    std::vector<std::string> notes{};  ///< warnings that are of no row
    OutlierRule outliers{};            ///< of the charts
};

/// "2 of 12 failed, 1 missing or changed"; "All 12 done".
std::string verdictOf(const std::vector<SummaryRow>& rows);

/// The summary as an HTML page in the style of the reports' pages: the verdict, reasons by number,
/// charts of volumes and times where at least kFewestCompared runs have them, and a table with
/// links and thumbnails relative to `page`. Its script sorts and filters the table. The same
/// summary and files give the same bytes.
std::string summaryPage(const Summary& summary, const std::filesystem::path& page);

}  // namespace adaptiso
