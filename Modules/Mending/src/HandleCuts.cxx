#include "HandleCuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>

#include "BorderCaps.h"
#include "MendDistances.h"
#include "NearnessProof.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::detail {
namespace {

using EdgeId = std::uint32_t;
using PointId = std::uint32_t;

/// A loop along which a plane passes the surface.
struct Section {
    Vec3 normal;
    double offset = 0;
    std::vector<EdgeId> edges;  ///< that it passes, in order
    double areaMm2 = 0;         ///< of its flat disc; negative where that lies outside the solid
    std::uint64_t label = 0;    ///< of its class of homology, by halves; 0: it parts its piece
    BoundingBox box;
};

/// Where a plane passes an edge whose ends it parts.
Vec3 pointAlong(const Vec3& a, const Vec3& b, double heightA, double heightB) {
    return a + heightA / (heightA - heightB) * (b - a);
}

/// Edges with their triangles. \pre the mesh is closed and oriented
MendInput connected(const TriangleMesh& mesh) {
    MendInput input;
    input.mesh = mesh;
    findEdges(input);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            MendInput::Edge& edge = input.edges[input.edgeOf[t][i]];
            edge.triangles[mesh.triangles[t][i] == edge.a ? 0 : 1] = static_cast<std::int64_t>(t);
        }
    }
    return input;
}

/// Finds sections by which handles go.
class HandleSearch {
public:
    explicit HandleSearch(const MendInput& input) : input_(input), tree_(input.mesh) {
        growTree();
        findGenerators();
    }

    /// The smallest discs, of loops that together part no piece, with boxes clear of each other.
    std::vector<Section> smallest(double roomMm) const {
        std::vector<std::optional<Section>> found(generators_.size());
        parallelForPieces(std::ssize(found), 1, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) found[n] = bestAt(generators_[n]);
        });
        std::vector<Section> sections;
        for (auto& section : found) {
            if (section) sections.push_back(std::move(*section));
        }
        std::stable_sort(sections.begin(), sections.end(), [](const Section& a, const Section& b) {
            return std::abs(a.areaMm2) < std::abs(b.areaMm2);
        });
        std::vector<Section> chosen;
        std::vector<std::uint64_t> labels;  // reduced: each has a highest digit of its own
        for (Section& section : sections) {
            std::uint64_t label = section.label;
            for (const std::uint64_t other : labels) label = std::min(label, label ^ other);
            section.box.widen(roomMm);
            const bool isClear =
                std::none_of(chosen.begin(), chosen.end(),
                             [&](const Section& other) { return other.box.overlaps(section.box); });
            if (label == 0 || !isClear) continue;
            labels.push_back(label);
            chosen.push_back(std::move(section));
        }
        return chosen;
    }

    /// Middle of the shortest loop that parts no piece. \pre there is a handle
    Vec3 place() const {
        Vec3 middle;
        const std::vector<PointId> loop = loopOf(generators_.front());
        for (const PointId v : loop) middle += input_.mesh.points[v];
        return 1 / static_cast<double>(loop.size()) * middle;
    }

