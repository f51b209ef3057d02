#include "Arrangement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "adaptiso/Core/AabbTree.h"

namespace adaptiso::detail {
namespace {

using Id = CutTriangle::Id;
using Line = CutTriangle::Line;
using Numbers = std::array<Id, 3>;

Line lineOfPlane(std::uint32_t triangle) {
    return std::uint64_t{triangle} << 1;
}
Line lineOfEdge(std::uint32_t edge) {
    return std::uint64_t{edge} << 1 | 1;
}
bool isEdge(Line line) {
    return (line & 1) != 0;
}
std::uint32_t numberOf(Line line) {
    return static_cast<std::uint32_t>(line >> 1);
}

/// Numbers points by their place, near ones alike.
class NearPlaces {
public:
    explicit NearPlaces(double nearMm) : nearMm_(nearMm) {}

    /// \return  a point that was given before near the place, or this one
    Id add(const Vec3& p, Id number) {
        constexpr Id kNone = ~Id{0};
        Id found = kNone;
        for (int n = 0; n < 8; ++n) {
            const Vec3 beside{n % 2 == 0 ? nearMm_ : -nearMm_, n / 2 % 2 == 0 ? nearMm_ : -nearMm_,
                              n / 4 == 0 ? nearMm_ : -nearMm_};
            const auto at = cells_.find(cellOf(p + beside));
            if (at != cells_.end()) found = std::min(found, at->second);
        }
        if (found == kNone) found = number;
        cells_.try_emplace(cellOf(p), found);
        return found;
    }

private:
    std::array<std::int64_t, 3> cellOf(const Vec3& p) const {
        const double side = 4 * nearMm_;
        return {std::llround(p.x / side), std::llround(p.y / side), std::llround(p.z / side)};
    }

    double nearMm_;
    std::map<std::array<std::int64_t, 3>, Id> cells_;
};

/// Where in a triangle a point lies: a corner, 0 to 2, in an edge, 3 to 5, or in its middle.
using Part = int;
constexpr Part kMiddle = 6;
Part cornerPart(std::size_t corner) {
    return static_cast<Part>(corner);
}
Part edgePart(std::size_t edge) {
    return static_cast<Part>(edge) + 3;
}
bool isOnEdge(Part part, std::size_t edge) {
    return part == cornerPart(edge) || part == cornerPart((edge + 1) % 3) || part == edgePart(edge);
}

/// A point that two triangles have in common.
struct Common {
    Id point;
    Part first, second;
};

/// Finds the lines along which triangles meet, and cuts the triangles along them.
class Arranger {
public:
    Arranger(MendInput& input, double nearMm)
        : input_(input), points_(input.mesh.points), nearMm_(nearMm), nearPlaces_(nearMm) {
        byTriangle_.resize(input.mesh.triangles.size());
        onEdge_.resize(input.edges.size());
    }

    /// \return false where rounding leaves open how a triangle is cut
    bool cut(const std::vector<std::array<std::uint32_t, 2>>& crossing) {
        const auto pairs = withNear(crossing);
        if (pairs.empty() || pairs.size() > kMostPairs) return false;
        std::vector<std::uint8_t> isNumbered(points_.size());
        for (const auto& pair : pairs) {
            for (const std::uint32_t t : pair) {
                for (const VertexId v : input_.mesh.triangles[t]) {
                    if (std::exchange(isNumbered[v], std::uint8_t{1}) != 0) continue;
                    const auto number = static_cast<Id>(v);
                    const Id first = nearPlaces_.add(points_[v], number);
                    if (first == number) continue;
                    becomes_[number] = first;
                    result_.movedMm = std::max(result_.movedMm, norm(at(first) - at(number)));
                }
            }
        }
        joinEdges();
        for (const auto& [s, t] : pairs) meet(s, t);
        for (auto& of : onEdge_) {
            std::sort(of.begin(), of.end());
            of.erase(std::unique(of.begin(), of.end()), of.end());
        }
        for (std::uint32_t t = 0; t < byTriangle_.size(); ++t) {
            if (!cutOne(t)) return false;
        }
        return true;
    }

