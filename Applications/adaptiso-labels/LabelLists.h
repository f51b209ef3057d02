#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "LabelIds.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::labels {

/// Labels from `first` to `last`, or those of a name that is still to be looked up.
struct LabelRange {
    LabelId first, last;
    std::string name{};  ///< not looked up yet (resolveNames()); empty: numbers

    bool contains(const LabelId& id) const { return first <= id && id <= last; }
    friend bool operator==(const LabelRange&, const LabelRange&) = default;
};
using LabelRanges = std::vector<LabelRange>;

/// "1", "10-20", "Hippocampus_L"
std::string toText(const LabelRange& range);

/// "1,Hippocampus_L,10-20" \throws UsageError  naming `option`: no such list, or one with 0 in it
LabelRanges parseLabelRanges(const std::string& option, const std::string& text);

/// Labels that become one region, of the number that is the first of `labels`.
struct LabelMerge {
    std::string name;
    LabelRanges labels;

    LabelId number() const { return labels.front().first; }
    bool contains(const LabelId& id) const;
};

/// "Thalamus=10,49" \throws UsageError  as parseLabelRanges(), or without a name
LabelMerge parseLabelMerge(const std::string& text);

/// \throws UsageError  two of them hold a label, or have a name
void requireDisjoint(const std::vector<LabelMerge>& merges);

/// "1=0.33,2=0.0066": S/m by label \throws UsageError  no such list, a label twice, a value that is
/// not above 0
std::map<Label, double> parseConductivities(const std::string& text);

}  // namespace adaptiso::labels