private:
    const Vec3& at(std::size_t point) const { return input_.mesh.points[point]; }
    double lengthOf(EdgeId e) const { return norm(at(input_.edges[e].b) - at(input_.edges[e].a)); }
    PointId otherEnd(EdgeId e, PointId v) const {
        return input_.edges[e].a == v ? input_.edges[e].b : input_.edges[e].a;
    }

    /// Shortest ways from one point of each piece to the others.
    void growTree() {
        const std::size_t count = input_.mesh.points.size();
        atPoint_ = Buckets<EdgeId>(count, [&](const auto& give) {
            for (EdgeId e = 0; e < input_.edges.size(); ++e) {
                give(input_.edges[e].a, e);
                give(input_.edges[e].b, e);
            }
        });
        away_.assign(count, std::numeric_limits<double>::infinity());
        over_.assign(count, kNoEdge);
        std::vector<std::uint8_t> isDone(count);
        using Item = std::pair<double, PointId>;
        std::priority_queue<Item, std::vector<Item>, std::greater<>> front;
        for (PointId root = 0; root < count; ++root) {
            if (isDone[root] != 0) continue;
            away_[root] = 0;
            front.emplace(0.0, root);
            while (!front.empty()) {
                const PointId v = front.top().second;
                front.pop();
                if (std::exchange(isDone[v], std::uint8_t{1}) != 0) continue;
                order_.push_back(v);
                for (const EdgeId e : atPoint_.of(v)) {
                    const PointId w = otherEnd(e, v);
                    const double far = away_[v] + lengthOf(e);
                    if (far >= away_[w]) continue;
                    away_[w] = far;
                    over_[w] = e;
                    front.emplace(far, w);
                }
            }
        }
    }

    /// The edges that neither the tree has, nor one of triangles across the longest others: each
    /// closes a loop of a basis. Labels of edges tell how often a loop across them passes each.
    void findGenerators() {
        std::vector<std::pair<double, EdgeId>> others;
        for (EdgeId e = 0; e < input_.edges.size(); ++e) {
            const PointId a = input_.edges[e].a, b = input_.edges[e].b;
            if (over_[a] == e || over_[b] == e) continue;
            others.emplace_back(-away_[a] - away_[b] - lengthOf(e), e);
        }
        std::sort(others.begin(), others.end());
        DisjointSets sides(std::ssize(input_.mesh.triangles));
        labels_.assign(input_.edges.size(), 0);
        std::vector<std::uint64_t> below(input_.mesh.points.size());
        for (const auto& other : others) {
            const MendInput::Edge& edge = input_.edges[other.second];
            if (sides.find(edge.triangles[0]) != sides.find(edge.triangles[1])) {
                sides.join(edge.triangles[0], edge.triangles[1]);
                continue;
            }
            generators_.push_back(other.second);
            const std::uint64_t label = mixed(generators_.size());
            labels_[other.second] = label;
            below[edge.a] ^= label;
            below[edge.b] ^= label;
        }
        std::reverse(generators_.begin(), generators_.end());
        for (auto v = order_.rbegin(); v != order_.rend(); ++v) {
            if (over_[*v] == kNoEdge) continue;
            labels_[over_[*v]] = below[*v];
            below[otherEnd(over_[*v], *v)] ^= below[*v];
        }
    }

    /// Scatters numbers over 64 digits [Steele2014].
    static std::uint64_t mixed(std::uint64_t n) {
        n *= 0x9e3779b97f4a7c15;
        n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9;
        n = (n ^ n >> 27) * 0x94d049bb133111eb;
        return n ^ n >> 31;
    }

    std::vector<PointId> loopOf(EdgeId generator) const {
        std::vector<PointId> up{input_.edges[generator].a}, down{input_.edges[generator].b};
        while (up.back() != down.back()) {
            auto& path = away_[up.back()] >= away_[down.back()] ? up : down;
            path.push_back(otherEnd(over_[path.back()], path.back()));
        }
        up.insert(up.end(), down.rbegin() + 1, down.rend());
        return up;
    }

    /// The smallest section found across or along a loop.
    std::optional<Section> bestAt(EdgeId generator) const {
        const std::vector<PointId> loop = loopOf(generator);
        const std::size_t count = loop.size(), window = count / kAcross;
        std::optional<Section> best;
        const auto from = [&](PointId v, const Vec3& normal, const Vec3& point) {
            for (const EdgeId e : atPoint_.of(v)) {
                if (!isPassed(e, normal, dot(normal, point))) continue;
                return improve(best, normal, dot(normal, point), e);
            }
        };
        Vec3 turn, middle;
        for (std::size_t i = 0; i < count; ++i) {
            turn += 0.5 * cross(at(loop[i]) - at(loop[0]), at(loop[(i + 1) % count]) - at(loop[0]));
            middle += 1 / static_cast<double>(count) * at(loop[i]);
        }
        const std::size_t samples = std::min(count, kAcross);
        for (std::size_t n = 0; n < samples; ++n) {
            const std::size_t i = n * count / samples, next = (i + 1) % count;
            const Vec3 along = normalized(at(loop[(next + window) % count]) -
                                          at(loop[(i + count - window) % count]));
            from(loop[i], along, 0.5 * (at(loop[i]) + at(loop[next])));
            const Vec3 flat = normalized(turn);
            for (const double side : {-kAside, kAside}) {
                from(loop[i], flat, middle + side * std::sqrt(norm(turn)) * flat);
            }
        }
        if (best) refine(*best);
        return best;
    }

    /// Turns and shifts the plane while the disc gets smaller.
    void refine(Section& best) const {
        for (double step = 0.4; step > 0.01; step /= 2) {
            const Vec3 middle = best.box.middle(), normal = best.normal;
            const double shift = step * std::sqrt(std::abs(best.areaMm2));
            Vec3 axis;
            axis[std::abs(normal.x) < 0.6 ? 0 : 1] = 1;
            const Vec3 u = step * normalized(cross(axis, normal)), v = cross(normal, u);
            std::optional<Section> better = best;
            const auto tryPlane = [&](const Vec3& turned, double offset) {
                if (const auto e = passedNear(best.edges.front(), turned, offset)) {
                    improve(better, turned, offset, *e);
                }
            };
            for (const Vec3& way : {u, -u, v, -v}) {
                const Vec3 turned = normalized(normal + way);
                tryPlane(turned, dot(turned, middle));
            }
            for (const double by : {-shift, shift}) tryPlane(normal, best.offset + by);
            best = std::move(*better);
        }
    }

    /// The first edge that a plane passes on the steepest way to it.
    std::optional<EdgeId> passedNear(EdgeId from, const Vec3& normal, double offset) const {
        const auto distance = [&](PointId v) { return std::abs(dot(normal, at(v)) - offset); };
        for (PointId v = input_.edges[from].a;;) {
            PointId next = v;
            for (const EdgeId e : atPoint_.of(v)) {
                if (isPassed(e, normal, offset)) return e;
                if (distance(otherEnd(e, v)) < distance(next)) next = otherEnd(e, v);
            }
            if (next == v) return std::nullopt;
            v = next;
        }
    }

    bool isPassed(EdgeId e, const Vec3& normal, double offset) const {
        return (dot(normal, at(input_.edges[e].a)) > offset) !=
               (dot(normal, at(input_.edges[e].b)) > offset);
    }

    /// Takes the section from an edge that the plane passes where it is better.
    void improve(std::optional<Section>& best, const Vec3& normal, double offset,
                 EdgeId start) const {
        const std::optional<Section> section = trace(normal, offset, start);
        if (!section || section->label == 0) return;
        if (best && std::abs(section->areaMm2) >= std::abs(best->areaMm2)) return;
        if (isClear(*section)) best = section;
    }

    Vec3 crossing(EdgeId e, const Vec3& normal, double offset) const {
        const Vec3 &a = at(input_.edges[e].a), &b = at(input_.edges[e].b);
        return pointAlong(a, b, dot(normal, a) - offset, dot(normal, b) - offset);
    }

    /// Goes round with the solid on the left. \return none where the loop is too long
    std::optional<Section> trace(const Vec3& normal, double offset, EdgeId start) const {
        Section section{normal, offset, {}, 0, 0, BoundingBox::empty()};
        const auto isAbove = [&](PointId v) { return dot(normal, at(v)) > offset; };
        Vec3 first, last, sum;
        EdgeId e = start;
        do {
            const Vec3 p = crossing(e, normal, offset);
            if (section.edges.empty()) first = last = p;
            sum += cross(last - first, p - first);
            last = p;
            section.box.add(p);
            section.edges.push_back(e);
            section.label ^= labels_[e];
            if (section.edges.size() > kMostEdges) return std::nullopt;
            const auto& edges =
                input_.edgeOf[input_.edges[e].triangles[isAbove(input_.edges[e].a) ? 0 : 1]];
            e = *std::find_if(edges.begin(), edges.end(), [&](EdgeId next) {
                return next != e && isAbove(input_.edges[next].a) != isAbove(input_.edges[next].b);
            });
        } while (e != start);
        section.areaMm2 = 0.5 * dot(normal, sum);
        return section;
    }

    /// No other part of the surface passes the disc.
    bool isClear(const Section& section) const {
        std::vector<std::int64_t> own;
        std::vector<Point2> ring;
        int axis = 0;  // that the disc is seen along
        for (int a = 1; a < 3; ++a) {
            if (std::abs(section.normal[a]) > std::abs(section.normal[axis])) axis = a;
        }
        const auto seen = [&](const Vec3& p) {
            return Point2{p[axisAfter(axis, 1)], p[axisAfter(axis, 2)]};
        };
        for (const EdgeId e : section.edges) {
            own.insert(own.end(), input_.edges[e].triangles.begin(),
                       input_.edges[e].triangles.end());
            ring.push_back(seen(crossing(e, section.normal, section.offset)));
        }
        std::sort(own.begin(), own.end());
        const auto isWithin = [&](const Point2& p) {
            bool isOdd = false;
            for (std::size_t n = 0; n < ring.size(); ++n) {
                const Point2 &a = ring[n], &b = ring[(n + 1) % ring.size()];
                if ((a[1] > p[1]) == (b[1] > p[1])) continue;
                if (p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) isOdd = !isOdd;
            }
            return isOdd;
        };
        bool isFree = true;
        tree_.forEachOverlap(section.box, [&](std::int64_t t) {
            if (!isFree || std::binary_search(own.begin(), own.end(), t)) return;
            for (const EdgeId e : input_.edgeOf[t]) {
                if (!isPassed(e, section.normal, section.offset)) continue;
                isFree = !isWithin(seen(crossing(e, section.normal, section.offset)));
                return;
            }
        });
        return isFree;
    }

    static constexpr EdgeId kNoEdge = ~EdgeId{0};
    static constexpr std::size_t kAcross = 16;       ///< planes across a loop
    static constexpr double kAside = 0.02;           ///< of the loop's size: planes along it
    static constexpr std::size_t kMostEdges = 4000;  ///< of a section

    const MendInput& input_;
    AabbTree tree_;
    Buckets<EdgeId> atPoint_;
    std::vector<double> away_;  ///< of a point, along the tree
    std::vector<EdgeId> over_;  ///< the edge towards the tree's root
    std::vector<PointId> order_;
    std::vector<std::uint64_t> labels_;  ///< of edges
    std::vector<EdgeId> generators_;     ///< the shortest loop first
};

