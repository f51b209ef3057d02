#include "CutTriangle.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace adaptiso::detail {
namespace {

/// Whether d lies within the circle through a, b, c, which run counter-clockwise: 1, -1, or 0 where
/// rounding leaves it open.
int sideOfCircle(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
    constexpr double kRounding = 1e-12;
    double size = 0;
    std::array<double, 3> x{}, y{}, square{};
    for (std::size_t n = 0; n < 3; ++n) {
        const Point2& p = n == 0 ? a : n == 1 ? b : c;
        x[n] = p[0] - d[0];
        y[n] = p[1] - d[1];
        square[n] = x[n] * x[n] + y[n] * y[n];
        size = std::max(size, square[n]);
    }
    const double inside = square[0] * (x[1] * y[2] - x[2] * y[1]) +
                          square[1] * (x[2] * y[0] - x[0] * y[2]) +
                          square[2] * (x[0] * y[1] - x[1] * y[0]);
    if (std::abs(inside) <= kRounding * size * size) return 0;
    return inside > 0 ? 1 : -1;
}

}  // namespace

CutTriangle::CutTriangle(const std::vector<Vec3>& points, const std::array<Id, 3>& corners,
                         double nearMm)
    : points_(points), nearMm_(nearMm), last_{corners[0], corners[1]} {
    const Vec3 normal = areaVector2(points[corners[0]], points[corners[1]], points[corners[2]]);
    int axis = 0;
    for (int n = 1; n < 3; ++n) {
        if (std::abs(normal[n]) > std::abs(normal[axis])) axis = n;
    }
    u_ = (axis + 1) % 3;
    v_ = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u_, v_);
    put(corners[0], corners[1], corners[2]);
}

bool CutTriangle::isAhead(Id from, Id to, Id p) const {
    const Point2 a = flat(from), b = flat(to), c = flat(p);
    return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]) > 0;
}

/// side(), but that points near the segment are on it.
int CutTriangle::sideOfSegment(Id from, Id to, Id p) const {
    const Point2 a = flat(from), b = flat(to), c = flat(p);
    const double u = b[0] - a[0], v = b[1] - a[1];
    const double area = u * (c[1] - a[1]) - v * (c[0] - a[0]);
    const bool isNear = std::abs(area) <= nearMm_ * std::sqrt(u * u + v * v);
    return isNear && isAhead(from, to, p) && isAhead(to, from, p) ? 0 : side(from, to, p);
}

CutTriangle::Id CutTriangle::across(Id a, Id b) const {
    const auto found = across_.find(key(a, b));
    return found == across_.end() ? kNone : found->second;
}

void CutTriangle::put(Id a, Id b, Id c) {
    across_[key(a, b)] = c;
    across_[key(b, c)] = a;
    across_[key(c, a)] = b;
    spoke_[a] = b;
    spoke_[b] = c;
    spoke_[c] = a;
    last_ = {a, b};
}

void CutTriangle::take(Id a, Id b, Id c) {
    across_.erase(key(a, b));
    across_.erase(key(b, c));
    across_.erase(key(c, a));
}

/// Joins w and x instead of u and v: triangles u, v, w and v, u, x.
void CutTriangle::flip(Id u, Id v, Id w, Id x) {
    take(u, v, w);
    take(v, u, x);
    put(x, v, w);
    put(w, u, x);
}

/// Puts p between a and b, in the triangles on both sides. \return  false, and nothing is done,
/// where one would have no area
bool CutTriangle::splitEdge(Id p, Id a, Id b) {
    std::vector<std::array<Id, 2>> rim;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        const Id c = across(from, to);
        if (c == kNone) continue;
        if (side(p, to, c) <= 0 || side(p, c, from) <= 0) return false;
    }
    const auto line = lines_.find(sideKey(a, b));
    if (line != lines_.end()) {
        const Line of = line->second;
        lines_.erase(line);
        lines_[sideKey(a, p)] = lines_[sideKey(p, b)] = of;
    }
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        const Id c = across(from, to);
        if (c == kNone) continue;
        take(from, to, c);
        put(p, to, c);
        put(p, c, from);
        rim.push_back({to, c});
        rim.push_back({c, from});
    }
    improve(std::move(rim));
    return has(p);
}

