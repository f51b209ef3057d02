#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/RunApp.h"

namespace adaptiso {

/// Options of a program that takes many inputs.
struct BatchOptions {
    std::filesystem::path list;  ///< inputs, one a line; "-" for stdin, empty for none
    std::filesystem::path outputFolder;
    std::filesystem::path summary, table;
    std::optional<int> jobs;
    bool skipsExisting = false;

    /// An option of this struct is given.
    bool isRequested() const {
        return !list.empty() || !outputFolder.empty() || !summary.empty() || !table.empty() ||
               jobs || skipsExisting;
    }
    /// The options of every run, as given ("--iso=100"), without those of this struct, --json,
    /// --quiet, --no-warnings and --threads. Set by keepRunOptions().
    std::vector<std::string> runOptions{};
};

/// Adds --list, --output-dir, --summary, --csv, --jobs and --skip-existing.
void declareBatchOptions(CLI::App& app, BatchOptions& options);

/// An output's name holds "{name}", which stands for an input's.
bool holdsName(const std::filesystem::path& output);

/// Checks the placeholders in the names of outputs, given with their options.
/// \param named  may hold "{name}"; those of the batch and of --json hold none
/// \throws UsageError
void checkPlaceholders(const std::vector<std::pair<const char*, std::filesystem::path>>& named,
                       const BatchOptions& batch, const CommonOptions& common);

/// Refuses the second of two inputs where there is no such file and its name is that of no image:
/// an output without -o. \throws UsageError
void refuseOutputAsInput(const std::vector<std::filesystem::path>& inputs,
                         const std::filesystem::path& output, const BatchOptions& batch);

/// An --output that names a folder is what --output-dir is. \pre keepRunOptions()
/// \throws UsageError  both are given
void takeFolder(std::filesystem::path& output, BatchOptions& options);

/// Fills `options.runOptions` from what was parsed. \pre parsing is done
void keepRunOptions(const CLI::App& app, BatchOptions& options);

}  // namespace adaptiso
