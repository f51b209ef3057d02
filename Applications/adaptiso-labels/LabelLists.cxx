#include "LabelLists.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::labels {
namespace {

/// Parses a label at the beginning of `text` and removes it.
bool takeLabel(std::string_view& text, Label& label) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), label);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

bool takeRange(std::string_view text, LabelRange& range) {
    if (!takeId(text, range.first)) return false;
    range.last = range.first;
    if (!text.starts_with('-')) return text.empty();
    text.remove_prefix(1);
    return takeId(text, range.last) && text.empty() && range.first <= range.last;
}

/// True for a short text that is no list of numbers.
bool takeName(std::string_view text, LabelRange& range) {
    const auto isControl = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (text.find_first_not_of("0123456789+-. ") == std::string_view::npos ||
        std::ranges::any_of(text, isControl)) {
        return false;
    }
    range = {{}, {}, std::string(trimmed(text))};
    return true;
}

bool contain(const LabelRanges& ranges, const LabelId& id) {
    return std::ranges::any_of(ranges, [&](const auto& range) { return range.contains(id); });
}

bool overlap(const LabelRange& a, const LabelRange& b) {
    if (!a.name.empty() || !b.name.empty()) return false;  // not known yet
    return a.first <= b.last && b.first <= a.last;
}

}  // namespace

std::string toText(const LabelRange& range) {
    if (!range.name.empty()) return range.name;
    const std::string first = idText(range.first);
    return range.first == range.last ? first : first + "-" + idText(range.last);
}

LabelRanges parseLabelRanges(const std::string& option, const std::string& text) {
    LabelRanges ranges;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        LabelRange range;
        const std::string_view item = std::string_view(text).substr(at, end - at);
        if (!takeRange(item, range) && !takeName(item, range)) {
            throw UsageError(option + " " + shown(text) +
                             ": must be labels, names and ranges of labels with commas between, "
                             "like 1,Hippocampus_L,10-20");
        }
        if (range.name.empty() && range.contains(0)) {
            throw UsageError(option + " " + shown(text) +
                             ": holds 0, which is what lies outside of all regions");
        }
        ranges.push_back(range);
        at = end + 1;
    }
    return ranges;
}

bool LabelMerge::contains(const LabelId& id) const {
    return contain(labels, id);
}

LabelMerge parseLabelMerge(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
        throw UsageError("--merge " + shown(text) +
                         ": must be a name and labels, like Thalamus=10,49");
    }
    LabelMerge merge{text.substr(0, equals), {}};
    const auto isControl = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (std::ranges::any_of(merge.name, isControl)) {
        throw UsageError("--merge " + shown(text) + ": the name holds control characters");
    }
    merge.labels = parseLabelRanges("--merge " + shown(merge.name), text.substr(equals + 1));
    return merge;
}

void requireDisjoint(const std::vector<LabelMerge>& merges) {
    for (std::size_t n = 0; n < merges.size(); ++n) {
        for (std::size_t m = 0; m < n; ++m) {
            const std::string both =
                "--merge: " + shown(merges[m].name) + " and " + shown(merges[n].name);
            if (merges[m].name == merges[n].name) {
                throw UsageError("--merge " + shown(merges[n].name) + ": given twice");
            }
            for (const LabelRange& a : merges[m].labels) {
                for (const LabelRange& b : merges[n].labels) {
                    if (!overlap(a, b)) continue;
                    throw UsageError(both + " both take label " +
                                     idText(std::max(a.first, b.first)));
                }
            }
        }
    }
}

std::map<Label, double> parseConductivities(const std::string& text) {
    std::map<Label, double> values;
    const auto refuse = [&](const std::string& why) {
        throw UsageError("--conductivities " + shown(text) + ": " + why);
    };
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        std::string_view item = std::string_view(text).substr(at, end - at);
        Label label = 0;
        double value = 0;
        const bool hasLabel = takeLabel(item, label) && label != 0 && item.starts_with('=');
        if (hasLabel) item.remove_prefix(1);
        const auto [last, error] = std::from_chars(item.data(), item.data() + item.size(), value);
        if (!hasLabel || error != std::errc() || last != item.data() + item.size() ||
            !(std::isfinite(value) && value > 0)) {
            refuse("must be labels and S/m above 0 with commas between, like 1=0.33,2=0.0066");
        }
        if (!values.try_emplace(label, value).second) {
            refuse("has label " + std::to_string(label) + " twice");
        }
        at = end + 1;
    }
    return values;
}

}  // namespace adaptiso::labels