/// A section, and half the width of the band that goes.
struct Cut {
    Section section;
    double halfMm = 0;
    bool hasFailed = false;
};

/// The surface with bands cut out and their rims closed.
class BandCutter {
public:
    BandCutter(const MendInput& input, const MendAssembly& before, std::vector<Cut>& cuts)
        : input_(input), cuts_(cuts), result_(before), bandOf_(input.mesh.triangles.size(), -1) {}

    /// \return  every cut held what is promised; those that did not are marked
    /// \param gone  what went before; gets the bands
    bool run(double reachMm, std::vector<Corners>& gone, HandlesGone& proved,
             MendStatistics& statistics) {
        const std::size_t before = bandOf_.size();
        for (std::size_t n = 0; n < cuts_.size(); ++n) cutBand(n);
        if (hasFailed()) return false;
        closeRims();
        if (hasFailed()) return false;
        std::vector<std::uint8_t> isDropped(result_.source.size());
        for (std::size_t t = 0; t < before; ++t) isDropped[t] = bandOf_[t] >= 0 ? 1 : 0;
        dropTriangles(result_, isDropped);
        judgeNew();
        proveBands(reachMm, gone, proved);
        if (!hasFailed()) listPlaces(statistics);
        return !hasFailed();
    }
    MendAssembly take() { return std::move(result_); }

private:
    bool hasFailed() const {
        return std::any_of(cuts_.begin(), cuts_.end(), [](const Cut& c) { return c.hasFailed; });
    }

