#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/RunApp.h"

namespace adaptiso {

/// What a program that takes many inputs is asked to do with them.
struct BatchOptions {
    std::filesystem::path list;  ///< inputs, one a line; "-" for stdin, empty for none
    std::filesystem::path bids;  ///< a BIDS dataset, empty for none
    std::vector<std::string> participants;
    std::filesystem::path outputFolder;
    std::filesystem::path summary;
    std::optional<int> jobs;
    bool skipsExisting = false;

    /// An option of this struct is given.
    bool isAsked() const {
        return !list.empty() || !bids.empty() || !participants.empty() || !outputFolder.empty() ||
               !summary.empty() || jobs || skipsExisting;
    }
    /// The options of every run, as given ("--iso=100"), without those of this struct, --json,
    /// --quiet, --no-warnings and --threads. Set by keepRunOptions().
    std::vector<std::string> runOptions{};
};

/// Adds --list, --bids, --participant, --output-dir, --summary, --jobs and --skip-existing.
/// \param bidsFinds  what --bids looks for, for the help text
void declareBatchOptions(CLI::App& app, BatchOptions& options, const std::string& bidsFinds);

/// Fills `options.runOptions` from what was parsed. \pre parsing is done
void keepRunOptions(const CLI::App& app, BatchOptions& options);

}  // namespace adaptiso
