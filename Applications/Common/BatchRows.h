#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "Common/BatchItems.h"
#include "Common/BatchRecord.h"
#include "Common/BatchSummary.h"

namespace adaptiso {

/// Which records a page is built from.
struct RecordPlace {
    std::filesystem::path folder;  ///< empty: the current one
    /// Of BIDS derivatives: records lie under sub-* too.
    bool hasSubjects = false;
};

/// Records by the file that they are, or will be, kept in.
using Records = std::map<std::filesystem::path, KeptRecord>;

/// The line of a record kept in `file`; what it tells of is looked at.
SummaryRow summaryRow(const std::filesystem::path& file, const KeptRecord& record);

/// A line of the page for every record of every program in `place`, with `own`, which count more
/// than what is kept in their files, and for every one of `expected` that has no record while
/// others have: failures first, then what is gone, changed, not finished or not begun, then what is
/// done; by place and name. Outputs, and inputs that lie in `place`, are compared with what was
/// kept of them.
std::vector<SummaryRow> summaryRows(const RecordPlace& place, const Records& own,
                                    const std::vector<BatchItem>& expected);

/// Writes the page of summaryRows(). Two that write one page at a time both write it with the rows
/// of all records that are there by then. \throws FileError
void writeSummary(const std::filesystem::path& page, const RecordPlace& place, const Records& own,
                  const std::vector<BatchItem>& expected);

}  // namespace adaptiso