bool CutTriangle::addOnBorder(Id p, Id from, Id to) {
    if (has(p) || across(from, to) == kNone) return false;
    return splitEdge(p, from, to);
}

bool CutTriangle::add(Id p) {
    if (has(p)) return true;
    Id a = last_[0], b = last_[1];
    if (across(a, b) == kNone) std::swap(a, b);
    const std::size_t most = across_.size() + 3;
    for (std::size_t step = 0; step < most; ++step) {
        const Id c = across(a, b);
        const std::array<Id, 3> t{a, b, c};
        int zeros = 0;
        std::size_t on = 0;
        bool isElsewhere = false;
        for (std::size_t n = 0; n < 3 && !isElsewhere; ++n) {
            const Id from = t[n], to = t[(n + 1) % 3];
            const int at = side(from, to, p);
            if (at < 0) {
                if (across(to, from) == kNone) return false;
                a = to;
                b = from;
                isElsewhere = true;
            } else if (at == 0) {
                ++zeros;
                on = n;
            }
        }
        if (isElsewhere) continue;
        if (zeros > 1) return false;
        if (zeros == 1) return splitEdge(p, t[on], t[(on + 1) % 3]);
        take(t[0], t[1], t[2]);
        for (std::size_t n = 0; n < 3; ++n) put(p, t[n], t[(n + 1) % 3]);
        improve({{t[0], t[1]}, {t[1], t[2]}, {t[2], t[0]}});
        return true;
    }
    return false;
}

bool CutTriangle::isBetterFlipped(Id u, Id v, Id w, Id x) const {
    // sorted by number: all triangles of a plane decide alike
    std::array<Id, 4> order{u, v, w, x};
    int swaps = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
            if (order[j] < order[i]) {
                std::swap(order[i], order[j]);
                ++swaps;
            }
        }
    }
    int inside = sideOfCircle(flat(order[0]), flat(order[1]), flat(order[2]), flat(order[3]));
    if (swaps % 2 != 0) inside = -inside;
    if (inside != 0) return inside > 0;
    return std::min(w, x) < std::min(u, v);
}

void CutTriangle::improve(std::vector<std::array<Id, 2>> edges) {
    std::size_t flipsLeft = 20 * (across_.size() + edges.size());  // rounding may lead in circles
    while (!edges.empty()) {
        const auto [u, v] = edges.back();
        edges.pop_back();
        const Id w = across(u, v), x = across(v, u);
        if (w == kNone || x == kNone || lines_.contains(sideKey(u, v))) continue;
        if (!isBetterFlipped(u, v, w, x) || !isConvex(u, v, w, x)) continue;
        if (flipsLeft-- == 0) return;
        flip(u, v, w, x);
        edges.insert(edges.end(), {{x, v}, {v, w}, {w, u}, {u, x}});
    }
}

/// A segment meets the line that joins a and b.
bool CutTriangle::meet(const Segment& segment, Id a, Id b, std::vector<Segment>& stack,
                       const CrossingOf& crossingOf) {
    const auto found = lines_.find(sideKey(a, b));
    const Line other = found->second;
    auto at = crossingOf(segment.line, other);
    if (!at) {  // nearly parallel lines: the end that lies nearer is on both
        const Vec3 p = points_[segment.from], along = points_[segment.to] - p;
        const bool isFirst =
            squaredNorm(cross(along, points_[a] - p)) <= squaredNorm(cross(along, points_[b] - p));
        at = isFirst ? a : b;
        if (*at == segment.from || *at == segment.to) return false;
    }
    if (*at != a && *at != b && (has(*at) || !splitEdge(*at, a, b))) {
        // rounding has it beside the line, which goes through it then
        lines_.erase(found);
        if (!add(*at)) return false;
        stack.push_back({a, *at, other});
        stack.push_back({*at, b, other});
    }
    stack.push_back({segment.from, *at, segment.line});
    stack.push_back({*at, segment.to, segment.line});
    return true;
}