    void add(const Triangle& t, MendSource source, std::int64_t origin, std::size_t rim) {
        result_.mesh.triangles.push_back(t);
        result_.source.push_back(source);
        result_.cell.push_back(0);
        result_.origin.push_back(origin);
        rimOfTriangle_.push_back(rim);
    }

    void cutBand(std::size_t n) {
        Cut& cut = cuts_[n];
        const std::array<double, 2> planes{cut.section.offset - cut.halfMm,
                                           cut.section.offset + cut.halfMm};
        const auto heightOf = [&](VertexId v) {
            return dot(cut.section.normal, input_.mesh.points[v]);
        };
        std::vector<std::int64_t> band;
        const auto reach = [&](std::int64_t t) {
            if (bandOf_[t] == static_cast<std::int64_t>(n)) return;
            if (bandOf_[t] >= 0) cut.hasFailed = true;
            bandOf_[t] = static_cast<std::int64_t>(n);
            band.push_back(t);
        };
        for (const EdgeId e : cut.section.edges) {
            for (const std::int64_t t : input_.edges[e].triangles) reach(t);
        }
        std::map<std::pair<EdgeId, int>, VertexId> pointOn;
        const auto pointAt = [&](EdgeId e, int side) {
            const auto [found, isNew] = pointOn.try_emplace({e, side}, VertexId{0});
            if (!isNew) return found->second;
            const VertexId a = input_.edges[e].a, b = input_.edges[e].b;
            found->second = std::ssize(result_.mesh.points);
            result_.mesh.points.push_back(pointAlong(input_.mesh.points[a], input_.mesh.points[b],
                                                     heightOf(a) - planes[side],
                                                     heightOf(b) - planes[side]));
            rimOfPoint_.push_back(2 * n + static_cast<std::size_t>(side));
            return found->second;
        };
        for (std::size_t next = 0; next < band.size() && !cut.hasFailed; ++next) {
            const std::int64_t t = band[next];
            const Triangle& corners = input_.mesh.triangles[t];
            std::array<double, 3> height{};
            for (int i = 0; i < 3; ++i) {
                height[i] = heightOf(corners[i]);
                if (height[i] == planes[0] || height[i] == planes[1]) cut.hasFailed = true;
            }
            for (int side = 0; side < 2; ++side) {
                const auto isKept = [&](int i) {
                    return side == 0 ? height[i] < planes[0] : height[i] > planes[1];
                };
                std::vector<VertexId> ring;
                for (int i = 0; i < 3; ++i) {
                    const int j = (i + 1) % 3;
                    if (isKept(i)) ring.push_back(corners[i]);
                    if (isKept(i) != isKept(j)) {
                        ring.push_back(pointAt(input_.edgeOf[t][i], side));
                    }
                }
                for (std::size_t i = 2; i < ring.size(); ++i) {
                    add({ring[0], ring[i - 1], ring[i]}, MendSource::Cut, result_.origin[t],
                        2 * n + static_cast<std::size_t>(side));
                }
            }
            for (int i = 0; i < 3; ++i) {
                const auto [low, high] = std::minmax(height[i], height[(i + 1) % 3]);
                if (high < planes[0] || low > planes[1]) continue;
                for (const std::int64_t other : input_.edges[input_.edgeOf[t][i]].triangles) {
                    reach(other);
                }
            }
        }
    }

