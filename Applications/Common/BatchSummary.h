#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "Common/Batch.h"
#include "Common/BatchRecord.h"

namespace adaptiso {

/// The state of a run, the worst first.
enum class RunState {
    Failed,
    Changed,      ///< done, but an output or an input is gone or has changed since
    NotFinished,  ///< started, or its record can't be read
    NotRun,       ///< only its input is there
    Unusual,      ///< done, and unlike the others' results
    Done,
};

/// One line of the page.
struct SummaryRow {
    std::string program{};  ///< may be empty
    std::string name{};
    std::string file{};
    RunState state = RunState::NotRun;
    std::string says{};  ///< the result, or the error
    std::string date{};  ///< of the run's end; may be empty
    double seconds = 0;
    std::vector<std::filesystem::path> outputs{};
    std::filesystem::path report{};    ///< a page of --report; may be empty
    std::filesystem::path pictures{};  ///< a folder of --pictures; may be empty
};

/// The line of a record in `file`; its outputs, and its inputs in the batch's folder, are compared
/// with the record.
SummaryRow summaryRow(const std::filesystem::path& file, const RunRecord& record);

/// The table of --csv: a line for each surface or region of the runs, and for a run without; the
/// run's columns, then the single figures of the report's.
std::string batchTable(const std::vector<RunRecord>& records);

/// A page of HTML without scripts that lists `rows` in their order, the verdict in words and
/// colour, with links relative to `page`, and a thumbnail where there are pictures.
std::string summaryPage(const std::vector<SummaryRow>& rows, const std::filesystem::path& page);

/// A line for every record in `folder`, with `own`, which replace those in their files: the worst
/// first, then by path.
std::vector<SummaryRow> summaryRows(const std::filesystem::path& folder,
                                    const std::map<std::filesystem::path, RunRecord>& own);

/// Writes the page of summaryRows(). Of several processes that write it at once the last shows all
/// records, where the file system has locks. \param ownFolder  as AtomicOutput takes it
/// \throws FileError
void writeSummary(const std::filesystem::path& page, const std::filesystem::path& folder,
                  const std::map<std::filesystem::path, RunRecord>& own,
                  const std::filesystem::path& ownFolder);

}  // namespace adaptiso
