#include "BallTopology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <optional>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadModel/FractionField.h"

namespace adaptiso::headmodel {
namespace {

/// How far on either side of 0.5 a voxel is put whose side was changed: far enough for the
/// surface to keep clear of the voxel's centre, near enough to move it little.
constexpr float kNudge = 0.02f;

/// By which of the eight voxels around a lattice corner are inside (bit dx + 2 dy + 4 dz).
struct CornerCase {
    std::int8_t euler = 0;  ///< of the cells that begin at the corner: it, 3 edges, 3 squares, cube
    bool isCritical = false;
};

bool isDiagonal(unsigned around, unsigned a, unsigned b, unsigned c, unsigned d) {
    const auto in = [&](unsigned bit) { return (around >> bit & 1) != 0; };
    return in(a) == in(d) && in(b) == in(c) && in(a) != in(b);
}

CornerCase cornerCase(unsigned around) {
    CornerCase result;
    const auto any = [&](unsigned mask) { return (around & mask) != 0 ? 1 : 0; };
    constexpr unsigned kHighX = 0xaa, kHighY = 0xcc, kHighZ = 0xf0;
    result.euler = static_cast<std::int8_t>(any(0xff) - any(kHighX) - any(kHighY) - any(kHighZ) +
                                            any(kHighX & kHighY) + any(kHighY & kHighZ) +
                                            any(kHighX & kHighZ) - any(kHighX & kHighY & kHighZ));
    for (unsigned n = 0; n < 8; ++n) {
        const unsigned pair = 1u << n | 1u << (7 - n);
        if (around == pair || around == (0xffu ^ pair)) result.isCritical = true;
    }
    for (unsigned low : {0u, 4u})
        result.isCritical |= isDiagonal(around, low, low + 1, low + 2, low + 3);
    for (unsigned low : {0u, 2u})
        result.isCritical |= isDiagonal(around, low, low + 1, low + 4, low + 5);
    for (unsigned low : {0u, 1u})
        result.isCritical |= isDiagonal(around, low, low + 2, low + 4, low + 6);
    return result;
}

const std::array<CornerCase, 256>& cornerCases() {
    static const auto kTable = [] {
        std::array<CornerCase, 256> cases;
        for (unsigned around = 0; around < 256; ++around) cases[around] = cornerCase(around);
        return cases;
    }();
    return kTable;
}

/// The 27 voxels around one as bits: (dx + 1) + 3 (dy + 1) + 9 (dz + 1).
using Around = std::uint32_t;
constexpr int kMiddle = 13;

/// For each of the 27 which others touch it, by 26 or by 6 neighbours.
struct Adjacency {
    std::array<Around, 27> by26{}, by6{};
    Around faces = 0;       ///< the six beside the middle
    Around faceOrEdge = 0;  ///< the 18 of the middle

