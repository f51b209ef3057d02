#include "Masks.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "Common/ImageOptions.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Pipeline.h"
#include "Run.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::labels {
namespace {

/// Places of the masks that a list names.
std::vector<std::size_t> listedPlaces(const std::filesystem::path& list,
                                      const std::vector<MaskSource>& masks) {
    const std::optional<std::string> text = readSmallFile(list);
    if (!text) throw FileError("--priority " + list.string() + ": there is no such file");
    if (const std::string fault = faultOfText(*text); !fault.empty()) {
        throw FileError("--priority " + list.string() + ": " + fault);
    }
    std::vector<std::size_t> places;
    std::vector<std::string> names;
    for (const MaskSource& mask : masks) names.push_back(mask.name);
    TextLines lines(*text);
    while (const auto line = lines.next()) {
        const std::string name(trimmed(*line));
        if (name.empty() || name.starts_with('#')) continue;
        const auto at = std::ranges::find(names, name);
        const std::size_t place = at - names.begin();
        const std::string where =
            "--priority " + list.string() + ": " + linePlace(lines.number()) + shown(name);
        if (at == names.end()) throw InvalidInput(where + " is no mask" + suggestion(name, names));
        if (std::ranges::count(places, place) > 0)
            throw InvalidInput(where + " stands there twice");
        places.push_back(place);
    }
    return places;
}

}  // namespace

PriorityOption PriorityOption::parse(const std::string& text) {
    if (text == "largest") return {{MaskPriority::Rule::Largest}};
    if (text == "smallest") return {{MaskPriority::Rule::Smallest}};
    return {{MaskPriority::Rule::Listed}, text};
}

void findMasks(LabelsOptions& options, LabelsRun& run) {
    std::vector<MaskSource>& masks = options.masks;
    if (options.joinsSegments) {
        masks = masksOfSegments(options.input, options.read);
    } else if (options.joinsMasks) {
        masks = masksOfFiles(options.inputs, options.read);
    } else {
        masks = masksOfFolder(options.input, options.read);
        if (masks.empty() && options.priority.isGiven()) {
            throw UsageError("--priority: is for masks, and " + baseName(options.input) +
                             " is one image");
        }
    }
    if (!masks.empty() && !options.names.empty()) {
        const LabelTable table = readLabelTable(options.names);
        addWarnings(run.warnings, table.warnings, baseName(options.names));
        addWarnings(run.warnings, numberByTable(masks, table, baseName(options.names)), "");
    }
    if (!masks.empty() && !options.priority.list.empty()) {
        options.priority.priority.listed = listedPlaces(options.priority.list, masks);
    }
}

MaskMap joinMasks(LabelsRun& run) {
    const LabelsOptions& options = run.options;
    const auto read = [&](const MaskSource& mask) {
        ReadVolume image = readImage(mask.file, mask.read);
        run.progress.show("read");
        return image;
    };
    MaskMap map = adaptiso::joinMasks(options.masks, options.priority.priority, read,
                                      options.joinsMasks ? "" : baseName(options.input));
    run.joined = std::move(map.joined);
    run.warnings.insert(run.warnings.end(), map.warnings.begin(), map.warnings.end());
    return map;
}

}  // namespace adaptiso::labels