    Arrangement take() { return std::move(result_); }

private:
    static constexpr std::size_t kMostPairs = 10'000'000;
    static constexpr double kParallel = 1e-9;  ///< what unit normals span, at most
    static constexpr double kBeside = 0.01;    ///< of a triangle's size
    struct Segment {
        Id from, to;
        Line line;
    };
    struct OfTriangle {
        std::vector<Id> inside;
        std::vector<Segment> segments;
    };

    /// Adds the pairs of a triangle that crosses, or lies at a border, and another near it.
    std::vector<std::array<std::uint32_t, 2>> withNear(
        std::vector<std::array<std::uint32_t, 2>> pairs) const {
        std::vector<std::uint32_t> uses(input_.edges.size());
        for (const auto& edges : input_.edgeOf) {
            for (const std::uint32_t e : edges) ++uses[e];
        }
        std::vector<std::uint8_t> isFound(input_.edgeOf.size());
        std::vector<std::uint32_t> found;
        const auto find = [&](std::uint32_t t) {
            if (std::exchange(isFound[t], std::uint8_t{1}) == 0) found.push_back(t);
        };
        for (const auto& [s, t] : pairs) {
            find(s);
            find(t);
        }
        for (std::uint32_t t = 0; t < input_.edgeOf.size(); ++t) {
            for (const std::uint32_t e : input_.edgeOf[t]) {
                if (uses[e] == 1) find(t);
            }
        }
        const AabbTree tree(input_.mesh);
        for (std::size_t n = 0; n < found.size() && pairs.size() <= kMostPairs; ++n) {
            const std::uint32_t t = found[n];
            BoundingBox box = boxOf(cornersAt(t));
            const Vec3 margin{nearMm_, nearMm_, nearMm_};
            box.minimum = box.minimum - margin;
            box.maximum = box.maximum + margin;
            tree.forEachOverlap(box, [&](std::int64_t number) {
                const auto other = static_cast<std::uint32_t>(number);
                if (other == t) return;
                const int one = sumOfSides(t, other), two = sumOfSides(other, t);
                if (std::abs(one) == 3 || std::abs(two) == 3) return;
                pairs.push_back({std::min(other, t), std::max(other, t)});
                // what lies near that counts too
                if ((one == 0 && isInPlane(t, other)) || !shareCorner(t, other)) find(other);
            });
        }
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        return pairs;
    }

    /// 3 or -3: all corners of a triangle lie on one side of another's plane.
    int sumOfSides(std::uint32_t s, std::uint32_t t) const {
        const Corners plane = cornersAt(t);
        int sum = 0;
        for (const Vec3& p : cornersAt(s)) sum += signAt(plane, p);
        return sum;
    }
    bool isInPlane(std::uint32_t s, std::uint32_t t) const {
        const Corners plane = cornersAt(t), corners = cornersAt(s);
        return std::all_of(corners.begin(), corners.end(),
                           [&](const Vec3& p) { return signAt(plane, p) == 0; });
    }
    bool shareCorner(std::uint32_t s, std::uint32_t t) const {
        const Corners a = cornersAt(s), b = cornersAt(t);
        return std::any_of(a.begin(), a.end(), [&](const Vec3& p) {
            return std::find(b.begin(), b.end(), p) != b.end();
        });
    }

    /// Edges between the same points, as they are numbered now, become one.
    void joinEdges() {
        edgeOf_ = input_.edgeOf;
        std::unordered_set<Id> joined;
        for (const auto& [from, to] : becomes_) {
            joined.insert(from);
            joined.insert(to);
        }
        std::map<std::array<Id, 2>, std::uint32_t> first;
        for (auto& edges : edgeOf_) {
            for (std::uint32_t& e : edges) {
                const std::uint32_t a = input_.edges[e].a, b = input_.edges[e].b;
                if (!joined.contains(a) && !joined.contains(b)) continue;
                const Id p = placed(a), q = placed(b);
                e = first.try_emplace({std::min(p, q), std::max(p, q)}, e).first->second;
            }
        }
    }

