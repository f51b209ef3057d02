#include "adaptive/mending/LocalUndo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

/// The edge across from a vertex in one of its triangles.
struct Link {
    Number vertex, from, to;
};

/// How the triangles around a vertex hang together.
enum class Fan : std::uint8_t { Closed, Open, Broken };

/// \param links  of one vertex
Fan fanOf(std::span<const Link> links) {
    const auto begin = std::find_if(links.begin(), links.end(), [&](const Link& link) {
        return std::none_of(links.begin(), links.end(),
                            [&](const Link& l) { return l.to == link.from; });
    });
    const auto first = begin == links.end() ? links.begin() : begin;
    std::size_t seen = 0;
    auto at = first;
    do {
        ++seen;
        at = std::find_if(links.begin(), links.end(),
                          [to = at->to](const Link& l) { return l.from == to; });
    } while (at != links.end() && at != first && seen < links.size());
    if (seen < links.size() || (at != first && at != links.end())) return Fan::Broken;
    return at == first ? Fan::Closed : Fan::Open;
}

Index3 cubeOf(const Vec3& p, double side) {
    return {static_cast<std::int64_t>(std::floor(p.x / side)),
            static_cast<std::int64_t>(std::floor(p.y / side)),
            static_cast<std::int64_t>(std::floor(p.z / side))};
}

}  // namespace

std::optional<SurfaceChanges> LocalUndo::around(const std::vector<Triangle>& mended,
                                                const std::vector<PlaceBeyond>& places,
                                                double reachMm, std::int64_t most) {
    DisjointSets sets(std::ssize(surface_.points));
    const auto number = [](Number v) { return static_cast<std::int64_t>(v); };
    for (const Triangle& t : mended) {
        sets.join(number(t[0]), number(t[1]));
        sets.join(number(t[0]), number(t[2]));
    }
    std::vector<bool> isChosen(surface_.points.size());
    Numbers more = verticesAround(places, reachMm);
    for (int widening = 0; widening < kMostWidenings; ++widening) {
        for (const Number v : more) isChosen[sets.find(number(v))] = true;
        choose(isChosen, sets);
        if (!hasMerges()) return {};
        isTooMuch_ = std::ssize(apart_) > most;
        if (isTooMuch_) return {};
        makeTriangles();
        more = faults();
        if (more.empty()) return apply();
    }
    return {};
}

LocalUndo::Numbers LocalUndo::verticesAround(const std::vector<PlaceBeyond>& places,
                                             double reachMm) const {
    Numbers vertices;
    std::set<Index3> cubes;
    for (const PlaceBeyond& place : places) {
        if (place.triangle != PlaceBeyond::kNone) {
            const Triangle& t = surface_.triangles[place.triangle];
            vertices.insert(vertices.end(), t.begin(), t.end());
        }
        const Index3 cube = cubeOf(place.point(), reachMm);
        for (int n = 0; n < 27; ++n) {
            cubes.insert({cube[0] + n % 3 - 1, cube[1] + n / 3 % 3 - 1, cube[2] + n / 9 - 1});
        }
    }
    for (Number v = 0; v < surface_.points.size(); ++v) {
        if (cubes.contains(cubeOf(surface_.points[v], reachMm))) vertices.push_back(v);
    }
    return vertices;
}

/// \param isChosen  of each set, at its name
void LocalUndo::choose(const std::vector<bool>& isChosen, DisjointSets& sets) {
    comesApart_.resize(isChosen.size());
    for (std::size_t v = 0; v < isChosen.size(); ++v) {
        comesApart_[v] = isChosen[sets.find(static_cast<std::int64_t>(v))];
    }
    apart_.clear();
    numbers_ = surface_.heirs;
    for (std::size_t v = 0; v < numbers_.size(); ++v) {
        if (!comesApart_[surface_.heirs[v]]) continue;
        numbers_[v] = static_cast<Number>(surface_.points.size() + apart_.size());
        apart_.push_back(static_cast<Number>(v));
    }
}

/// Some of what comes apart share an heir.
bool LocalUndo::hasMerges() const {
    std::vector<bool> isTaken(surface_.points.size());
    return std::any_of(apart_.begin(), apart_.end(), [&](Number v) {
        const Number heir = surface_.heirs[v];
        const bool isShared = isTaken[heir];
        isTaken[heir] = true;
        return isShared;
    });
}

/// The full surface's that have a vertex that comes apart, and do not vanish by the merges that
/// stay.
void LocalUndo::makeTriangles() {
    fresh_.clear();
    for (const Triangle& t : fine_.triangles) {
        if (!isTouched(heirsOf(t))) continue;
        const auto [a, b, c] = t;
        const Triangle now{numbers_[a], numbers_[b], numbers_[c]};
        if (now[0] == now[1] || now[1] == now[2] || now[2] == now[0]) continue;
        fresh_.push_back(now);
    }
}

