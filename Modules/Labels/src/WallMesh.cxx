#include "WallMesh.h"

#include <algorithm>

namespace adaptiso::detail {

WallMesh::WallMesh(const WallPatch& patch)
    : fullPoints_(static_cast<Id>(patch.fullPoints.size())),
      fullTriangles_(static_cast<Id>(patch.fullTriangles.size())),
      firstPoint_(patch.isFull() ? 0 : fullPoints_),
      firstTriangle_(patch.isFull() ? 0 : fullTriangles_),
      points_(patch.fullPoints),
      triangles_(patch.fullTriangles) {
    points_.insert(points_.end(), patch.points.begin(), patch.points.end());
    for (WallTriangle t : patch.triangles) {
        for (Id& v : t.v) v += firstPoint_;
        triangles_.push_back(t);
    }
    maker_.assign(triangles_.size(), kNone);
    killer_.assign(triangles_.size(), kNone);
    std::fill_n(killer_.begin(), firstTriangle_, kNone - 1);
    alive_ = static_cast<std::int64_t>(triangles_.size()) - firstTriangle_;
    begin_.assign(points_.size() + 1, 0);
    count_.assign(points_.size(), 0);
    for (Id t = firstTriangle_; t < triangles_.size(); ++t) {
        for (const Id v : triangles_[t].v) ++begin_[v + 1];
    }
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    entries_.resize(begin_.back());
    for (Id t = firstTriangle_; t < triangles_.size(); ++t) {
        for (const Id v : triangles_[t].v) entries_[begin_[v] + count_[v]++] = t;
    }
    begin_.pop_back();
    if (patch.isFull()) {
        findKinds();
    } else {
        kinds_.assign(fullPoints_, Kind::Wall);
        kinds_.insert(kinds_.end(), patch.kinds.begin(), patch.kinds.end());
    }
}

int WallMesh::orderOf(Id u, Id v) const {
    int order = 0;
    Id wall = kNone;
    bool areSame = true;
    for (const Id t : around(u)) {
        if (!triangles_[t].has(v)) continue;
        areSame = areSame && (order == 0 || triangles_[t].wall == wall);
        wall = triangles_[t].wall;
        ++order;
    }
    return order == 2 && !areSame ? 3 : order;
}

void WallMesh::findKinds() {
    kinds_.assign(points_.size(), Kind::Wall);
    for (Id v = 0; v < points_.size(); ++v) {
        const auto own = around(v);
        const Id wall = own.empty() ? kNone : triangles_[own.front()].wall;
        if (std::all_of(own.begin(), own.end(), [&](Id t) { return triangles_[t].wall == wall; })) {
            continue;
        }
        int curves = 0, order = 0;
        bool areAlike = true;
        std::vector<Id> seen;
        for (const Id t : own) {
            for (const Id x : triangles_[t].v) {
                if (x == v || std::find(seen.begin(), seen.end(), x) != seen.end()) continue;
                seen.push_back(x);
                const int at = orderOf(v, x);
                if (at < 3) continue;
                areAlike = areAlike && (curves == 0 || order == at);
                order = at;
                ++curves;
            }
        }
        kinds_[v] = curves == 2 && areAlike ? Kind::Curve : Kind::Corner;
    }
}

void WallMesh::replaceEntry(Id vertex, Id from, Id to) {
    Id* begin = entries_.data() + begin_[vertex];
    Id* at = std::find(begin, begin + count_[vertex], from);
    *at = to;
}

WallMesh::Id WallMesh::collapse(Id u, Id v, const Vec3& point, Kind kind, std::span<const Id> star,
                                std::size_t kept) {
    const Id n = static_cast<Id>(changes_.size()), w = static_cast<Id>(points_.size());
    Change change{u,
                  v,
                  w,
                  removed_.size(),
                  removed_.size() + star.size(),
                  static_cast<Id>(triangles_.size()),
                  static_cast<Id>(triangles_.size() + kept)};
    removed_.insert(removed_.end(), star.begin(), star.end());
    points_.push_back(point);
    kinds_.push_back(kind);
    begin_.push_back(entries_.size());
    count_.push_back(static_cast<Id>(kept));
    for (std::size_t i = 0; i < star.size(); ++i) {
        const Id t = star[i];
        killer_[t] = n;
        if (i < kept) {
            WallTriangle made = triangles_[t];
            const Id number = static_cast<Id>(triangles_.size());
            for (Id& x : made.v) {
                if (x == u || x == v) {
                    x = w;
                } else {
                    replaceEntry(x, t, number);
                }
            }
            triangles_.push_back(made);
            maker_.push_back(n);
            killer_.push_back(kNone);
            entries_.push_back(number);
            continue;
        }
        for (const Id x : triangles_[t].v) {
            if (x == u || x == v) continue;
            Id* begin = entries_.data() + begin_[x];
            Id* at = std::find(begin, begin + count_[x], t);
            *at = begin[--count_[x]];
        }
    }
    alive_ -= static_cast<std::int64_t>(star.size() - kept);
    count_[u] = count_[v] = 0;
    changes_.push_back(change);
    return n;
}

void WallMesh::undoOne(const Change& change) {
    const auto star = removedBy(change);
    const std::size_t kept = change.madeEnd - change.madeBegin;
    count_[change.w] = 0;
    for (std::size_t i = 0; i < star.size(); ++i) {
        const Id t = star[i];
        killer_[t] = kNone;
        for (const Id x : triangles_[t].v) {
            if (x == change.u || x == change.v) {
                entries_[begin_[x] + count_[x]++] = t;
            } else if (i < kept) {
                replaceEntry(x, change.madeBegin + static_cast<Id>(i), t);
            } else {
                entries_[begin_[x] + count_[x]++] = t;
            }
        }
    }
    alive_ += static_cast<std::int64_t>(star.size() - kept);
}

}  // namespace adaptiso::detail