    Numbers cornersOfTriangle(std::uint32_t t) {
        const auto& [a, b, c] = input_.mesh.triangles[t];
        return {placed(a), placed(b), placed(c)};
    }
    /// The number of the point, or of one that lies near.
    Id placed(VertexId v) {
        const auto found = becomes_.find(static_cast<Id>(v));
        return found == becomes_.end() ? static_cast<Id>(v) : found->second;
    }
    Id addPoint(const Vec3& p) {
        const Id number = static_cast<Id>(points_.size());
        const Id first = nearPlaces_.add(p, number);
        if (first == number) points_.push_back(p);
        return first;
    }
    template <class Make>
    Id pointOf(const std::array<std::uint64_t, 3>& key, const Make& make) {
        const auto found = byKey_.find(key);
        if (found != byKey_.end()) return found->second;
        const Id id = addPoint(make());
        byKey_.emplace(key, id);
        return id;
    }
    Vec3 at(Id p) const { return points_[p]; }

    /// A coordinate that all corners have is that of the points between them.
    static void keepCoordinates(const Vec3* corners, std::size_t count, Vec3& p) {
        for (int axis = 0; axis < 3; ++axis) {
            bool isOne = true;
            for (std::size_t n = 1; n < count; ++n) {
                isOne = isOne && corners[n][axis] == corners[0][axis];
            }
            if (isOne) p[axis] = corners[0][axis];
        }
    }
    std::array<Vec3, 2> endsOf(std::uint32_t edge) const {
        return {points_[input_.edges[edge].a], points_[input_.edges[edge].b]};
    }
    Corners cornersAt(std::uint32_t t) const { return cornersOf(input_.mesh, t); }

    Id edgeAndPlane(std::uint32_t edge, std::uint32_t t) {
        return pointOf({0, edge, t}, [&] {
            const auto ends = endsOf(edge);
            const Corners c = cornersAt(t);
            const Vec3 normal = areaVector2(c[0], c[1], c[2]);
            const double a = dot(ends[0] - c[0], normal), b = dot(ends[1] - c[0], normal);
            const double along = a == b ? 0.5 : std::clamp(a / (a - b), 0.0, 1.0);
            Vec3 p = ends[0] + along * (ends[1] - ends[0]);
            keepCoordinates(c.data(), 3, p);
            keepCoordinates(ends.data(), 2, p);
            return p;
        });
    }
    Id edgeAndEdge(std::uint32_t one, std::uint32_t other) {
        if (other < one) std::swap(one, other);
        return pointOf({1, one, other}, [&] {
            const auto p = endsOf(one), q = endsOf(other);
            const Vec3 d = p[1] - p[0], e = q[1] - q[0], n = cross(d, e);
            const double square = squaredNorm(n);
            const double along =
                square > 0 ? std::clamp(dot(cross(q[0] - p[0], e), n) / square, 0.0, 1.0) : 0.5;
            Vec3 point = p[0] + along * d;
            keepCoordinates(q.data(), 2, point);
            keepCoordinates(p.data(), 2, point);
            return point;
        });
    }
    /// The common point of three planes. None if it lies off the first triangle: two planes are
    /// nearly parallel.
    std::optional<Id> threePlanes(std::array<std::uint32_t, 3> t) {
        const BoundingBox box = boxOf(cornersAt(t[0]));
        std::sort(t.begin(), t.end());
        const std::array<std::uint64_t, 3> key{2 + (std::uint64_t{t[0]} << 8), t[1], t[2]};
        const auto found = byKey_.find(key);
        const Vec3 p = found == byKey_.end() ? commonPoint(t) : points_[found->second];
        const double margin = nearMm_ + kBeside * norm(box.size());
        for (int axis = 0; axis < 3; ++axis) {
            const bool isWithin =
                p[axis] >= box.minimum[axis] - margin && p[axis] <= box.maximum[axis] + margin;
            if (!isWithin) return std::nullopt;
        }
        return pointOf(key, [&] { return p; });
    }
    /// The common point of the planes of three triangles; not finite if two are parallel.
    Vec3 commonPoint(const std::array<std::uint32_t, 3>& t) const {
        const std::array<Corners, 3> c{cornersAt(t[0]), cornersAt(t[1]), cornersAt(t[2])};
        const Vec3 from = c[0][0];
        std::array<Vec3, 3> normal;
        std::array<double, 3> height{};
        for (std::size_t n = 0; n < 3; ++n) {
            normal[n] = normalized(areaVector2(c[n][0], c[n][1], c[n][2]));
            height[n] = dot(normal[n], c[n][0] - from);
        }
        double volume = dot(normal[0], cross(normal[1], normal[2]));
        if (std::abs(volume) < kParallel) volume = 0;
        Vec3 p = from + (1 / volume) * (height[0] * cross(normal[1], normal[2]) +
                                        height[1] * cross(normal[2], normal[0]) +
                                        height[2] * cross(normal[0], normal[1]));
        for (const Corners& of : c) keepCoordinates(of.data(), 3, p);
        return p;
    }