    /// Each cut must have left two rims.
    void closeRims() {
        MendInput open;
        open.mesh.points = result_.mesh.points;
        const std::size_t before = bandOf_.size();
        for (std::size_t t = 0; t < result_.source.size(); ++t) {
            if (t < before && bandOf_[t] >= 0) continue;
            open.mesh.triangles.push_back(result_.mesh.triangles[t]);
        }
        findEdges(open);
        addCaps(open, CapKind::FlatAlone);
        std::vector<int> caps(2 * cuts_.size());
        const auto firstPoint = std::ssize(input_.mesh.points);
        for (std::int64_t t = open.firstCap(); t < std::ssize(open.mesh.triangles); ++t) {
            const std::int64_t n = t - open.firstCap();
            const std::int64_t point = open.mesh.triangles[t][0] - firstPoint;
            if (point < 0) continue;  // a rim of no cut
            const std::size_t rim = rimOfPoint_[point];
            if (n == 0 || open.capOf[n] != open.capOf[n - 1]) ++caps[rim];
            add(open.mesh.triangles[t], MendSource::Filled, -1, rim);
        }
        for (std::size_t rim = 0; rim < caps.size(); ++rim) {
            if (caps[rim] != 1) cuts_[rim / 2].hasFailed = true;
        }
    }

    /// New triangles come last. \return  the rim of one; none of others
    std::optional<std::size_t> rimOf(std::int64_t t) const {
        const std::int64_t n =
            t - (std::ssize(result_.mesh.triangles) - std::ssize(rimOfTriangle_));
        if (n < 0) return std::nullopt;
        return rimOfTriangle_[n];
    }

    void judgeNew() {
        const auto fail = [&](std::int64_t t) {
            if (const auto rim = rimOf(t)) cuts_[*rim / 2].hasFailed = true;
        };
        const auto triangles = inShort(result_.mesh);
        const CrossingPairs crossing = findCrossingPairs(
            {result_.mesh.points, triangles},
            [&](std::uint32_t a, std::uint32_t b) { return rimOf(a) || rimOf(b); });
        for (const auto& pair : crossing.pairs) {
            for (const std::uint32_t t : pair) fail(t);
        }
        for (const std::uint32_t t : crossing.undecided) fail(t);
        for (std::int64_t t = 0; t < std::ssize(result_.mesh.triangles); ++t) {
            if (rimOf(t) && isDegenerate(result_.mesh, result_.mesh.triangles[t])) fail(t);
        }
    }

