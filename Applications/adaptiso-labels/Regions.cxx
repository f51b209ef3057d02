#include "Regions.h"

#include <algorithm>
#include <map>

#include "Common/Json.h"
#include "Common/Numbers.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// The table that names are from: that of --names, or what lies beside the input.
LabelTable readNames(LabelsRun& run) {
    const LabelsOptions& options = run.options;
    LabelTable table;
    if (!options.names.empty()) {
        table = readLabelTable(options.names);
        run.names.files = {baseName(options.names)};
        addWarnings(run.warnings, table.warnings, baseName(options.names));
    } else {
        FoundLabelTables found = findLabelTables(options.input);
        table = std::move(found.table);
        for (const fs::path& file : found.files) run.names.files.push_back(baseName(file));
        addWarnings(run.warnings, table.warnings, baseName(options.input));
    }
    run.names.format = table.format;
    return table;
}

std::string listed(const std::vector<Label>& labels) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t n = 0; n < std::min(labels.size(), kMost); ++n) {
        text += (n == 0 ? "" : ", ") + std::to_string(labels[n]);
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
                                " " + listed(nameless),
                            run.names.files.empty() ? "" : run.names.files.front()});
}

}  // namespace

const Region* LabelsRun::find(Label label) const {
    const auto at = std::ranges::lower_bound(regions, label, {}, &Region::label);
    return at != regions.end() && at->label == label ? &*at : nullptr;
}

std::string LabelsRun::nameOf(Label label) const {
    if (label == 0) return "outside";
    const Region* const region = find(label);
    if (region == nullptr || !region->hasOwnName) return std::to_string(label);
    return region->name + " (" + std::to_string(label) + ")";
}

std::vector<Label> chooseLabels(const LabelCensus& census, const LabelsOptions& options) {
    std::vector<Label> chosen;
    if (options.labels.empty()) {
        for (const auto& [label, voxels] : census.voxels) chosen.push_back(label);
        return chosen;
    }
    for (const LabelRange& range : options.labels) {
        // a label that is merged stands for its region
        const bool isOne = range.first == range.last;
        const Label first = isOne ? mergedNumber(range.first, options.merges) : range.first;
        const Label last = isOne ? first : range.last;
        const std::size_t before = chosen.size();
        for (auto at = census.voxels.lower_bound(first);
             at != census.voxels.end() && at->first <= last; ++at) {
            chosen.push_back(at->first);
        }
        if (chosen.size() == before) {
            throw InvalidInput("--labels " + toText(range) + ": " + baseName(options.input) +
                               " has no such label");
        }
    }
    std::ranges::sort(chosen);
    const auto repeated = std::ranges::unique(chosen);
    chosen.erase(repeated.begin(), repeated.end());
    return chosen;
}

void nameRegions(const std::vector<Label>& labels, const LabelCensus& census, LabelsRun& run) {
    const LabelTable table = readNames(run);
    std::map<Label, std::string> mergedNames;
    for (const LabelMerge& merge : run.options.merges) mergedNames[merge.number()] = merge.name;
    for (const Label label : labels) {
        Region& region = run.regions.emplace_back();
        region.label = label;
        region.voxels = census.voxels.at(label);
        region.color = labelColor(label);
        if (const LabelEntry* const entry = table.find(label)) {
            region.name = entry->name;
            region.abbreviation = entry->abbreviation;
            region.color = entry->color.value_or(region.color);
        }
        if (const auto merged = mergedNames.find(label); merged != mergedNames.end()) {
            region.name = merged->second;
            region.abbreviation.clear();
        }
        region.hasOwnName = !region.name.empty();
        if (!region.hasOwnName) region.name = "region " + std::to_string(label);
        region.file = "regions/" + std::to_string(label) + run.options.format;
    }
    warnOfNameless(run);
}

RegionSurfaces::RegionSurfaces(const LabelComplex& complex, const std::vector<Region>& regions)
    : complex_(complex) {
    for (const Region& region : regions) labels_.push_back(region.label);
    const auto placeOf = [&](Label label) {
        const auto at = std::ranges::lower_bound(labels_, label);
        return at != labels_.end() && *at == label ? at - labels_.begin() : std::ptrdiff_t{-1};
    };
    begins_.assign(labels_.size() + 1, 0);
    const auto forEachSide = [&](const auto& take) {
        for (std::int64_t t = 0; t < std::ssize(complex.triangles); ++t) {
            for (const Label label : complex.labels[t]) {
                if (const std::ptrdiff_t place = placeOf(label); place >= 0) take(place, t);
            }
        }
    };
    forEachSide([&](std::ptrdiff_t place, std::int64_t) { ++begins_[place + 1]; });
    for (std::size_t n = 0; n < labels_.size(); ++n) begins_[n + 1] += begins_[n];
    triangles_.resize(static_cast<std::size_t>(begins_.back()));
    std::vector<std::int64_t> next(begins_.begin(), begins_.end() - 1);
    forEachSide([&](std::ptrdiff_t place, std::int64_t t) { triangles_[next[place]++] = t; });
}

TriangleMesh RegionSurfaces::surface(std::size_t n) const {
    const std::span<const std::int64_t> own(triangles_.begin() + begins_[n],
                                            triangles_.begin() + begins_[n + 1]);
    std::vector<VertexId> used;
    used.reserve(3 * own.size());
    for (const std::int64_t t : own) {
        used.insert(used.end(), complex_.triangles[t].begin(), complex_.triangles[t].end());
    }
    std::ranges::sort(used);
    const auto repeated = std::ranges::unique(used);
    used.erase(repeated.begin(), repeated.end());
    TriangleMesh mesh;
    mesh.points.reserve(used.size());
    for (const VertexId v : used) mesh.points.push_back(complex_.points[v]);
    mesh.triangles.reserve(own.size());
    for (const std::int64_t t : own) {
        Triangle corners = complex_.triangles[t];
        for (VertexId& v : corners) v = std::ranges::lower_bound(used, v) - used.begin();
        // a wall's normal points out of its first label's region
        if (complex_.labels[t][0] != labels_[n]) std::swap(corners[1], corners[2]);
        mesh.triangles.push_back(corners);
    }
    return mesh;
}

}  // namespace adaptiso
