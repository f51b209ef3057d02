#include "Common/BatchOptions.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "Common/CommonFrame.h"
#include "Common/Naming.h"
#include "Common/OptionValues.h"
#include "Common/UsageWords.h"
#include "adaptiso/ImageIO/ImageNames.h"

namespace adaptiso {
namespace {

constexpr const char* kGroup = "Many inputs (each a run of its own, in a process of its own)";

/// Options that are not those of a single run of the batch.
constexpr std::array<std::string_view, 11> kOfTheBatch{
    "csv",  "list",          "log",   "output-dir", "summary",    "jobs",
    "json", "skip-existing", "quiet", "threads",    "no-warnings"};

}  // namespace

void declareBatchOptions(CLI::App& app, BatchOptions& options) {
    const OptionGroup running(app, kGroup);
    running.text("--list", "FILE", options.list,
                 "Take the inputs that FILE lists (- for stdin), one a line; a name to use for "
                 "it may follow after a tab. Skips lines that begin with #");
    running.text("--output-dir", "DIR", options.outputFolder,
                 "Write into this folder (made where need be) instead of the current one");
    running.count("--jobs", options.jobs, 1, 1024, "Work on N inputs at a time (default: 1)");
    running.flag("--skip-existing", options.skipsExisting,
                 "Skip inputs already processed with the same options and unchanged files; repeat "
                 "their results");
    running.text("--summary", "FILE", options.summary,
                 "Write a page (HTML) of all runs that have a record in the output folder, with "
                 "links to what they made (default with --output-dir: summary.html there)");
    running.text("--csv", "FILE", options.table,
                 "Write a table (CSV) of this batch: a line for each surface or region, with its "
                 "figures. Of a batch --json has one JSON object a line, one for each run");
}

bool holdsName(const std::filesystem::path& output) {
    return output.string().find("{name}") != std::string::npos;
}

void checkPlaceholders(const std::vector<std::pair<const char*, std::filesystem::path>>& named,
                       const BatchOptions& batch, const CommonOptions& common) {
    for (const auto& [option, output] : named) requirePlaceholders(option, output, {"{name}"});
    requirePlaceholders("--summary", batch.summary, {});
    requirePlaceholders("--csv", batch.table, {});
    requirePlaceholders("--output-dir", batch.outputFolder, {});
    requireFolderName("--output-dir", batch.outputFolder,
                      "give a folder; -o names the files in it");
    requirePlaceholders("--json", common.json, {});
}

void refuseOutputAsInput(const std::vector<std::filesystem::path>& inputs,
                         const std::filesystem::path& output, const BatchOptions& batch) {
    if (inputs.size() != 2 || !output.empty() || batch.isRequested()) return;
    const std::filesystem::path& last = inputs.back();
    std::error_code error;
    const bool isImage = inputStem(last) != last.filename().string();
    if (isImage || last.empty() || std::filesystem::exists(last, error)) return;
    throw UsageError(last.string() + ": there is no such input; an output is given as -o " +
                     shellQuoted(last.string()));
}

void takeFolder(std::filesystem::path& output, BatchOptions& options) {
    if (!isFolder(output)) return;
    if (!options.outputFolder.empty()) {
        throw UsageError("--output " + output.string() +
                         ": is a folder, and --output-dir names one; give one of them");
    }
    options.outputFolder = std::exchange(output, {});
    std::erase_if(options.runOptions,
                  [](const std::string& option) { return option.starts_with("--output="); });
}

void keepRunOptions(const CLI::App& app, BatchOptions& options) {
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() == 0 || option->get_lnames().empty()) continue;
        const std::string& name = option->get_lnames().front();
        if (std::find(kOfTheBatch.begin(), kOfTheBatch.end(), name) != kOfTheBatch.end()) continue;
        if (option->get_items_expected_max() == 0) {
            options.runOptions.push_back("--" + name);
            continue;
        }
        for (const std::string& value : option->results()) {
            options.runOptions.push_back("--" + name + "=" + value);
        }
    }
}

}  // namespace adaptiso