    void proveBands(double reachMm, std::vector<Corners>& gone, HandlesGone& proved) {
        const NearnessProof proof(result_.mesh, reachMm);
        const auto isNear = [&](const Corners& piece) {
            NearnessProof::Result found;
            proof.prove(piece, reachMm / 8, found);
            proved.movedMm = std::max(proved.movedMm, found.upperMm);
            return found.others.empty();
        };
        const bool areNear = std::all_of(gone.begin(), gone.end(), isNear);
        for (Cut& cut : cuts_) cut.hasFailed = cut.hasFailed || !areNear;
        for (std::int64_t t = 0; t < std::ssize(bandOf_); ++t) {
            if (bandOf_[t] < 0) continue;
            gone.push_back(cornersOf(input_.mesh, t));
            if (!isNear(gone.back())) cuts_[bandOf_[t]].hasFailed = true;
        }
    }

    /// One cap of each cut is its disc.
    void listPlaces(MendStatistics& statistics) const {
        for (const bool areCut : {true, false}) {
            std::vector<std::uint8_t> isDisc(result_.mesh.triangles.size());
            for (std::int64_t t = 0; t < std::ssize(isDisc); ++t) {
                const auto rim = rimOf(t);
                if (!rim || *rim % 2 != 0 || result_.source[t] != MendSource::Filled) continue;
                isDisc[t] = (cuts_[*rim / 2].section.areaMm2 > 0) == areCut ? 1 : 0;
            }
            auto& places = areCut ? statistics.cutHandles : statistics.filledHandles;
            for (const auto& place : connectedPlaces(result_.mesh, isDisc)) {
                places.push_back(place.first);
            }
        }
    }

    const MendInput& input_;
    std::vector<Cut>& cuts_;
    MendAssembly result_;
    std::vector<std::int64_t> bandOf_;        ///< of a triangle, its cut
    std::vector<std::size_t> rimOfPoint_;     ///< of new points: twice the cut, one more above it
    std::vector<std::size_t> rimOfTriangle_;  ///< of new triangles
};

std::int64_t genusOf(const TriangleMesh& mesh) {
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    return topology.isWatertight() ? topology.genus().value_or(-1) : -1;
}

/// Makes cuts, each as wide as it can be. \return  one was made
bool makeCuts(const MendInput& input, std::vector<Cut> cuts, double reachMm, MendAssembly& assembly,
              std::vector<Corners>& gone, HandlesGone& proved, MendStatistics& statistics) {
    constexpr double kNarrowest = 1.0 / 256;
    const std::int64_t genus = genusOf(assembly.mesh);
    while (!cuts.empty()) {
        MendStatistics listed = statistics;
        std::vector<Corners> goneThen = gone;
        HandlesGone provedThen;
        BandCutter cutter(input, assembly, cuts);
        if (cutter.run(reachMm, goneThen, provedThen, listed)) {
            MendAssembly made = cutter.take();
            const std::int64_t left = genusOf(made.mesh);
            if (left < 0 || left >= genus) return false;
            assembly = std::move(made);
            gone = std::move(goneThen);
            proved = provedThen;
            statistics = std::move(listed);
            return true;
        }
        for (Cut& cut : cuts) {
            if (std::exchange(cut.hasFailed, false)) cut.halfMm /= 2;
        }
        std::erase_if(cuts, [&](const Cut& cut) { return cut.halfMm < kNarrowest * reachMm; });
    }
    return false;
}

}  // namespace

HandlesGone removeHandles(MendAssembly& assembly, double reachMm, MendStatistics& statistics) {
    HandlesGone proved;
    std::vector<Corners> gone;
    while (genusOf(assembly.mesh) > 0) {
        const MendInput input = connected(assembly.mesh);
        const HandleSearch search(input);
        std::vector<Cut> cuts;
        for (Section& section : search.smallest(reachMm)) {
            cuts.push_back({std::move(section), 0.4 * reachMm, false});
        }
        if (!makeCuts(input, std::move(cuts), reachMm, assembly, gone, proved, statistics)) {
            proved.stuckMm = search.place();
            return proved;
        }
    }
    for (auto* places : {&statistics.cutHandles, &statistics.filledHandles}) {
        std::stable_sort(
            places->begin(), places->end(),
            [](const MendedPlace& a, const MendedPlace& b) { return a.spanMm > b.spanMm; });
    }
    return proved;
}

}  // namespace adaptiso::detail
