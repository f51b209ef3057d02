#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "Common/Batch.h"
#include "Common/BatchRecord.h"
#include "Common/Json.h"
#include "adaptiso/Report/Summary.h"  // IWYU pragma: export

namespace adaptiso {

/// The row of a record, by what it holds alone.
SummaryRow recordRow(const RunRecord& record);

/// The row of a record in `file`; its outputs, and its inputs in the batch's folder, are compared
/// with the record.
SummaryRow summaryRow(const std::filesystem::path& file, const RunRecord& record);

/// SummaryRow::reason of an error: without `files` at its start and without its remedy, and with N
/// for numbers.
std::string reasonOf(std::string error, const std::vector<std::string>& files = {});

/// The surfaces or regions that the record's report lists, or its one output; may be empty.
Json surfacesOf(const RunRecord& record);

/// The table of --csv: a line for each surface or region of the runs, and for a run without; the
/// run's columns, then the single figures of the report's.
std::string batchTable(const std::vector<RunRecord>& records);

/// A row for every record in `folder`, with `own`, which replace those in their files: the worst
/// first, then by path.
std::vector<SummaryRow> summaryRows(const std::filesystem::path& folder,
                                    const std::map<std::filesystem::path, RunRecord>& own);

/// Writes the page of `summary` with summaryRows(). Of several processes that write it at once the
/// last shows all records, where the file system has locks. \param ownFolder  as AtomicOutput takes
/// it \throws FileError
void writeSummary(const std::filesystem::path& page, const std::filesystem::path& folder,
                  const std::map<std::filesystem::path, RunRecord>& own,
                  const std::filesystem::path& ownFolder, Summary summary);

}  // namespace adaptiso
