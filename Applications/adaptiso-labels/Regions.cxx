#include "Regions.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <map>

#include "Common/Json.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::labels {
namespace {

namespace fs = std::filesystem;

/// The table that names are from: that of --names, or what lies beside the input.
LabelTable readNames(LabelsRun& run) {
    const LabelsOptions& options = run.options;
    LabelTable table;
    if (!options.masks.empty()) {
        table.format = "file names";
        for (const MaskSource& mask : options.masks) {
            table.entries.push_back({mask.label, mask.name, "", mask.color});
        }
        if (!options.names.empty()) run.names.files = {baseName(options.names)};
    } else if (!options.names.empty()) {
        table = readLabelTable(options.names);
        run.names.files = {baseName(options.names)};
        addWarnings(run.warnings, table.warnings, baseName(options.names));
    } else {
        FoundLabelTables found =
            findLabelTables(options.input, options.read.volumeIndex.value_or(0));
        table = std::move(found.table);
        for (const fs::path& file : found.files) run.names.files.push_back(baseName(file));
        addWarnings(run.warnings, table.warnings, baseName(options.input));
    }
    run.names.format = table.format;
    return table;
}

/// "did you mean ...", or what else to do where nothing is near.
std::string namesNear(const std::string& name, const LabelTable& table) {
    constexpr std::size_t kMost = 5;
    std::vector<std::string> all, holding;
    for (const LabelEntry& entry : table.entries) {
        if (entry.value == 0 || entry.name.empty()) continue;
        all.push_back(entry.name);
        if (lowerCase(entry.name).find(lowerCase(name)) != std::string::npos) {
            holding.push_back(entry.name);
        }
    }
    if (holding.size() > kMost) holding.resize(kMost);
    if (!holding.empty()) return "; did you mean " + alternatives(holding) + "?";
    const std::string near = suggestion(name, all);
    return near.empty() ? "; regions.tsv of a run without --labels lists the names" : near;
}

/// True for a name that a pattern with * and ? describes, and that is not empty.
bool matches(const std::string& name, const std::string& pattern) {
    return !name.empty() && fnmatch(lowerCase(pattern).c_str(), name.c_str(), FNM_NOESCAPE) == 0;
}

/// Puts the labels that a table names so in place of names.
void resolve(const std::string& option, const LabelTable& table, const std::string& source,
             LabelRanges& ranges) {
    LabelRanges resolved;
    for (const LabelRange& range : ranges) {
        if (range.name.empty()) {
            resolved.push_back(range);
            continue;
        }
        const std::size_t before = resolved.size();
        const auto take = [&](const auto& isMeant) {
            for (const LabelEntry& entry : table.entries) {
                if (entry.value == 0 || !isMeant(entry.name)) continue;
                resolved.push_back({entry.value, entry.value});
            }
        };
        take([&](const std::string& name) { return name == range.name; });
        if (resolved.size() > before) continue;
        take([&](const std::string& name) { return lowerCase(name) == lowerCase(range.name); });
        if (resolved.size() > before) continue;
        take([&](const std::string& name) { return matches(lowerCase(name), range.name); });
        if (resolved.size() > before) continue;
        throw InvalidInput(option + " " + shown(range.name) + ": " +
                           (table.format.empty()
                                ? source + " has no table of names; give one (--names), or numbers"
                                : source + " names no label so" + namesNear(range.name, table)));
    }
    ranges = std::move(resolved);
}

std::string listed(const std::vector<Label>& labels, const LabelIds& ids) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t n = 0; n < std::min(labels.size(), kMost); ++n) {
        addPart(text, ids.text(labels[n]));
    }
    return text + (labels.size() > kMost ? ", ..." : "");
}

void warnOfNameless(LabelsRun& run) {
    if (run.names.format.empty()) return;
    std::vector<Label> nameless;
    for (const Region& region : run.regions) {
        if (!region.hasOwnName) nameless.push_back(region.label);
    }
    // a table of colours alone names nothing, and need not
    if (nameless.empty() || run.names.format == "MRIcron colours") return;
    run.warnings.push_back({"label-nameless",
                            "names " +
                                (nameless.size() == run.regions.size()
                                     ? "none of the regions"
                                     : "all but " + formatCount(std::ssize(nameless)) + " of the " +
                                           formatCount(std::ssize(run.regions)) + " regions, not") +
                                " " + listed(nameless, run.ids),
                            run.names.files.empty() ? "" : run.names.files.front()});
}

/// A name that every file system takes: others than letters, digits, '.', '-' and '_' of ASCII are
/// '_'.
std::string fileName(const std::string& name) {
    constexpr std::size_t kLongest = 100;
    std::string safe;
    for (const char c : name.substr(0, kLongest)) {
        const bool isPlain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                             (c >= 'A' && c <= 'Z') || c == '-' || c == '_' || c == '.';
        safe += isPlain ? c : '_';
    }
    while (!safe.empty() && (safe.front() == '.' || safe.front() == '-')) safe.erase(0, 1);
    while (safe.ends_with('.')) safe.pop_back();
    constexpr std::array<std::string_view, 4> kDevices{"con", "prn", "aux", "nul"};
    const std::string stem = lowerCase(safe.substr(0, safe.find('.')));
    const bool isDevice =
        std::ranges::count(kDevices, stem) > 0 ||
        (stem.size() == 4 && (stem.starts_with("com") || stem.starts_with("lpt")));
    return isDevice ? "_" + safe : safe;
}

