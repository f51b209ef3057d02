#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace adaptiso::detail {

/// Numbers things from 0 on in the order in which they come. Memory goes with how many there are,
/// not with how large their own numbers are.
class IdNumbers {
public:
    using Id = std::uint32_t;
    static constexpr Id kNone = ~Id{0};

    /// The number of a thing; a new one gets the next.
    Id numberOf(Id id) {
        if (2 * ids_.size() >= table_.size()) grow();
        Id& at = table_[placeOf(id)];
        if (at == kNone) {
            at = static_cast<Id>(ids_.size());
            ids_.push_back(id);
        }
        return at;
    }
    /// kNone for a thing that never came.
    Id find(Id id) const { return table_.empty() ? kNone : table_[placeOf(id)]; }
    /// What came, in order.
    const std::vector<Id>& ids() const { return ids_; }

private:
    std::size_t placeOf(Id id) const {
        const std::size_t mask = table_.size() - 1;
        std::size_t at = (id * std::uint64_t{0x9E3779B97F4A7C15} >> 32) & mask;
        while (table_[at] != kNone && ids_[table_[at]] != id) at = (at + 1) & mask;
        return at;
    }
    void grow() {
        table_.assign(table_.empty() ? 64 : 2 * table_.size(), kNone);
        for (std::size_t n = 0; n < ids_.size(); ++n) table_[placeOf(ids_[n])] = static_cast<Id>(n);
    }

    std::vector<Id> ids_;
    std::vector<Id> table_;  ///< a power of two of places
};

}  // namespace adaptiso::detail