    /// On which side of a triangle's plane a point lies; 0: near it.
    int signAt(const Corners& c, const Vec3& p) const {
        const Vec3 normal = areaVector2(c[0], c[1], c[2]);
        if (std::abs(dot(normal, p - c[0])) <= nearMm_ * norm(normal)) return 0;
        return orient3d(c[0], c[1], c[2], p);
    }
    /// How the lines of two edges turn; 0: they pass near each other.
    int turnOf(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
        const Vec3 normal = cross(b - a, d - c);
        if (std::abs(dot(normal, c - a)) <= nearMm_ * norm(normal)) return 0;
        return orient3d(a, b, c, d);
    }
    /// On which side of a line in a plane a point lies; 0: near it.
    int sideOf(const Point2& a, const Point2& b, const Point2& p) const {
        const double u = b[0] - a[0], v = b[1] - a[1];
        const double area = u * (p[1] - a[1]) - v * (p[0] - a[0]);
        if (std::abs(area) <= nearMm_ * std::sqrt(u * u + v * v)) return 0;
        return orient2d(a, b, p);
    }

    /// Adds a point once, with the smallest parts that it lies in.
    static void addCommon(std::vector<Common>& all, const Common& common) {
        for (Common& is : all) {
            if (is.point != common.point) continue;
            is.first = std::min(is.first, common.first);
            is.second = std::min(is.second, common.second);
            return;
        }
        all.push_back(common);
    }

    /// Points of one triangle's corners and edges in the other.
    void addPointsOf(std::uint32_t s, std::uint32_t t, bool isSwapped,
                     std::vector<Common>& common) {
        const Corners a = cornersAt(s), b = cornersAt(t);
        const Numbers ofA = cornersOfTriangle(s), ofB = cornersOfTriangle(t);
        const auto add = [&](Id p, Part inA, Part inB) {
            addCommon(common, isSwapped ? Common{p, inB, inA} : Common{p, inA, inB});
        };
        std::array<int, 3> sign{};
        for (std::size_t i = 0; i < 3; ++i) sign[i] = signAt(b, a[i]);
        const int dropped = longestAxis(areaVector2(b[0], b[1], b[2]));
        const auto flat = [&](const Vec3& p) {
            return Point2{p[(dropped + 1) % 3], p[(dropped + 2) % 3]};
        };
        const int facing = orient2d(flat(b[0]), flat(b[1]), flat(b[2]));
        const auto sideOfEdge = [&](std::size_t j, const Vec3& p) {
            return facing * sideOf(flat(b[j]), flat(b[(j + 1) % 3]), flat(p));
        };
        for (std::size_t i = 0; i < 3; ++i) {
            if (sign[i] != 0) continue;
            Part in = kMiddle;
            bool isOutside = false;
            for (std::size_t j = 0; j < 3; ++j) {
                const int side = sideOfEdge(j, a[i]);
                if (side < 0) isOutside = true;
                if (side == 0) in = std::min(in, edgePart(j));
                if (ofA[i] == ofB[j]) in = cornerPart(j);
            }
            if (!isOutside) add(ofA[i], cornerPart(i), in);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t k = (i + 1) % 3;
            const std::uint32_t edge = edgeOf_[s][i];
            if (sign[i] * sign[k] < 0) {
                std::array<int, 3> turn{};
                int least = 1, most = -1;
                for (std::size_t j = 0; j < 3; ++j) {
                    turn[j] = turnOf(a[i], a[k], b[j], b[(j + 1) % 3]);
                    least = std::min(least, turn[j]);
                    most = std::max(most, turn[j]);
                }
                if (least < 0 && most > 0) continue;
                std::vector<std::size_t> zeros;
                for (std::size_t j = 0; j < 3; ++j) {
                    if (turn[j] == 0) zeros.push_back(j);
                }
                if (zeros.empty()) {
                    add(edgeAndPlane(edge, t), edgePart(i), kMiddle);
                } else if (zeros.size() == 1) {
                    add(edgeAndEdge(edge, edgeOf_[t][zeros[0]]), edgePart(i), edgePart(zeros[0]));
                }  // two: at the other's corner, which is found from there
            } else if (sign[i] == 0 && sign[k] == 0) {
                for (std::size_t j = 0; j < 3; ++j) {
                    const int from = sideOfEdge(j, a[i]), to = sideOfEdge(j, a[k]);
                    const int one = sideOf(flat(a[i]), flat(a[k]), flat(b[j])),
                              other = sideOf(flat(a[i]), flat(a[k]), flat(b[(j + 1) % 3]));
                    if (from * to < 0 && one * other < 0) {
                        add(edgeAndEdge(edge, edgeOf_[t][j]), edgePart(i), edgePart(j));
                    }
                }
            }
        }
    }

