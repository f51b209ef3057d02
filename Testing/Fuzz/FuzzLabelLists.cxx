// libFuzzer target: what a user writes after --labels, --conductivities and, a line each, --merge.
// The first byte chooses. The text is refused with a UsageError of one line, or gives what the
// option's header promises; a list written again says the same.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "Common/RunApp.h"
#include "OneLine.h"
#include "adaptiso-labels/LabelLists.h"

namespace adaptiso::labels {
namespace {

void requireSound(const LabelRanges& ranges) {
    if (ranges.empty()) std::abort();
    std::string text;
    for (const LabelRange& range : ranges) {
        if (range.name.empty() && (range.first > range.last || range.contains(0))) std::abort();
        text += (text.empty() ? "" : ",") + toText(range);
    }
    if (parseLabelRanges("--labels", text) != ranges) std::abort();
}

void tryMerges(std::string_view text) {
    std::vector<LabelMerge> merges;
    constexpr std::size_t kMost = 64;
    for (std::size_t at = 0; at <= text.size() && merges.size() < kMost;) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        merges.push_back(parseLabelMerge(std::string(text.substr(at, end - at))));
        const LabelMerge& merge = merges.back();
        requireSound(merge.labels);
        const bool isNamed = !merge.labels.front().name.empty();
        if (merge.name.empty() || (!isNamed && !merge.contains(merge.number()))) std::abort();
        at = end + 1;
    }
    requireDisjoint(merges);
    for (const LabelMerge& merge : merges) {
        for (const LabelMerge& other : merges) {
            const bool isNamed = !merge.labels.front().name.empty();
            if (&other != &merge && !isNamed && other.contains(merge.number())) std::abort();
        }
    }
}

void tryText(std::uint8_t option, std::string_view text) {
    if (option % 3 == 0) {
        requireSound(parseLabelRanges("--labels", std::string(text)));
    } else if (option % 3 == 1) {
        tryMerges(text);
    } else {
        for (const auto& [label, value] : parseConductivities(std::string(text))) {
            if (label == 0 || !std::isfinite(value) || value <= 0) std::abort();
        }
    }
}

}  // namespace
}  // namespace adaptiso::labels

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    try {
        adaptiso::labels::tryText(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
    } catch (const adaptiso::UsageError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
