#include "adaptive/mending/LocalUndo.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <span>
#include <tuple>
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

struct VertexFan {
    Number vertex;
    Fan fan;
    friend auto operator<=>(const VertexFan&, const VertexFan&) = default;
};

/// \param links  of one vertex, by where they start
Fan fanOf(std::span<const Link> links) {
    std::vector<Number> ends;
    for (const Link& link : links) ends.push_back(link.to);
    std::sort(ends.begin(), ends.end());
    const auto sameStart = [](const Link& a, const Link& b) { return a.from == b.from; };
    if (std::adjacent_find(ends.begin(), ends.end()) != ends.end() ||
        std::adjacent_find(links.begin(), links.end(), sameStart) != links.end()) {
        return Fan::Broken;
    }
    const auto begin = std::find_if(links.begin(), links.end(), [&](const Link& link) {
        return !std::binary_search(ends.begin(), ends.end(), link.from);
    });
    const auto first = begin == links.end() ? links.begin() : begin;
    std::size_t seen = 0;
    auto at = first;
    do {
        ++seen;
        const Number to = at->to;
        at = std::lower_bound(links.begin(), links.end(), to,
                              [](const Link& link, Number v) { return link.from < v; });
        if (at == links.end() || at->from != to) at = links.end();
    } while (at != links.end() && at != first);
    if (seen != links.size()) return Fan::Broken;
    return at == first ? Fan::Closed : Fan::Open;
}

/// By vertex.
std::vector<VertexFan> fansOf(std::vector<Link> links) {
    std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
        return std::tie(a.vertex, a.from, a.to) < std::tie(b.vertex, b.from, b.to);
    });
    std::vector<VertexFan> fans;
    for (std::size_t i = 0, j = 0; i < links.size(); i = j) {
        while (j < links.size() && links[j].vertex == links[i].vertex) ++j;
        fans.push_back({links[i].vertex, fanOf(std::span(links).subspan(i, j - i))});
    }
    return fans;
}

/// \param isMeant  says of a vertex whether its links are wanted
template <class IsMeant>
void addLinks(const SurfaceState::Triangle& t, const IsMeant& isMeant, std::vector<Link>& links) {
    for (int c = 0; c < 3; ++c) {
        if (isMeant(t[c])) links.push_back({t[c], t[(c + 1) % 3], t[(c + 2) % 3]});
    }
}

Index3 cubeOf(const Vec3& p, double side) {
    return {static_cast<std::int64_t>(std::floor(p.x / side)),
            static_cast<std::int64_t>(std::floor(p.y / side)),
            static_cast<std::int64_t>(std::floor(p.z / side))};
}

}  // namespace

std::optional<SurfaceChanges> LocalUndo::around(const std::vector<Triangle>& mended,
                                                const Numbers& seeds,
                                                const std::vector<Vec3>& places, double reachMm) {
    DisjointSets sets(std::ssize(surface_.points));
    const auto number = [](Number v) { return static_cast<std::int64_t>(v); };
    for (const Triangle& t : mended) {
        sets.join(number(t[0]), number(t[1]));
        sets.join(number(t[0]), number(t[2]));
    }
    std::vector<bool> isChosen(surface_.points.size());
    Numbers more = verticesAround(seeds, places, reachMm);
    for (int widening = 0; widening < kMostWidenings; ++widening) {
        for (const Number v : more) isChosen[sets.find(number(v))] = true;
        choose(isChosen, sets);
        if (!hasMerges()) return {};
        makeTriangles();
        more = faults();
        if (more.empty()) return apply();
    }
    return {};
}

LocalUndo::Numbers LocalUndo::verticesAround(const Numbers& seeds, const std::vector<Vec3>& places,
                                             double reachMm) const {
    Numbers vertices;
    for (const Number t : seeds) {
        vertices.insert(vertices.end(), surface_.triangles[t].begin(), surface_.triangles[t].end());
    }
    std::set<Index3> cubes;
    for (const Vec3& place : places) {
        const Index3 cube = cubeOf(place, reachMm);
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
    const std::size_t old = surface_.points.size();
    std::vector<bool> isBeside(old);
    for (const Triangle& t : fresh_) {
        for (const Number v : t) {
            if (!isOfFine(v)) isBeside[v] = true;
        }
    }
    std::vector<Link> before, after;
    const auto isBesideOne = [&](Number v) { return !isOfFine(v) && isBeside[v]; };
    for (const Triangle& t : surface_.triangles) {
        addLinks(t, isBesideOne, before);
        if (!isTouched(t)) addLinks(t, isBesideOne, after);
    }
    for (const Triangle& t : fresh_) {
        addLinks(
            t, [](Number) { return true; }, after);
    }
    for (const Triangle& t : fine_.triangles) {
        for (int c = 0; c < 3; ++c) {
            const Number v = numbers_[t[c]];
            if (isOfFine(v)) before.push_back({v, t[(c + 1) % 3], t[(c + 2) % 3]});
        }
    }
    const std::vector<VertexFan> wanted = fansOf(std::move(before)),
                                 made = fansOf(std::move(after));
    std::vector<VertexFan> different;
    std::set_difference(wanted.begin(), wanted.end(), made.begin(), made.end(),
                        std::back_inserter(different));
    Numbers vertices = flatCorners();
    std::vector<bool> isFaulty(old + apart_.size());
    for (const VertexFan& fan : different) isFaulty[fan.vertex] = true;
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
        const auto [a, b, c] = surface_.triangles[t];
        changes.before.push_back({surface_.points[a], surface_.points[b], surface_.points[c]});
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