    static int longestAxis(const Vec3& v) {
        int axis = 0;
        for (int n = 1; n < 3; ++n) {
            if (std::abs(v[n]) > std::abs(v[axis])) axis = n;
        }
        return axis;
    }

    /// Sorts points along a line.
    void sortAlong(std::vector<Common>& common) const {
        if (common.size() < 2) return;
        Vec3 low = at(common[0].point), high = low;
        for (const Common& of : common) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], at(of.point)[axis]);
                high[axis] = std::max(high[axis], at(of.point)[axis]);
            }
        }
        const int axis = longestAxis(high - low);
        std::sort(common.begin(), common.end(), [&](const Common& p, const Common& q) {
            return std::pair(at(p.point)[axis], p.point) < std::pair(at(q.point)[axis], q.point);
        });
    }

    /// Adds a part of a line to a triangle, where it does not lie along its edge.
    void addSegment(std::uint32_t t, Id from, Id to, Part fromPart, Part toPart, Line line) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (isOnEdge(fromPart, i) && isOnEdge(toPart, i)) return;
        }
        byTriangle_[t].segments.push_back({from, to, line});
    }

    void addPoint(std::uint32_t t, Id p, Part part) {
        if (part == kMiddle) byTriangle_[t].inside.push_back(p);
        if (part >= 3 && part < kMiddle) onEdge_[edgeOf_[t][part - 3]].push_back(p);
    }

    void meet(std::uint32_t s, std::uint32_t t) {
        std::vector<Common> common;
        addPointsOf(s, t, false, common);
        addPointsOf(t, s, true, common);
        for (const Common& of : common) {
            addPoint(s, of.point, of.first);
            addPoint(t, of.point, of.second);
        }
        if (isInPlane(s, t)) {
            for (std::size_t i = 0; i < 3; ++i) {
                std::vector<Common> ofA, ofB;
                for (const Common& of : common) {
                    if (isOnEdge(of.first, i)) ofA.push_back(of);
                    if (isOnEdge(of.second, i)) ofB.push_back(of);
                }
                sortAlong(ofA);
                sortAlong(ofB);
                for (std::size_t n = 1; n < ofA.size(); ++n) {
                    addSegment(t, ofA[n - 1].point, ofA[n].point, ofA[n - 1].second, ofA[n].second,
                               lineOfEdge(edgeOf_[s][i]));
                }
                for (std::size_t n = 1; n < ofB.size(); ++n) {
                    addSegment(s, ofB[n - 1].point, ofB[n].point, ofB[n - 1].first, ofB[n].first,
                               lineOfEdge(edgeOf_[t][i]));
                }
            }
            return;
        }
        sortAlong(common);
        for (std::size_t n = 1; n < common.size(); ++n) {
            const Common &p = common[n - 1], &q = common[n];
            Line ofS = lineOfPlane(s), ofT = lineOfPlane(t);
            for (std::size_t i = 0; i < 3; ++i) {
                if (isOnEdge(p.first, i) && isOnEdge(q.first, i)) {
                    ofS = lineOfEdge(edgeOf_[s][i]);
                }
                if (isOnEdge(p.second, i) && isOnEdge(q.second, i)) {
                    ofT = lineOfEdge(edgeOf_[t][i]);
                }
            }
            addSegment(s, p.point, q.point, p.first, q.first, ofT);
            addSegment(t, p.point, q.point, p.second, q.second, ofS);
        }
    }

    bool cutOne(std::uint32_t t) {
        OfTriangle& of = byTriangle_[t];
        const Numbers corners = cornersOfTriangle(t);
        bool isWhole = of.inside.empty() && of.segments.empty();
        for (const std::uint32_t e : edgeOf_[t]) isWhole = isWhole && onEdge_[e].empty();
        const bool isFlat =
            corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
        const Triangle& given = input_.mesh.triangles[t];
        const bool isSame = std::equal(corners.begin(), corners.end(), given.begin(),
                                       [](Id one, VertexId other) { return one == other; });
        result_.isCut.push_back(isWhole && isSame ? 0 : 1);
        if (isFlat) return true;
        if (isWhole) {
            result_.triangles.push_back(corners);
            result_.origin.push_back(t);
            return true;
        }
        CutTriangle cut(points_, corners, nearMm_);
        for (std::size_t i = 0; i < 3; ++i) {
            const Id a = corners[i], b = corners[(i + 1) % 3];
            std::vector<std::pair<double, Id>> along;
            for (const Id p : onEdge_[edgeOf_[t][i]]) {
                if (p == a || p == b) continue;
                along.emplace_back(dot(at(p) - at(a), at(b) - at(a)), p);
            }
            std::sort(along.begin(), along.end());
            Id from = a;
            for (const auto& [where, p] : along) {
                if (p == corners[(i + 2) % 3]) return true;  // flat: its sides lie on each other
                if (!cut.addOnBorder(p, from, b)) return false;
                from = p;
            }
        }
        std::sort(of.inside.begin(), of.inside.end());
        for (const Id p : of.inside) {
            if (!cut.add(p)) return false;
        }
        const auto crossingOf = [&](Line one, Line other) -> std::optional<Id> {
            if (one == other) return std::nullopt;
            if (isEdge(one) && isEdge(other)) return edgeAndEdge(numberOf(one), numberOf(other));
            if (isEdge(one)) return edgeAndPlane(numberOf(one), numberOf(other));
            if (isEdge(other)) return edgeAndPlane(numberOf(other), numberOf(one));
            return threePlanes({t, numberOf(one), numberOf(other)});
        };
        for (const auto& [from, to, line] : of.segments) {
            if (!cut.addSegment(from, to, line, crossingOf)) return false;
        }
        for (const Numbers& part : cut.finish()) {
            result_.triangles.push_back(part);
            result_.origin.push_back(t);
        }
        return true;
    }

    MendInput& input_;
    std::vector<Vec3>& points_;
    double nearMm_;
    Arrangement result_;
    NearPlaces nearPlaces_;
    std::vector<std::array<std::uint32_t, 3>> edgeOf_;  ///< of a triangle, as MendInput has them
    std::unordered_map<Id, Id> becomes_;                ///< points that lie near another
    std::map<std::array<std::uint64_t, 3>, Id> byKey_;  ///< points by what meets there
    std::vector<OfTriangle> byTriangle_;
    std::vector<std::vector<Id>> onEdge_;  ///< points between the ends of each
};

}  // namespace

std::optional<Arrangement> arrange(MendInput& mesh,
                                   const std::vector<std::array<std::uint32_t, 2>>& pairs,
                                   double nearMm) {
    const std::size_t points = mesh.mesh.points.size();
    Arranger arranger(mesh, nearMm);
    if (arranger.cut(pairs)) return arranger.take();
    mesh.mesh.points.resize(points);
    return std::nullopt;
}

}  // namespace adaptiso::detail
