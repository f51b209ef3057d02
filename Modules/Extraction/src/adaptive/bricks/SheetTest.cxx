#include "adaptive/bricks/SheetTest.h"

#include <array>

namespace adaptiso::detail {
namespace {

constexpr int kSide = 4;
constexpr int kDirections = 13;  ///< one of each pair of opposite directions

struct Direction {
    std::array<int, 3> step{};
    int shift = 0;             ///< in bits of the window
    std::uint64_t starts = 0;  ///< samples whose neighbour along the direction is in the window
};

struct Tables {
    std::array<Direction, kDirections> direction{};
    /// Bits of the directions near one: d along it, d + kDirections against it.
    std::array<std::uint32_t, std::size_t{2} * kDirections> cone{};
};

constexpr bool isWithin(const std::array<int, 3>& a, const std::array<int, 3>& b) {
    constexpr double kSquaredCosine = 0.413;  // of 50 degrees
    const int product = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const int lengths =
        (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    return product > 0 && product * product >= kSquaredCosine * lengths;
}

constexpr Tables makeTables() {
    Tables tables;
    int count = 0;
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const int shift = x + kSide * (y + kSide * z);
                if (shift <= 0) continue;
                Direction& d = tables.direction[count++];
                d.step = {x, y, z};
                d.shift = shift;
                for (int i = 0; i < kSide * kSide * kSide; ++i) {
                    const int px = i % kSide + x, py = i / kSide % kSide + y,
                              pz = i / (kSide * kSide) + z;
                    const bool isInWindow =
                        px >= 0 && px < kSide && py >= 0 && py < kSide && pz >= 0 && pz < kSide;
                    if (isInWindow) d.starts |= std::uint64_t{1} << i;
                }
            }
        }
    }
    for (int d = 0; d < 2 * kDirections; ++d) {
        const auto& step = tables.direction[d % kDirections].step;
        for (int e = 0; e < 2 * kDirections; ++e) {
            const auto& other = tables.direction[e % kDirections].step;
            const bool isSameSide = (d < kDirections) == (e < kDirections);
            const std::array<int, 3> turned{isSameSide ? other[0] : -other[0],
                                            isSameSide ? other[1] : -other[1],
                                            isSameSide ? other[2] : -other[2]};
            if (isWithin(step, turned)) tables.cone[d] |= std::uint32_t{1} << e;
        }
    }
    return tables;
}

constexpr Tables kTables = makeTables();

}  // namespace

bool isSingleSheet(std::uint64_t inside) {
    std::uint32_t leaves = 0;   // bit d: along d the lines only leave the inside
    std::uint32_t changes = 0;  // bit d: some line along d changes
    for (int d = 0; d < kDirections; ++d) {
        const Direction& direction = kTables.direction[d];
        const std::uint64_t next = inside >> direction.shift;
        const bool enters = (~inside & next & direction.starts) != 0;
        const bool exits = (inside & ~next & direction.starts) != 0;
        leaves |= static_cast<std::uint32_t>(!enters) << d | static_cast<std::uint32_t>(!exits)
                                                                 << (d + kDirections);
        if (enters || exits) changes |= 1u << d | 1u << (d + kDirections);
    }
    for (int d = 0; d < 2 * kDirections; ++d) {
        const std::uint32_t cone = kTables.cone[d];
        if ((changes >> d & 1u) != 0 && (leaves & cone) == cone) return true;
    }
    return false;
}

}  // namespace adaptiso::detail
