#include "Common/BatchPlan.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <thread>
#include <utility>

#include "Common/AtomicOutput.h"
#include "Common/Bids.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kName = "{name}";

std::string replaced(std::string text, std::string_view place, std::string_view by) {
    for (std::size_t at = text.find(place); at != std::string::npos;
         at = text.find(place, at + by.size())) {
        text.replace(at, place.size(), by);
    }
    return text;
}

std::string withName(std::string text, const std::string& name) {
    return replaced(std::move(text), kName, name);
}

/// "--output" and its value, of "--output=value".
std::pair<std::string, std::string> split(const std::string& option) {
    const std::size_t equals = option.find('=');
    if (equals == std::string::npos) return {option, ""};
    return {option.substr(0, equals), option.substr(equals + 1)};
}

/// Where the item's run puts a file of that name; an absolute one stays.
std::string placed(const BatchItem& item, const std::string& pattern) {
    return (item.folder / withName(pattern, item.name)).string();
}

}  // namespace

BatchPlan::BatchPlan(const BatchProgram& program, const BatchOptions& batch,
                     const CommonOptions& common)
    : program_(program), batch_(batch), common_(common), base_(batch.outputFolder) {
    if (base_.empty() && !batch_.bids.empty()) base_ = batch_.bids / "derivatives" / "adaptiso";
    checkOptions();
    findItems();
    requireOwnNames(items_);
    requireOwnRecords();
    prepareOutputs();
}

bool BatchPlan::isOutput(const std::string& option) const {
    const std::vector<std::string>& names = program_.outputOptions;
    return std::find(names.begin(), names.end(), option) != names.end();
}

bool BatchPlan::isInput(const std::string& option) const {
    const std::vector<std::string>& names = program_.inputOptions;
    return std::find(names.begin(), names.end(), option) != names.end();
}

/// Two names may give one, in an --output like {name}{iso}.stl.
void BatchPlan::requireOwnRecords() const {
    std::map<fs::path, const BatchItem*> known;
    for (const BatchItem& item : items_) {
        for (const PlannedRecord& record : records(item)) {
            const auto [place, isNew] = known.emplace(record.file, &item);
            if (isNew) continue;
            throw InvalidInput(item.inputs.front().string() + " and " +
                               place->second->inputs.front().string() + ": both would write " +
                               record.surface.filename().string());
        }
    }
}

void BatchPlan::checkOptions() const {
    const bool isBids = !batch_.bids.empty();
    const auto require = [](bool isGood, const std::string& message) {
        if (!isGood) throw UsageError(message);
    };
    require(!isBids || (program_.inputs.empty() && batch_.list.empty()),
            "--bids: finds its inputs itself; none may be given besides");
    require(isBids || batch_.participants.empty(), "--participant: needs --bids");
    require(!isBids || !program_.isOneItem,
            "--nested: not with --bids; name the surfaces of each head in a --list");
    require(!batch_.skipsExisting || keepsRecords(),
            "--skip-existing: needs --output-dir, where records are kept");
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (!isOutput(name)) continue;
        require(value.find(kName) != std::string::npos,
                name + " " + value +
                    ": needs {name} in it, or the runs for all inputs would write the same");
        require(!isBids || !fs::path(value).has_parent_path(),
                name + " " + value + ": with --bids a name without folders");
    }
}

void BatchPlan::findItems() {
    if (!batch_.bids.empty()) {
        items_ = program_.findInBids(batch_.bids, batch_.participants, base_);
        return;
    }
    if (program_.isOneItem && !program_.inputs.empty()) {
        items_.push_back({folderName(program_.inputs.front()), program_.inputs, {}});
    } else {
        for (const fs::path& input : program_.inputs) {
            items_.push_back({program_.nameOf(input), {input}, {}});
        }
    }
    if (!batch_.list.empty()) {
        for (BatchItem& item : readBatchList(batch_.list, program_.isOneItem, program_.nameOf)) {
            items_.push_back(std::move(item));
        }
    }
    for (BatchItem& item : items_) item.folder = base_;
}