    Adjacency() {
        for (int a = 0; a < 27; ++a) {
            for (int b = 0; b < 27; ++b) {
                const int dx = std::abs(a % 3 - b % 3), dy = std::abs(a / 3 % 3 - b / 3 % 3);
                const int dz = std::abs(a / 9 - b / 9);
                if (a == b || std::max({dx, dy, dz}) > 1) continue;
                by26[a] |= 1u << b;
                if (dx + dy + dz == 1) by6[a] |= 1u << b;
                if (a != kMiddle) continue;
                if (dx + dy + dz == 1) faces |= 1u << b;
                if (dx + dy + dz <= 2) faceOrEdge |= 1u << b;
            }
        }
    }
};
const Adjacency kAdjacency;

Around reachable(Around start, Around set, const std::array<Around, 27>& adjacent) {
    Around reached = start, front = start;
    while (front != 0) {
        Around next = 0;
        for (Around left = front; left != 0; left &= left - 1) {
            next |= adjacent[std::countr_zero(left)];
        }
        front = next & set & ~reached;
        reached |= front;
    }
    return reached;
}

/// Adding or removing the middle keeps the topology (26 neighbours inside, 6 outside): the inside
/// around it is one piece, and so is the outside that it faces.
bool isSimple(Around inside) {
    const Around middle = 1u << kMiddle, all = (1u << 27) - 1;
    const Around in = inside & ~middle;
    if (in == 0) return false;
    if (reachable(in & (~in + 1), in, kAdjacency.by26) != in) return false;
    const Around out = ~inside & all & ~middle & kAdjacency.faceOrEdge;
    const Around facing = out & kAdjacency.faces;
    if (facing == 0) return false;
    return (facing & ~reachable(facing & (~facing + 1), out, kAdjacency.by6)) == 0;
}

/// With the middle inside, one of the eight cubes of eight voxels at it is critical.
bool makesCriticalPlace(Around inside) {
    inside |= 1u << kMiddle;
    for (int corner = 0; corner < 8; ++corner) {
        const int first = (corner & 1) + 3 * (corner >> 1 & 1) + 9 * (corner >> 2 & 1);
        unsigned around = 0;
        for (int n = 0; n < 8; ++n) {
            const int at = first + (n & 1) + 3 * (n >> 1 & 1) + 9 * (n >> 2 & 1);
            around |= (inside >> at & 1) << n;
        }
        if (cornerCases()[around].isCritical) return true;
    }
    return false;
}

/// Whether the middle may change, remembered: a solid has few kinds of places, met again and again.
class Changes {
public:
    bool keepTopology(Around inside) {
        Entry& entry = entries_[(inside * 2654435761u) >> (32 - kBits)];
        const Around around = inside & ~(1u << kMiddle);
        if (entry.around != around || !entry.isKnown) {
            // critical places look the same with inside and outside exchanged
            const bool isInside = (inside >> kMiddle & 1) != 0;
            const Around changed = isInside ? ~inside & ((1u << 27) - 1) : inside;
            entry = {around, true, isSimple(inside) && !makesCriticalPlace(changed)};
        }
        return entry.isAllowed;
    }

private:
    static constexpr int kBits = 14;
    struct Entry {
        Around around = 0;
        bool isKnown = false, isAllowed = false;
    };
    std::vector<Entry> entries_ = std::vector<Entry>(std::size_t{1} << kBits);
};

/// Voxels waiting for their turn: those with a higher priority first, to a 4096th of the range; of
/// those as high who came first.
class Turns {
public:
    explicit Turns(const std::vector<float>& priority) : priority_(priority) {
        const auto [least, most] = std::minmax_element(priority.begin(), priority.end());
        least_ = *least;
        perUnit_ = *most > *least ? (kLevels - 1) / (*most - *least) : 0;
    }
    void push(std::int64_t voxel) {
        const auto level = static_cast<int>((priority_[voxel] - least_) * perUnit_);
        waiting_[level].push_back(voxel);
        top_ = std::max(top_, level);
    }
    std::optional<std::int64_t> pop() {
        for (; top_ >= 0; --top_) {
            if (next_[top_] < waiting_[top_].size()) return waiting_[top_][next_[top_]++];
            freeMemory(waiting_[top_]);
            next_[top_] = 0;
        }
        return std::nullopt;
    }

private:
    static constexpr int kLevels = 4096;
    const std::vector<float>& priority_;
    float least_ = 0, perUnit_ = 0;
    int top_ = -1;
    std::vector<std::vector<std::int64_t>> waiting_ =
        std::vector<std::vector<std::int64_t>>(kLevels);
    std::vector<std::size_t> next_ = std::vector<std::size_t>(kLevels, 0);
};

/// A solid whose voxels change sides one after the other, in one direction, and keep its topology.
class Front {
public:
    /// \param may  the voxels that may change, all of them on the same side of `solid`
    /// \pre `solid` is empty at the grid's border, and so is `may`
    Front(Mask solid, const Mask& may, const Index3& size) : state_(std::move(solid)) {
        for (int n = 0; n < 27; ++n) {
            offsets_[n] = (n % 3 - 1) + size[0] * ((n / 3 % 3 - 1) + size[1] * (n / 9 - 1));
        }
        for (std::size_t n = 0; n < may.size(); ++n) {
            if (may[n] == 0) continue;
            state_[n] |= kMay;
            side_ = state_[n] & kIn;
        }
    }

