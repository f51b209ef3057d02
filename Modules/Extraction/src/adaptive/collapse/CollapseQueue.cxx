#include "adaptive/collapse/CollapseQueue.h"

#include <algorithm>

namespace adaptiso::detail {

CollapseQueue::Edge CollapseQueue::cheapest() {
    while (!heap_.empty()) {
        const Edge first = heap_.front();
        if (cost_[first.halfEdge] == first.cost) return first;
        std::pop_heap(heap_.begin(), heap_.end(), IsLater());
        heap_.pop_back();
    }
    return {kNever, kNone};
}

void CollapseQueue::refuse(std::uint32_t halfEdge) {
    setCost(halfEdge, kNever);
    for (const std::uint32_t v : {topology_.from(halfEdge), topology_.to(halfEdge)}) {
        findCheapest(v);
        push(v);
    }
}

void CollapseQueue::findCheapest(std::uint32_t vertex) {
    std::uint32_t best = kNone;
    forEachEdge(vertex, [&](std::uint32_t h, std::uint32_t) {
        if (cost_[h] < kNever && isCheaper(h, best)) best = h;
    });
    cheapest_[vertex] = best;
}

/// A vertex's cheapest edge, if it is that for its other end as well.
void CollapseQueue::push(std::uint32_t vertex) {
    const std::uint32_t h = cheapest_[vertex];
    if (h == kNone) return;
    const std::uint32_t from = topology_.from(h),
                        theirs = cheapest_[from == vertex ? topology_.to(h) : from];
    if (theirs == kNone || edgeOf(theirs) != edgeOf(h)) return;
    heap_.push_back({cost_[h], edgeOf(h)});
    std::push_heap(heap_.begin(), heap_.end(), IsLater());
}

}  // namespace adaptiso::detail
