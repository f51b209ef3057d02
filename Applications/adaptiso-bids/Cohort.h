#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Common/BatchSummary.h"
#include "Pipeline.h"
#include "QualityTable.h"

namespace adaptiso {

/// What was found of a dataset.
struct Cohort {
    std::vector<QualityRow> rows;      ///< by participant, scan and product, as asked for
    std::vector<SummaryRow> summary;   ///< the same, one for each record
    std::vector<std::size_t> shownBy;  ///< which of `summary` shows the n-th of `rows`
    std::size_t records = 0;           ///< that are there
};

/// Looks at all that was asked for of `subjects`: versions, options, and the content of inputs and
/// outputs.
Cohort lookAtCohort(const BidsOptions& options, const std::vector<std::filesystem::path>& subjects);

/// The rows of what a finished record tells: a surface, three of a head model, regions.
/// \param scan  what they share
std::vector<QualityRow> rowsOfReport(const QualityRow& scan, const Json& report);

}  // namespace adaptiso