    /// Changes what can be, from where the sides meet, and gives back the solid.
    Mask advance(const std::vector<float>& priority) {
        Turns turns(priority);
        Changes changes;
        for (std::int64_t voxel = 0; voxel < std::ssize(state_); ++voxel) {
            if (state_[voxel] != (kMay | side_)) continue;
            const Around inside = around(voxel);
            const Around other = side_ != 0 ? ~inside : inside;
            if ((other & kAdjacency.by26[kMiddle]) != 0) offer(voxel, turns);
        }
        while (const std::optional<std::int64_t> voxel = turns.pop()) {
            state_[*voxel] &= ~kWaits;
            if (!changes.keepTopology(around(*voxel))) continue;
            state_[*voxel] = side_ ^ kIn;
            for (const std::int64_t offset : offsets_) offer(*voxel + offset, turns);
        }
        for (std::uint8_t& voxel : state_) voxel &= kIn;
        return std::move(state_);
    }

private:
    static constexpr std::uint8_t kIn = 1, kMay = 2, kWaits = 4;

    /// Which of the 27 voxels are inside. \pre not at the grid's border
    Around around(std::int64_t voxel) const {
        Around inside = 0;
        for (int n = 0; n < 27; ++n) {
            inside |= static_cast<Around>(state_[voxel + offsets_[n]] & kIn) << n;
        }
        return inside;
    }

    void offer(std::int64_t voxel, Turns& turns) {
        if (state_[voxel] != (kMay | side_)) return;
        state_[voxel] |= kWaits;
        turns.push(voxel);
    }

