#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {

/// The half-edges of triangles by the vertex that they start from. Half-edge 3 t + c runs from
/// corner c of triangle t to the next corner.
template <class Index>
class HalfEdges {
public:
    static constexpr Index kNone = std::numeric_limits<Index>::max();

    /// Keeps a reference to the triangles.
    /// \param some  of them, ascending: of these alone; empty: of all
    void assign(std::size_t points, std::span<const std::array<Index, 3>> triangles,
                std::span<const Index> some = {}) {
        triangles_ = triangles;
        leaving_.assign(points, [&](const auto& give) {
            const std::size_t count = some.empty() ? triangles.size() : some.size();
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t t = some.empty() ? i : static_cast<std::size_t>(some[i]);
                for (std::size_t c = 0; c < 3; ++c) {
                    give(triangles[t][c], static_cast<Index>(3 * t + c));
                }
            }
        });
    }

    /// In ascending order.
    std::span<const Index> from(Index vertex) const { return leaving_.of(vertex); }
    /// The vertex that a half-edge runs to.
    Index to(Index halfEdge) const { return triangles_[halfEdge / 3][(halfEdge + 1) % 3]; }

    /// A triangle at a vertex: its half-edge that starts there, where that leads, and where its
    /// half-edge that arrives there comes from.
    struct Spoke {
        Index leaving, to, from;
    };

    /// Calls f(spokes) for each vertex, side by side where there are many: with its triangles in
    /// ascending order, which are read once.
    template <class F>
    void forEachFan(const F& f) const {
        constexpr std::size_t kMany = 1 << 15;  // below, threads cost more than they save
        const auto count = static_cast<std::int64_t>(leaving_.count());
        if (triangles_.size() < kMany) {
            forEachFanOf(0, count, f);
            return;
        }
        constexpr std::int64_t kPiece = 1 << 13;
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            forEachFanOf(begin, end, f);
        });
    }

    /// The opposite of each half-edge, or kNone. Where several run along an edge they are matched
    /// in ascending order.
    void match(std::vector<Index>& twin) const {
        assignInHugePages(twin, 3 * triangles_.size(), kNone);
        forEachFan([&](std::span<const Spoke> spokes) { matchFan(spokes, twin); });
    }

private:
    /// Opposite half-edges leave a vertex and arrive there in the same fan.
    static void matchFan(std::span<const Spoke> spokes, std::vector<Index>& twin) {
        constexpr std::size_t kFew = 32;  // below, a look at each is faster than sorting
        if (spokes.size() > kFew) return matchLargeFan(spokes, twin);
        for (std::size_t i = 0; i < spokes.size(); ++i) {
            twin[spokes[i].leaving] = oppositeOf(i, spokes);
        }
    }

    static void matchLargeFan(std::span<const Spoke> spokes, std::vector<Index>& twin) {
        std::vector<std::pair<Index, Index>> to, from;  // with the half-edge
        for (const Spoke& s : spokes) {
            to.emplace_back(s.to, s.leaving);
            from.emplace_back(s.from, s.leaving % 3 == 0 ? s.leaving + 2 : s.leaving - 1);
        }
        const auto inOrder = [](const auto& a, const auto& b) { return a.first < b.first; };
        std::stable_sort(to.begin(), to.end(), inOrder);
        std::stable_sort(from.begin(), from.end(), inOrder);
        std::size_t arriving = 0;
        for (const auto& [other, leaving] : to) {
            while (arriving < from.size() && from[arriving].first < other) ++arriving;
            const bool isThere = arriving < from.size() && from[arriving].first == other;
            twin[leaving] = isThere ? from[arriving++].second : kNone;
        }
    }

    template <class F>
    void forEachFanOf(std::int64_t begin, std::int64_t end, const F& f) const {
        std::vector<Spoke> spokes;
        for (std::int64_t v = begin; v < end; ++v) {
            spokes.clear();
            for (const Index h : from(static_cast<Index>(v))) {
                const auto& t = triangles_[h / 3];
                spokes.push_back({h, t[(h + 1) % 3], t[(h + 2) % 3]});
            }
            f(std::span<const Spoke>(spokes));
        }
    }

    /// The first of several that lead to a vertex is paired with the first that comes from it, and
    /// so on.
    static Index oppositeOf(std::size_t spoke, std::span<const Spoke> spokes) {
        const Index other = spokes[spoke].to;
        std::size_t before = 0;
        for (std::size_t i = 0; i < spoke; ++i) before += spokes[i].to == other ? 1 : 0;
        for (const Spoke& s : spokes) {
            if (s.from == other && before-- == 0)
                return s.leaving % 3 == 0 ? s.leaving + 2 : s.leaving - 1;
        }
        return kNone;
    }

    std::span<const std::array<Index, 3>> triangles_;
    Buckets<Index, Index> leaving_;  ///< half-edges, of each vertex
};

}  // namespace adaptiso::detail
