#include "adaptiso/Extraction/detail/PlanarTriangulation.h"

#include <algorithm>
#include <numeric>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {

// Places are ordered by v, then u: as if the sweep line were turned by a hair, so no edge is
// horizontal to it. "Before" is below.

bool PlanarTriangulator::isBefore(Index a, Index b) const {
    const PlanarCorner &p = (*corners_)[a], &q = (*corners_)[b];
    return p.v != q.v ? p.v < q.v : p.u < q.u;
}

std::int64_t PlanarTriangulator::cross(Index a, Index b, Index c) const {
    const PlanarCorner &p = (*corners_)[a], &q = (*corners_)[b], &r = (*corners_)[c];
    return (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
}

PlanarTriangulator::Kind PlanarTriangulator::kindOf(Index i) const {
    const PlanarCorner& corner = (*corners_)[i];
    const bool previousAbove = isBefore(i, corner.previous), nextAbove = isBefore(i, corner.next);
    if (previousAbove != nextAbove) return Kind::Regular;
    const bool leftTurn = cross(corner.previous, i, corner.next) > 0;
    if (nextAbove) return leftTurn ? Kind::Start : Kind::Split;
    return leftTurn ? Kind::End : Kind::Merge;
}

void PlanarTriangulator::triangulate(const std::vector<PlanarCorner>& corners,
                                     std::vector<LocalTriangle>& out) {
    corners_ = &corners;
    diagonals_.clear();
    status_.clear();
    sweep();
    walkParts(out);
}

void PlanarTriangulator::sweep() {
    const Index n = static_cast<Index>(corners_->size());
    kind_.resize(n);
    order_.resize(n);
    for (Index i = 0; i < n; ++i) kind_[i] = kindOf(i);
    std::iota(order_.begin(), order_.end(), Index{0});
    // in one place, corners that end edges come before those that only begin some
    std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
        if (isBefore(a, b)) return true;
        if (isBefore(b, a)) return false;
        return kind_[a] != kind_[b] ? kind_[a] < kind_[b] : a < b;
    });
    for (const Index i : order_) handle(i);
}

void PlanarTriangulator::handle(Index i) {
    const Index above = (*corners_)[i].previous;
    switch (kind_[i]) {
        case Kind::Start: {
            const std::size_t at = edgesLeftOf(i, above);
            status_.insert(status_.begin() + static_cast<std::ptrdiff_t>(at), {above, i});
            break;
        }
        case Kind::Split: {
            Index& helper = helperLeftOf(i);
            diagonals_.push_back({i, helper});
            helper = i;
            const std::size_t at = edgesLeftOf(i, above);
            status_.insert(status_.begin() + static_cast<std::ptrdiff_t>(at), {above, i});
            break;
        }
        case Kind::End:
        case Kind::Merge: {
            const std::size_t at = findEdge(i);
            connectToMerge(i, status_[at].helper);
            status_.erase(status_.begin() + static_cast<std::ptrdiff_t>(at));
            if (kind_[i] == Kind::Merge) {
                Index& helper = helperLeftOf(i);
                connectToMerge(i, helper);
                helper = i;
            }
            break;
        }
        case Kind::Regular:
            if (isBefore(i, above)) {  // the inside lies to the right
                const std::size_t at = findEdge(i);
                connectToMerge(i, status_[at].helper);
                status_[at] = {above, i};
            } else {
                Index& helper = helperLeftOf(i);
                connectToMerge(i, helper);
                helper = i;
            }
            break;
    }
}

/// Is the edge that runs down from `upper` left of `point`? Where it passes through the point, is
/// it left of the edge from there up to `above`?
bool PlanarTriangulator::edgeIsLeftOf(Index upper, Index point, Index above) const {
    const Index lower = (*corners_)[upper].next;
    const std::int64_t side = cross(lower, upper, point);
    if (side != 0 || above == point) return side < 0;
    const PlanarCorner &a = (*corners_)[lower], &b = (*corners_)[upper];
    const PlanarCorner &p = (*corners_)[point], &q = (*corners_)[above];
    return (b.u - a.u) * (q.v - p.v) - (b.v - a.v) * (q.u - p.u) < 0;
}

std::size_t PlanarTriangulator::edgesLeftOf(Index point, Index above) const {
    const auto end = std::partition_point(
        status_.begin(), status_.end(),
        [&](const SweepEdge& edge) { return edgeIsLeftOf(edge.upper, point, above); });
    return static_cast<std::size_t>(end - status_.begin());
}

/// Position of the edge that runs down from corner `upper`, which the sweep line has reached.
std::size_t PlanarTriangulator::findEdge(Index upper) {
    for (std::size_t at = edgesLeftOf(upper, upper); at < status_.size(); ++at) {
        if (status_[at].upper == upper) return at;
    }
    throw InternalError("PlanarTriangulator: the loops do not bound a region (edge not found)");
}

PlanarTriangulator::Index& PlanarTriangulator::helperLeftOf(Index i) {
    const std::size_t left = edgesLeftOf(i, i);
    if (left == 0) {
        throw InternalError("PlanarTriangulator: the loops do not bound a region (nothing left)");
    }
    return status_[left - 1].helper;
}

void PlanarTriangulator::connectToMerge(Index i, Index helper) {
    if (kind_[helper] == Kind::Merge) diagonals_.push_back({i, helper});
}