/// Makes a segment an edge by flips of those that it crosses [Sloan1993].
bool CutTriangle::force(const Segment& segment, std::vector<std::array<Id, 2>> crossed) {
    std::size_t triesLeft = 100 + 4 * crossed.size() * crossed.size();
    for (std::size_t n = 0; n < crossed.size(); ++n) {
        const auto [u, v] = crossed[n];
        const Id w = across(u, v), x = across(v, u);
        if (w == kNone || x == kNone || triesLeft-- == 0) return false;
        if (!isConvex(u, v, w, x)) {
            crossed.push_back({u, v});
            continue;
        }
        flip(u, v, w, x);
        const bool isEnd =
            w == segment.from || w == segment.to || x == segment.from || x == segment.to;
        if (isEnd) continue;
        if (side(segment.from, segment.to, w) * side(segment.from, segment.to, x) < 0) {
            crossed.push_back({w, x});
        }
    }
    if (!hasEdge(segment.from, segment.to)) return false;
    lines_[sideKey(segment.from, segment.to)] = segment.line;
    return true;
}

/// Makes a segment an edge; where it passes a point or a line, puts its parts on the stack.
bool CutTriangle::pass(const Segment& segment, std::vector<Segment>& stack,
                       const CrossingOf& crossingOf) {
    const Id from = segment.from, to = segment.to;
    const auto passPoint = [&](Id p) {
        stack.push_back({p, to, segment.line});
        stack.push_back({from, p, segment.line});
        return true;
    };
    // round the first point, left and then right
    Id right = kNone, left = kNone;
    for (const bool isLeftward : {true, false}) {
        Id a = spoke_.at(from);
        for (std::size_t step = 0; step < across_.size() && right == kNone; ++step) {
            const Id b = isLeftward ? across(from, a) : across(a, from);
            const int sideA = sideOfSegment(from, to, a);
            if (sideA == 0 && isAhead(from, to, a)) return passPoint(a);
            if (b == kNone) break;
            const Id r = isLeftward ? a : b, l = isLeftward ? b : a;
            if (sideOfSegment(from, to, r) < 0 && sideOfSegment(from, to, l) > 0) {
                right = r;
                left = l;
            }
            a = b;
        }
    }
    if (right == kNone) return false;
    std::vector<std::array<Id, 2>> crossed;
    while (crossed.size() <= across_.size()) {
        if (lines_.contains(sideKey(right, left))) {
            return meet(segment, right, left, stack, crossingOf);
        }
        crossed.push_back({right, left});
        const Id next = across(left, right);
        if (next == kNone) return false;
        if (next == to) return force(segment, std::move(crossed));
        const int at = sideOfSegment(from, to, next);
        if (at == 0) return passPoint(next);
        (at < 0 ? right : left) = next;
    }
    return false;
}

bool CutTriangle::addSegment(Id from, Id to, Line line, const CrossingOf& crossingOf) {
    std::vector<Segment> stack{{from, to, line}};
    for (std::size_t steps = 0; !stack.empty(); ++steps) {
        const Segment segment = stack.back();
        stack.pop_back();
        if (segment.from == segment.to) continue;
        if (!has(segment.from) || !has(segment.to) || steps > 100'000) return false;
        if (hasEdge(segment.from, segment.to)) {
            const std::array<Id, 2> beside{across(segment.from, segment.to),
                                           across(segment.to, segment.from)};
            const auto on = std::find_if(beside.begin(), beside.end(), [&](Id p) {
                return p != kNone && sideOfSegment(segment.from, segment.to, p) == 0;
            });
            if (on == beside.end()) {
                lines_[sideKey(segment.from, segment.to)] = segment.line;
            } else {
                stack.push_back({*on, segment.to, segment.line});
                stack.push_back({segment.from, *on, segment.line});
            }
        } else if (!pass(segment, stack, crossingOf)) {
            return false;
        }
    }
    return true;
}

std::vector<std::array<CutTriangle::Id, 3>> CutTriangle::finish() {
    std::vector<std::array<Id, 2>> edges;
    for (const auto& [edge, opposite] : across_) {
        edges.push_back({static_cast<Id>(edge >> 32), static_cast<Id>(edge)});
    }
    std::sort(edges.begin(), edges.end());
    improve(std::move(edges));
    std::vector<std::array<Id, 3>> triangles;
    for (const auto& [edge, c] : across_) {
        const auto a = static_cast<Id>(edge >> 32), b = static_cast<Id>(edge);
        if (a < b && a < c) triangles.push_back({a, b, c});
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

}  // namespace adaptiso::detail
