#pragma once

#include <bit>
#include <cstdint>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// What a set of triangles is recognized by: their number, and a sum over their corners'
/// coordinates that any change of one changes but for one case in 2^64.
struct BrickPrint {
    std::uint64_t triangles = 0, sum = 0;

    void add(const Corners& corners) {
        ++triangles;
        std::uint64_t word = 0;
        for (const Vec3& p : corners) word = mixed(word + printOf(p));
        sum += word;
    }
    BrickPrint& operator+=(const BrickPrint& other) {
        triangles += other.triangles;
        sum += other.sum;
        return *this;
    }
    friend bool operator==(const BrickPrint&, const BrickPrint&) = default;

    static std::uint64_t printOf(const Vec3& p) {
        std::uint64_t word = 0;
        for (int a = 0; a < 3; ++a) word = mixed(word ^ std::bit_cast<std::uint64_t>(p[a]));
        return word;
    }

private:
    /// The last steps of SplitMix64: every bit of the result depends on all of the word's.
    static std::uint64_t mixed(std::uint64_t word) {
        word += 0x9E3779B97F4A7C15;
        word = (word ^ word >> 30) * 0xBF58476D1CE4E5B9;
        word = (word ^ word >> 27) * 0x94D049BB133111EB;
        return word ^ word >> 31;
    }
};

}  // namespace adaptiso::detail
