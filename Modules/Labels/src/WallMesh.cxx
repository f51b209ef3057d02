#include "WallMesh.h"

#include <algorithm>
#include <map>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {

WallMesh::WallMesh(const LabelComplex& full)
    : fullPoints_(static_cast<std::int64_t>(full.points.size())),
      fullTriangles_(static_cast<std::int64_t>(full.triangles.size())),
      alive_(fullTriangles_),
      points_(full.points),
      triangles_(full.triangles.size()),
      maker_(full.triangles.size(), kNone),
      killer_(full.triangles.size(), kNone),
      begin_(full.points.size() + 1, 0),
      count_(full.points.size(), 0) {
    if (full.triangles.size() > kNone / 8) {
        throw InvalidInput("extractLabels: too many triangles to simplify: " +
                           std::to_string(full.triangles.size()));
    }
    std::map<std::array<Label, 2>, Id> numbers;
    for (const auto& labels : full.labels) {
        const auto [at, isNew] = numbers.try_emplace(labels, static_cast<Id>(walls_.size()));
        if (isNew) walls_.push_back(labels);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            triangles_[t].v[c] = static_cast<Id>(full.triangles[t][c]);
            ++begin_[triangles_[t].v[c] + 1];
        }
        triangles_[t].wall = numbers.find(full.labels[t])->second;
    }
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    entries_.resize(begin_.back());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (const Id v : triangles_[t].v) entries_[begin_[v] + count_[v]++] = static_cast<Id>(t);
    }
    begin_.pop_back();
    findKinds();
}

int WallMesh::orderOf(Id u, Id v) const {
    int order = 0;
    for (const Id t : around(u)) order += triangles_[t].has(v) ? 1 : 0;
    return order;
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

LabelComplex WallMesh::complex(std::vector<Id>* numbers) const {
    LabelComplex out;
    std::vector<VertexId> number(points_.size(), -1);
    for (Id v = 0; v < points_.size(); ++v) {
        if (!isAlive(v)) continue;
        number[v] = static_cast<VertexId>(out.points.size());
        out.points.push_back(points_[v]);
    }
    out.triangles.reserve(alive_);
    out.labels.reserve(alive_);
    if (numbers != nullptr) numbers->clear();
    for (Id t = 0; t < triangles_.size(); ++t) {
        if (!isTriangleAlive(t)) continue;
        const auto& v = triangles_[t].v;
        out.triangles.push_back({number[v[0]], number[v[1]], number[v[2]]});
        out.labels.push_back(walls_[triangles_[t].wall]);
        if (numbers != nullptr) numbers->push_back(t);
    }
    return out;
}

}  // namespace adaptiso::detail