/// Files by the names of their regions; the label follows names that are alike but for case, and
/// stands alone where there is no name.
void nameFiles(LabelsRun& run) {
    std::map<std::string, int> uses;
    for (const Region& region : run.regions) ++uses[lowerCase(fileName(region.name))];
    for (Region& region : run.regions) {
        std::string name = region.hasOwnName ? fileName(region.name) : "";
        const std::string label = run.ids.text(region.label);
        if (name.empty()) {
            name = label;
        } else if (uses[lowerCase(name)] > 1) {
            name += "-" + label;
        }
        region.file = "regions/" + name + run.options.format;
    }
    std::map<std::string, Label> taken;
    for (const Region& region : run.regions) {
        const auto [other, isNew] = taken.emplace(lowerCase(region.file), region.label);
        if (isNew) continue;
        throw InvalidInput("--file-names name: labels " + run.ids.text(other->second) + " and " +
                           run.ids.text(region.label) + " would both be " + region.file +
                           "; rename one in the table, or leave the option out");
    }
}

const LabelEntry* entryOf(const LabelTable& table, const LabelId& id) {
    const auto value = static_cast<std::int64_t>(id.bits);
    return LabelId(value) == id ? table.find(value) : nullptr;
}

}  // namespace

void resolveNames(LabelsOptions& options) {
    const auto isNamed = [](const LabelRanges& ranges) {
        return std::ranges::any_of(ranges, [](const auto& range) { return !range.name.empty(); });
    };
    const bool isNeeded = isNamed(options.labels) ||
                          std::ranges::any_of(options.merges, isNamed, &LabelMerge::labels);
    if (!isNeeded) return;
    LabelsRun unnamed{options, {}};  // the run itself warns of the table
    const LabelTable table = readNames(unnamed);
    const std::string source =
        unnamed.names.files.empty() ? baseName(options.input) : unnamed.names.files.front();
    for (LabelMerge& merge : options.merges) {
        resolve("--merge " + shown(merge.name), table, source, merge.labels);
    }
    for (LabelRange& range : options.labels) {  // a new region by its name
        const auto merge = std::ranges::find_if(options.merges, [&](const LabelMerge& each) {
            return lowerCase(each.name) == lowerCase(range.name);
        });
        if (!range.name.empty() && merge != options.merges.end()) range = merge->labels.front();
    }
    resolve("--labels", table, source, options.labels);
    requireDisjoint(options.merges);
}

const Region* LabelsRun::find(Label label) const {
    const auto at = std::ranges::lower_bound(regions, label, {}, &Region::label);
    return at != regions.end() && at->label == label ? &*at : nullptr;
}

std::string LabelsRun::nameOf(Label label) const {
    if (label == 0) return "outside";
    std::string name;
    if (const Region* const region = find(label)) {
        if (region->hasOwnName) name = region->name;
    } else if (const auto other = otherNames.find(label); other != otherNames.end()) {
        name = other->second;
    }
    return name.empty() ? ids.text(label) : name + " (" + ids.text(label) + ")";
}

std::vector<Label> chooseLabels(const LabelCensus& census, const LabelsRun& run) {
    const LabelsOptions& options = run.options;
    std::vector<Label> chosen;
    if (options.labels.empty()) {
        for (const auto& [label, voxels] : census.voxels) chosen.push_back(label);
        return chosen;
    }
    for (const LabelRange& range : options.labels) {
        // a label that is merged stands for its region
        const bool isOne = range.first == range.last;
        const LabelId first = isOne ? mergedId(range.first, options.merges) : range.first;
        const LabelRange meant{first, isOne ? first : range.last};
        const std::size_t before = chosen.size();
        for (const auto& [label, voxels] : census.voxels) {
            if (meant.contains(run.ids.of(label))) chosen.push_back(label);
        }
        if (chosen.size() == before) {
            throw InvalidInput("--labels " + toText(range) + ": " + baseName(options.input) +
                               " has no such label");
        }
    }
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
}

void nameRegions(const std::vector<Label>& labels, const LabelCensus& census, LabelsRun& run) {
    const LabelTable table = readNames(run);
    std::vector<std::optional<LabelColor>> given;
    std::map<LabelId, std::string> mergedNames;
    for (const LabelMerge& merge : run.options.merges) mergedNames[merge.number()] = merge.name;
    for (const auto& [label, voxels] : census.voxels) {
        const LabelId id = run.ids.of(label);
        const LabelEntry* const entry = entryOf(table, id);
        const auto merged = mergedNames.find(id);
        const std::string name = merged != mergedNames.end() ? merged->second
                                 : entry != nullptr          ? entry->name
                                                             : "";
        if (!std::binary_search(labels.begin(), labels.end(), label)) {
            if (!name.empty()) run.otherNames[label] = name;
            continue;
        }
        Region& region = run.regions.emplace_back();
        region.label = label;
        region.name = name;
        region.voxels = voxels;
        std::optional<LabelColor>& color = given.emplace_back();
        if (entry != nullptr) {
            if (merged == mergedNames.end()) region.abbreviation = entry->abbreviation;
            color = entry->color;
        }
        region.hasOwnName = !region.name.empty();
        if (!region.hasOwnName) region.name = "region " + idText(id);
        region.file =
            run.isScene ? baseName(run.folder) : "regions/" + idText(id) + run.options.format;
    }
    const std::vector<LabelColor> colors = labelColors(labels, given);
    for (std::size_t n = 0; n < colors.size(); ++n) run.regions[n].color = colors[n];
    if (run.options.namesFiles) nameFiles(run);
    warnOfNameless(run);
}

std::vector<Label> labelsOf(const std::vector<Region>& regions) {
    std::vector<Label> labels;
    for (const Region& region : regions) labels.push_back(region.label);
    return labels;
}

}  // namespace adaptiso::labels