/// The surface's vertices that have to come apart as well: the triangles around each vertex are to
/// hang together as they do in the surface, or in the full one.
LocalUndo::Numbers LocalUndo::faults() const {
    const std::size_t old = surface_.points.size(), all = old + apart_.size();
    std::vector<bool> isBeside(old), isFaulty(all);
    std::fill(isFaulty.begin() + static_cast<std::ptrdiff_t>(old), isFaulty.end(), true);
    // where the links around each vertex lead less where they start: 0 where they close
    std::vector<Number> open(all);
    std::vector<Link> links;
    for (const Triangle& t : fresh_) {
        for (int c = 0; c < 3; ++c) {
            links.push_back({t[c], t[(c + 1) % 3], t[(c + 2) % 3]});
            if (!isOfFine(t[c])) isBeside[t[c]] = true;
        }
    }
    for (const Triangle& t : surface_.triangles) {
        for (int c = 0; c < 3; ++c) {
            if (!isBeside[t[c]]) continue;
            open[t[c]] += t[(c + 2) % 3] - t[(c + 1) % 3];
            if (!isTouched(t)) links.push_back({t[c], t[(c + 1) % 3], t[(c + 2) % 3]});
        }
    }
    for (const Triangle& t : fine_.triangles) {
        for (int c = 0; c < 3; ++c) {
            const Number v = numbers_[t[c]];
            if (isOfFine(v)) open[v] += t[(c + 2) % 3] - t[(c + 1) % 3];
        }
    }
    std::sort(links.begin(), links.end(),
              [](const Link& a, const Link& b) { return a.vertex < b.vertex; });
    for (std::size_t i = 0, j = 0; i < links.size(); i = j) {
        const Number v = links[i].vertex;
        while (j < links.size() && links[j].vertex == v) ++j;
        isFaulty[v] =
            fanOf(std::span(links).subspan(i, j - i)) != (open[v] == 0 ? Fan::Closed : Fan::Open);
    }
    Numbers vertices = flatCorners();
    for (const Triangle& t : fine_.triangles) {
        const bool isAt =
            isFaulty[numbers_[t[0]]] || isFaulty[numbers_[t[1]]] || isFaulty[numbers_[t[2]]];
        if (!isAt) continue;
        for (const Number v : heirsOf(t)) {
            if (!comesApart_[v]) vertices.push_back(v);
        }
    }
    return vertices;
}

/// Corners of flat triangles between the full surface and this one.
LocalUndo::Numbers LocalUndo::flatCorners() const {
    Numbers corners;
    for (const Triangle& t : fresh_) {
        const Vec3 a = pointOf(t[0]), b = pointOf(t[1]), c = pointOf(t[2]);
        const double longest =
            std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)});
        if (norm(areaVector2(a, b, c)) > kFlatTriangle * longest) continue;
        for (const Number v : t) {
            if (!isOfFine(v)) corners.push_back(v);
        }
    }
    return corners;
}

SurfaceChanges LocalUndo::apply() {
    SurfaceChanges changes;
    Numbers removed, numbers;
    for (Number t = 0; t < surface_.triangles.size(); ++t) {
        if (!isTouched(surface_.triangles[t])) continue;
        removed.push_back(t);
        changes.before.push_back(surface_.view().cornersOf(t));
    }
    addVertices();
    for (std::size_t i = 0; i < fresh_.size(); ++i) {
        const auto next = static_cast<Number>(surface_.triangles.size());
        numbers.push_back(i < removed.size() ? removed[i] : next);
        if (numbers[i] == next) surface_.triangles.emplace_back();
        surface_.triangles[numbers[i]] = fresh_[i];
    }
    changes.triangles = numbers;
    handOver(removed, numbers);
    if (removed.size() > fresh_.size()) {
        removed.erase(removed.begin(), removed.begin() + std::ssize(fresh_));
        removeTriangles(std::move(removed), surface_, changes);
    }
    return changes;
}

/// Final vertices, and those where the surface was cut apart, were merged with none.
void LocalUndo::addVertices() {
    auto sample = surface_.samples.begin();
    Number next = 0;
    for (const Number v : apart_) {
        for (;; ++sample) {  // the vertex's
            if (sample->isMiddle) continue;
            if (next++ == v) break;
        }
        const Number heir =
            std::exchange(surface_.heirs[v], static_cast<Number>(surface_.points.size()));
        surface_.points.push_back(fine_.points[v]);
        surface_.states.push_back(surface_.states[heir] == Patch::State::Final
                                      ? Patch::State::Final
                                      : Patch::State::Open);
        if (!surface_.marks.empty()) {
            const Number mark = surface_.marks[heir];
            const Number own = sample->isOnBorder ? Patch::kBorder : Patch::kPlain;
            surface_.marks.push_back(mark > Patch::kBorder ? mark : own);
        }
        ++sample;
    }
}

/// Gives samples to the nearest of the triangles that came.
void LocalUndo::handOver(const Numbers& removed, const Numbers& numbers) {
    std::vector<bool> isRemoved(surface_.triangles.size());
    for (const Number t : removed) isRemoved[t] = true;
    const TriangleTree tree({surface_.points, fresh_});
    for (std::size_t s = 0; s < surface_.sampleTriangle.size(); ++s) {
        if (!isRemoved[surface_.sampleTriangle[s]]) continue;
        surface_.sampleTriangle[s] = numbers[nearestFresh(surface_.samples[s].point(), tree)];
    }
}

/// The first of those equally near. \param tree  of the fresh ones
std::ptrdiff_t LocalUndo::nearestFresh(const Vec3& p, const TriangleTree& tree) const {
    constexpr double kRounding = 1 + 1e-9;
    const TriangleView view{surface_.points, fresh_};
    BoundingBox box{p, p};
    box.widen(kRounding * std::sqrt(tree.squaredDistance(p, view)));
    std::pair<double, std::uint32_t> best{std::numeric_limits<double>::infinity(), 0};
    tree.forEachOverlap(box, view, [&](std::uint32_t t) {
        best = std::min(best, {squaredDistanceToTriangle(p, view.cornersOf(t)), t});
    });
    return best.second;
}

}  // namespace adaptiso::detail
