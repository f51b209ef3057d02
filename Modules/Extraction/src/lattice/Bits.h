#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace adaptiso::detail {

/// A set of K small numbers, counted and ranked by words; as small as its K allows.
template <int K>
class Bits {
    using Word = std::conditional_t<
        (K <= 8), std::uint8_t,
        std::conditional_t<(K <= 16), std::uint16_t,
                           std::conditional_t<(K <= 32), std::uint32_t, std::uint64_t>>>;
    static constexpr int kWordBits = 8 * sizeof(Word);
    static constexpr int kWords = (K + kWordBits - 1) / kWordBits;

public:
    bool test(int i) const { return word_[i / kWordBits] >> (i % kWordBits) & 1u; }
    void set(int i) { word_[i / kWordBits] |= bit(i); }
    void reset(int i) { word_[i / kWordBits] &= static_cast<Word>(~bit(i)); }

    /// set(), when other threads may set other bits of the same word.
    void setShared(int i) {
        std::atomic_ref<Word>(word_[i / kWordBits]).fetch_or(bit(i), std::memory_order_relaxed);
    }

    int count() const {
        int total = 0;
        for (const Word w : word_) total += std::popcount(w);
        return total;
    }

    /// How many members are smaller than i.
    int rank(int i) const {
        int total = 0;
        for (int w = 0; w < i / kWordBits; ++w) total += std::popcount(word_[w]);
        const Word below = static_cast<Word>(bit(i) - 1);
        return total + std::popcount(static_cast<Word>(word_[i / kWordBits] & below));
    }

    /// Calls f(i) for every member, ascending.
    template <class F>
    void forEach(const F& f) const {
        for (int w = 0; w < kWords; ++w) {
            for (Word rest = word_[w]; rest != 0; rest = static_cast<Word>(rest & (rest - 1))) {
                f(w * kWordBits + std::countr_zero(rest));
            }
        }
    }

private:
    static constexpr Word bit(int i) { return static_cast<Word>(Word{1} << (i % kWordBits)); }

    alignas(Word) std::array<Word, kWords> word_{};
};

}  // namespace adaptiso::detail
