#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::labels {

/// A label as a file has it: any whole number of 64 bits, with or without a sign.
struct LabelId {
    bool isNotNegative = true;
    std::uint64_t bits = 0;  ///< of a negative one as two's complement

    LabelId() = default;
    LabelId(std::int64_t number)  // NOLINT: a Label is a LabelId
        : isNotNegative(number >= 0), bits(static_cast<std::uint64_t>(number)) {}
    static LabelId ofUnsigned(std::uint64_t number);

    friend auto operator<=>(const LabelId&, const LabelId&) = default;
};

/// "700000000000000123"
std::string idText(const LabelId& id);

/// Parses a 64-bit id at the beginning of `text` and removes it. \return false if there is none
bool takeId(std::string_view& text, LabelId& id);

/// The ids of a map's labels: these themselves where 32 bits hold them, else regions are numbered
/// from 1 in the order of their ids.
class LabelIds {
public:
    LabelIds() = default;
    /// Looks for labels that Label does not hold. \param more  ids to number as well
    /// \throws InvalidInput  there are more than Label counts
    LabelIds(const VolumeView& map, const std::vector<LabelId>& more);

    bool areNumbered() const { return !ids_.empty(); }
    LabelId of(Label label) const;
    /// \return empty for one that is neither in the map nor was named beside it
    std::optional<Label> find(const LabelId& id) const;
    std::string text(Label label) const { return idText(of(label)); }

    /// The map with the numbers. \pre areNumbered()
    Volume numbered(const VolumeView& map) const;
    /// A numbered map with the ids, of 64 bits; else the map itself.
    Volume withIds(Volume map) const;

private:
    std::vector<LabelId> ids_;  ///< ascending, without 0
};

}  // namespace adaptiso::labels