    Mask state_;
    std::uint8_t side_ = 0;  ///< that changing voxels leave
    std::array<std::int64_t, 27> offsets_{};
};

/// In voxels. What is farther inside or outside is not looked at one by one.
constexpr std::array<double, 4> kBands{2, 4, 8, 16};

/// The smallest erosion that is a ball; at worst the deepest voxel.
Mask ballWithin(const Mask& whole, const std::vector<float>& depth, const ImageGeometry& unitGrid) {
    for (const double band : kBands) {
        Mask core = above(depth, band);
        if (isBall(core, unitGrid.size)) return core;
    }
    const std::vector<float> all = depthMm(whole, unitGrid, DepthBand::inside());
    Mask core(whole.size(), 0);
    core[std::max_element(all.begin(), all.end()) - all.begin()] = 1;
    return core;
}

/// The smallest dilation that is a ball; at worst the whole grid but for its border.
Mask ballContaining(const std::vector<float>& depth, const Index3& size) {
    Mask all(depth.size(), 0);
    for (std::int64_t k = 1; k + 1 < size[2]; ++k) {
        for (std::int64_t j = 1; j + 1 < size[1]; ++j) {
            const std::int64_t row = size[0] * (j + size[1] * k);
            std::fill_n(all.begin() + row + 1, std::max<std::int64_t>(size[0] - 2, 0), 1);
        }
    }
    for (const double band : kBands) {
        Mask hull = above(depth, -band);
        for (std::size_t n = 0; n < hull.size(); ++n) hull[n] &= all[n];
        if (isBall(hull, size)) return hull;
    }
    return all;
}

std::int64_t differences(const Mask& a, const Mask& b) {
    std::int64_t count = 0;
    for (std::size_t n = 0; n < a.size(); ++n) count += a[n] != b[n] ? 1 : 0;
    return count;
}

/// The first voxel of the eight around every pinched place.
std::vector<std::int64_t> pinchedPlaces(const Mask& mask, const Index3& size) {
    const std::int64_t row = size[0], slice = size[0] * size[1];
    std::vector<std::int64_t> places;
    for (std::int64_t k = 0; k + 1 < size[2]; ++k) {
        for (std::int64_t j = 0; j + 1 < size[1]; ++j) {
            const std::int64_t first = k * slice + j * row;
            for (std::int64_t n = first; n + 1 < first + row; ++n) {
                unsigned around = 0;
                for (unsigned c = 0; c < 8; ++c) {
                    const std::int64_t at = n + (c & 1) + row * (c >> 1 & 1) + slice * (c >> 2);
                    around |= unsigned{mask[at]} << c;
                }
                if (cornerCases()[around].isCritical) places.push_back(n);
            }
        }
    }
    return places;
}

/// A ball by filling the eight voxels around each pinched place, or by emptying them, whichever
/// changes less; empty if neither makes one. Quick, where most solids need no more.
Mask ballByPinches(const Mask& whole, const Index3& size) {
    constexpr std::size_t kMost = 100;
    const std::vector<std::int64_t> places = pinchedPlaces(whole, size);
    Mask best;
    if (places.size() > kMost) return best;
    for (const std::uint8_t side : {std::uint8_t{0}, std::uint8_t{1}}) {
        Mask tried = whole;
        for (const std::int64_t n : places) {
            for (int c = 0; c < 8; ++c) {
                tried[n + (c & 1) + size[0] * ((c >> 1 & 1) + size[1] * (c >> 2))] = side;
            }
        }
        if (!isBall(tried, size)) continue;
        if (best.empty() || differences(tried, whole) < differences(best, whole)) {
            best = std::move(tried);
        }
    }
    return best;
}

void takeSides(std::vector<float>& part, const Mask& mask) {
    constexpr auto kHalf = static_cast<float>(kFractionIsovalue);
    for (std::size_t n = 0; n < mask.size(); ++n) {
        if ((part[n] >= kHalf) == (mask[n] != 0)) continue;
        part[n] = mask[n] != 0 ? kHalf + kNudge : kHalf - kNudge;
    }
}

}  // namespace

MaskTopology maskTopology(const Mask& mask, const Index3& size) {
    MaskTopology topology;
    const auto& cases = cornerCases();
    const std::int64_t row = size[0], slice = size[0] * size[1];
    for (std::int64_t k = 0; k + 1 < size[2]; ++k) {
        for (std::int64_t j = 0; j + 1 < size[1]; ++j) {
            const std::uint8_t* const at = mask.data() + k * slice + j * row;
            const auto column = [&](std::int64_t i) {
                return static_cast<unsigned>(at[i] | at[i + row] << 2 | at[i + slice] << 4 |
                                             at[i + slice + row] << 6);
            };
            unsigned low = column(0);
            for (std::int64_t i = 0; i + 1 < size[0]; ++i) {
                const unsigned high = column(i + 1);
                const CornerCase& found = cases[low | high << 1];
                topology.eulerCharacteristic += found.euler;
                topology.criticalPlaces += found.isCritical ? 1 : 0;
                low = high;
            }
        }
    }
    return topology;
}

bool isBall(const Mask& mask, const Index3& size) {
    const MaskTopology topology = maskTopology(mask, size);
    if (topology.eulerCharacteristic != 1 || topology.criticalPlaces != 0) return false;
    return largestComponent(mask, size) == mask && filled(mask, size) == mask;
}

Mask grownBall(const Mask& allowed, const std::vector<float>& priority, Mask core,
               const Index3& size) {
    Mask may = allowed;
    for (std::size_t n = 0; n < may.size(); ++n) {
        if (core[n] != 0) may[n] = 0;
    }
    return Front(std::move(core), may, size).advance(priority);
}

Mask carvedBall(const Mask& kept, const std::vector<float>& priority, Mask hull,
                const Index3& size) {
    Mask may = hull;
    for (std::size_t n = 0; n < may.size(); ++n) {
        if (kept[n] != 0) may[n] = 0;
    }
    std::vector<float> lowFirst(priority.size());
    for (std::size_t n = 0; n < priority.size(); ++n) lowFirst[n] = -priority[n];
    return Front(std::move(hull), may, size).advance(lowFirst);
}

std::int64_t makeBall(std::vector<float>& part, const Index3& size) {
    const Mask inside = above(part, kFractionIsovalue);
    if (voxelsIn(inside) == 0) throw InvalidInput("the solid is empty");
    const Mask whole = filled(largestComponent(inside, size), size);
    takeSides(part, whole);
    const MaskTopology topology = maskTopology(whole, size);
    if (topology.eulerCharacteristic == 1 && topology.criticalPlaces == 0) return 0;

    if (topology.criticalPlaces > 0) {
        const Mask quick = ballByPinches(whole, size);
        if (!quick.empty()) {
            takeSides(part, quick);
            return differences(quick, whole);
        }
    }
    ImageGeometry unitGrid;
    unitGrid.size = size;
    const std::vector<float> depth = depthMm(whole, unitGrid, DepthBand::within(kBands.back() + 1));
    const Mask cut = grownBall(whole, part, ballWithin(whole, depth, unitGrid), size);
    const Mask wrapped = carvedBall(whole, part, ballContaining(depth, size), size);
    const std::int64_t cutVoxels = differences(cut, whole);
    const std::int64_t wrappedVoxels = differences(wrapped, whole);
    takeSides(part, cutVoxels < wrappedVoxels ? cut : wrapped);
    return std::min(cutVoxels, wrappedVoxels);
}

}  // namespace adaptiso::headmodel