/// Walks the parts that the diagonals cut the region into and triangulates each.
void PlanarTriangulator::walkParts(std::vector<LocalTriangle>& out) {
    const Index n = static_cast<Index>(corners_->size());
    // outgoing diagonals of each corner, counter-clockwise from the edge to its next corner
    const std::size_t count = diagonals_.size();
    for (std::size_t d = 0; d < count; ++d) {
        diagonals_.push_back({diagonals_[d][1], diagonals_[d][0]});
    }
    const auto isInFirstHalf = [&](Index corner, Index target) {
        const Index next = (*corners_)[corner].next;
        const std::int64_t side = cross(corner, next, target);
        if (side != 0) return side > 0;
        const PlanarCorner &p = (*corners_)[corner], &q = (*corners_)[next],
                           &r = (*corners_)[target];
        return (q.u - p.u) * (r.u - p.u) + (q.v - p.v) * (r.v - p.v) > 0;
    };
    std::sort(diagonals_.begin(), diagonals_.end(), [&](const auto& a, const auto& b) {
        if (a[0] != b[0]) return a[0] < b[0];
        const bool halfA = isInFirstHalf(a[0], a[1]), halfB = isInFirstHalf(a[0], b[1]);
        if (halfA != halfB) return halfA;
        return cross(a[0], a[1], b[1]) > 0;
    });
    diagonalBegin_.assign(n + 1, 0);
    for (const auto& d : diagonals_) ++diagonalBegin_[d[0] + 1];
    std::partial_sum(diagonalBegin_.begin(), diagonalBegin_.end(), diagonalBegin_.begin());

    // edge number: corner i's edge to its next is i, diagonal d is n + d
    used_.assign(n + diagonals_.size(), 0);
    for (std::size_t start = 0; start < used_.size(); ++start) {
        if (used_[start]) continue;
        part_.clear();
        std::size_t edge = start;
        do {
            used_[edge] = 1;
            const Index from = edge < n ? static_cast<Index>(edge) : diagonals_[edge - n][0];
            const Index to = edge < n ? (*corners_)[from].next : diagonals_[edge - n][1];
            part_.push_back(from);
            // the outgoing edge next clockwise from the one we came by
            std::size_t arrival = diagonalBegin_[to + 1];
            if (edge >= n) {
                arrival = diagonalBegin_[to];
                while (diagonals_[arrival][1] != from) ++arrival;
            }
            edge = arrival == diagonalBegin_[to] ? to : n + arrival - 1;
        } while (edge != start);
        triangulateMonotone(out);
    }
}

void PlanarTriangulator::emit(Index a, Index b, Index c, std::vector<LocalTriangle>& out) const {
    if (cross(a, b, c) <= 0) {
        throw InternalError("PlanarTriangulator: the loops do not bound a region (flat triangle)");
    }
    out.push_back({a, b, c});
}

/// The corners from the lowest to the highest, and on which side each lies: up the right side, and
/// down the left.
void PlanarTriangulator::mergeChains() {
    const std::size_t n = part_.size();
    std::size_t lowest = 0, highest = 0;
    for (std::size_t i = 1; i < n; ++i) {
        if (isBefore(part_[i], part_[lowest])) lowest = i;
        if (isBefore(part_[highest], part_[i])) highest = i;
    }
    merged_.clear();
    onLeft_.clear();
    merged_.push_back(part_[lowest]);
    onLeft_.push_back(0);
    std::size_t right = (lowest + 1) % n, left = (lowest + n - 1) % n;
    while (merged_.size() < n) {
        const bool takeRight =
            left == highest || (right != highest && isBefore(part_[right], part_[left]));
        if (right == highest && left == highest) {
            merged_.push_back(part_[highest]);
            onLeft_.push_back(0);
        } else if (takeRight) {
            merged_.push_back(part_[right]);
            onLeft_.push_back(0);
            right = (right + 1) % n;
        } else {
            merged_.push_back(part_[left]);
            onLeft_.push_back(1);
            left = (left + n - 1) % n;
        }
    }
}

void PlanarTriangulator::triangulateMonotone(std::vector<LocalTriangle>& out) {
    const std::size_t n = part_.size();
    if (n == 3) {
        emit(part_[0], part_[1], part_[2], out);
        return;
    }
    mergeChains();
    stack_.assign({0, 1});  // positions in merged_
    for (Index j = 2; j < n; ++j) {
        const bool last = j + 1 == n;
        if (last || onLeft_[j] != onLeft_[stack_.back()]) {
            // sees the whole stack, from the other side
            const bool stackOnLeft = onLeft_[stack_.back()];
            for (std::size_t s = 0; s + 1 < stack_.size(); ++s) {
                const Index a = merged_[stack_[s]], b = merged_[stack_[s + 1]], c = merged_[j];
                if (stackOnLeft) {
                    emit(b, a, c, out);
                } else {
                    emit(a, b, c, out);
                }
            }
            const Index top = stack_.back();
            stack_.assign({top, j});
        } else {
            while (stack_.size() >= 2) {
                const Index a = merged_[stack_[stack_.size() - 2]], b = merged_[stack_.back()],
                            c = merged_[j];
                const std::int64_t turn = cross(a, b, c);
                if (onLeft_[j] ? turn >= 0 : turn <= 0) break;
                if (onLeft_[j]) {
                    emit(b, a, c, out);
                } else {
                    emit(a, b, c, out);
                }
                stack_.pop_back();
            }
            stack_.push_back(j);
        }
    }
}

}  // namespace adaptiso::detail