void BatchPlan::prepareOutputs() {
    if (program_.isPartOfApp) {
        makeFolders(base_);
        return;
    }
    if (!batch_.bids.empty()) {
        makeDerivatives(batch_.bids, base_, program_.name);
    } else if (!base_.empty()) {
        makeFolders(base_);
    }
    summary_ = batch_.summary;
    if (summary_.empty() && !base_.empty()) summary_ = base_ / "summary.html";
    for (const fs::path& file : {summary_, fs::path(common_.json)}) {
        if (file.empty() || file == "-") continue;
        checkOutput(file);
        for (const BatchItem& item : items_) {
            for (const fs::path& input : item.inputs) checkNotInput(file, input);
        }
    }
}

/// The value of --output, or what stands for it where it is not given; empty: the program has none.
std::string BatchPlan::outputPattern(const BatchItem& item) const {
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (name != "--output") continue;
        return batch_.bids.empty() ? value : replaced(value, "{iso}", kIsoLabel);
    }
    if (program_.defaultOutputOf) return program_.defaultOutputOf(item);
    return batch_.bids.empty() ? program_.defaultOutput : program_.defaultBidsOutput;
}

std::vector<std::string> BatchPlan::outputs(const BatchItem& item,
                                            const std::vector<std::string>& names) const {
    const fs::path folder = fs::path(withName(outputPattern(item), item.name)).parent_path();
    std::vector<std::string> files;
    for (const std::string& name : names) {
        files.push_back((folder / withName(name, item.name)).string());
    }
    return files;
}

std::vector<std::string> BatchPlan::options(const BatchItem& item) const {
    std::vector<std::string> options;
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (name == "--output") continue;
        options.push_back(isOutput(name) ? name + "=" + placed(item, value)
                                         : withName(option, item.name));
    }
    const std::string output = outputPattern(item);
    if (!output.empty()) options.push_back("--output=" + placed(item, output));
    return options;
}

std::vector<PlannedRecord> BatchPlan::records(const BatchItem& item) const {
    std::vector<KeptOption> shared;
    std::vector<std::string> values;
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (isOutput(name) || isInput(name)) continue;  // their files are looked at
        if (name == program_.surfaceOption) {
            values.push_back(value);
        } else {
            shared.push_back({name, sha256Of(withName(value, item.name))});
        }
    }
    if (!program_.surfaceFiles || values.empty()) {
        return {{recordFile(item.folder, item.folder / item.name, program_.name), {}, shared}};
    }
    std::vector<PlannedRecord> planned;
    const std::vector<fs::path> files =
        program_.surfaceFiles(placed(item, outputPattern(item)), values);
    for (std::size_t n = 0; n < files.size(); ++n) {
        PlannedRecord& record = planned.emplace_back();
        record.file = recordFile(item.folder, files[n], program_.name);
        record.surface = files[n];
        record.options = shared;
        record.options.push_back({program_.surfaceOption, sha256Of(values[n])});
    }
    return planned;
}

std::vector<fs::path> BatchPlan::inputs(const BatchItem& item) const {
    std::vector<fs::path> inputs = item.inputs;
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (isInput(name)) inputs.emplace_back(withName(value, item.name));
    }
    return inputs;
}

std::vector<std::pair<std::string, fs::path>> BatchPlan::extras(const BatchItem& item) const {
    std::vector<std::pair<std::string, fs::path>> extras;
    for (const std::string& option : batch_.runOptions) {
        const auto [name, value] = split(option);
        if (isOutput(name) && name != "--output") extras.emplace_back(name, placed(item, value));
    }
    return extras;
}

std::vector<std::string> BatchPlan::arguments(const BatchItem& item) const {
    std::vector<std::string> arguments = options(item);
    if (common_.threads) {
        arguments.push_back("--threads=" + std::to_string(*common_.threads));
    } else if (batch_.jobs.value_or(1) > 1) {
        const int machine = static_cast<int>(std::thread::hardware_concurrency());
        arguments.push_back("--threads=" + std::to_string(std::max(1, machine / *batch_.jobs)));
    }
    arguments.insert(arguments.end(), {"--quiet", "--no-warnings", "--json=-"});
    if (program_.inputOption.empty()) arguments.emplace_back("--");
    for (const fs::path& input : item.inputs) {
        arguments.push_back(program_.inputOption.empty()
                                ? input.string()
                                : program_.inputOption + "=" + input.string());
    }
    return arguments;
}

}  // namespace adaptiso
