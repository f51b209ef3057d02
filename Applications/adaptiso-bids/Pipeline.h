#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"

namespace adaptiso {

/// The two halves of a BIDS App.
enum class BidsLevel { Participant, Group };

/// What adaptiso-bids is asked to do.
struct BidsOptions {
    std::filesystem::path dataset;  ///< BIDS_DIR
    std::filesystem::path output;   ///< OUT_DIR
    BidsLevel level{};
    std::vector<std::string> participants, sessions;  ///< labels; empty: all
    bool skipsValidation = false;

    std::string surfaces;  ///< options of adaptiso-mesh, "iso=100,largest"; empty: none are made
    bool makesBem = false, makesLabels = false, makesChecks = false;
    std::string bemOptions, labelsOptions, checkOptions;  ///< of the programs, "vertices=642,meg"
    std::filesystem::path segmentations;                  ///< a dataset; empty: `dataset`
    bool makesPictures = true;

    /// Says what to make.
    bool namesProducts() const { return !surfaces.empty() || makesBem || makesLabels; }

    double outlierLimit = 3.5;  ///< robust standard deviations
    double outlierPercent = 1;  ///< of the median, at least
    bool force = false;         ///< replaces a table made with other options
    std::optional<int> jobs;
    CommonOptions common;
};

/// Makes what is asked for of every participant, or a table and a page of what was made.
/// \return  kExitOk; kExitCheckFailed: some of it failed or is missing; kExitBadInput: a run was
///          killed, so that another try may do
/// \throws UsageError, InvalidInput, FileError
int runBids(const BidsOptions& options);

}  // namespace adaptiso
