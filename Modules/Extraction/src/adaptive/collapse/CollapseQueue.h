#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::detail {

/// The edges of a patch, cheapest collapse first; of equal ones that with the smaller number.
///
/// Each vertex knows the cheapest of its edges. The cheapest edge of all is that for both its ends,
/// so only edges that are go to the heap: about a ninth of them.
class CollapseQueue {
public:
    static constexpr std::uint32_t kNone = PatchTopology::kNone;
    static constexpr double kNever = std::numeric_limits<double>::infinity();

    CollapseQueue(const PatchTopology& topology, const Patch& patch)
        : topology_(topology),
          cost_(3 * std::size_t{patch.ownTriangles}, kNever),
          cheapest_(patch.points.size(), kNone) {}

    /// Puts all edges in.
    /// \param costOf  costOf(half-edge): what collapsing its edge costs, or kNever. An edge is
    ///                known by the half-edge with the smaller number.
    template <class CostOf>
    void fill(const Patch& patch, const CostOf& costOf);

    struct Edge {
        double cost;
        std::uint32_t halfEdge;  ///< kNone: no edge is left
    };
    /// The cheapest edge. It stays in until it is refused or collapsed.
    Edge cheapest();
    /// Takes an edge out, until a collapse changes it.
    void refuse(std::uint32_t halfEdge);
    /// An edge was collapsed: all edges at the vertex that is left get their costs anew.
    /// \param star  of the edge, before
    template <class CostOf>
    void update(std::uint32_t vertex, const Star& star, const CostOf& costOf);

    /// Calls f(half-edge) for all that are in.
    template <class F>
    void forEachLeft(const F& f) const {
        for (std::uint32_t h = 0; h < cost_.size(); ++h) {
            if (cost_[h] < kNever && edgeOf(h) == h) f(h);
        }
    }

private:
    struct IsLater {
        bool operator()(const Edge& x, const Edge& y) const {
            return x.cost != y.cost ? x.cost > y.cost : x.halfEdge > y.halfEdge;
        }
    };

    /// kNone is larger than all numbers: an edge on a border has one half-edge.
    std::uint32_t edgeOf(std::uint32_t h) const { return std::min(h, topology_.twin(h)); }
    /// \param than  half-edge, or kNone
    bool isCheaper(std::uint32_t h, std::uint32_t than) const {
        if (than == kNone || cost_[h] != cost_[than])
            return than == kNone || cost_[h] < cost_[than];
        return edgeOf(h) < edgeOf(than);
    }
    void setCost(std::uint32_t h, double cost) {
        cost_[h] = cost;
        if (topology_.twin(h) != kNone) cost_[topology_.twin(h)] = cost;
    }
    /// Calls f(half-edge, vertex at its other end) for each edge at a vertex.
    template <class F>
    void forEachEdge(std::uint32_t vertex, const F& f) const {
        topology_.forEachLeaving(vertex, [&](std::uint32_t h) {
            f(h, topology_.to(h));
            const std::uint32_t arriving = PatchTopology::previous(h);
            if (topology_.twin(arriving) == kNone) f(arriving, topology_.from(arriving));
        });
    }
    void findCheapest(std::uint32_t vertex);
    void push(std::uint32_t vertex);

    const PatchTopology& topology_;
    std::vector<double> cost_;             ///< of each half-edge: its edge's
    std::vector<std::uint32_t> cheapest_;  ///< half-edge of each vertex's cheapest edge, or kNone
    std::vector<Edge> heap_;               ///< some have changed since: their cost is another
};

template <class CostOf>
void CollapseQueue::fill(const Patch& patch, const CostOf& costOf) {
    for (std::uint32_t h = 0; h < cost_.size(); ++h) {
        if (patch.triangles[h / 3][0] == Patch::kGone || edgeOf(h) != h) continue;
        const double cost = costOf(h);
        if (cost == kNever) continue;
        setCost(h, cost);
        for (const std::uint32_t v : {topology_.from(h), topology_.to(h)}) {
            if (isCheaper(h, cheapest_[v])) cheapest_[v] = h;
        }
    }
    for (std::uint32_t v = 0; v < cheapest_.size(); ++v) {
        const std::uint32_t h = cheapest_[v];
        if (h != kNone && topology_.from(h) == v) push(v);
    }
}

template <class CostOf>
void CollapseQueue::update(std::uint32_t vertex, const Star& star, const CostOf& costOf) {
    for (int i = 0; i < star.removedCount; ++i) {
        for (int c = 0; c < 3; ++c) cost_[3 * star.removed[i] + c] = kNever;
    }
    cheapest_[vertex] = kNone;
    forEachEdge(vertex, [&](std::uint32_t h, std::uint32_t) {
        const double cost = costOf(edgeOf(h));
        setCost(h, cost);
        if (cost < kNever && isCheaper(h, cheapest_[vertex])) cheapest_[vertex] = h;
    });
    push(vertex);
    forEachEdge(vertex, [&](std::uint32_t h, std::uint32_t other) {
        if (!topology_.isMovable(other)) return;
        const std::uint32_t before = cheapest_[other];
        const bool isAsBefore =
            before == kNone || (cost_[before] < kNever && topology_.from(before) != vertex &&
                                topology_.to(before) != vertex);
        if (isAsBefore && !(cost_[h] < kNever && isCheaper(h, before))) return;
        if (isAsBefore) {
            cheapest_[other] = h;
        } else {
            findCheapest(other);
        }
        push(other);
    });
}

}  // namespace adaptiso::detail
