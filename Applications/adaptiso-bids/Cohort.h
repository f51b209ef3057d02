#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Common/BatchSummary.h"
#include "Dataset.h"
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

/// Fills in what was asked for of the participant level, for most participants, by the records in
/// `options.output`; nothing where none is there. \pre options name no product
void takeAsked(BidsOptions& options);

/// What `options` ask for, as the records' askedOf() have it.
Json askedOf(const BidsOptions& options);

/// Looks at all that was asked for of `chosen`: versions, options, and the content of inputs and
/// outputs.
Cohort lookAtCohort(const BidsOptions& options, const ChosenSubjects& chosen);

/// The rows of what a finished record tells: a surface, three of a head model, regions.
/// \param scan  what they share
std::vector<QualityRow> rowsOfReport(const QualityRow& scan, const Json& report);

}  // namespace adaptiso
