#include "MendAssembly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "PlanarFiller.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/Extraction/detail/BoxCases.h"
#include "adaptiso/Extraction/detail/CellFans.h"

namespace adaptiso::detail {
namespace {

using NodeId = VertexId;  // the input's points, then those where it is cut, then others

/// A point where an edge of the mesh leaves or enters the region.
struct EdgeCut {
    std::uint32_t edge;
    double along;  ///< from the edge's first point
    NodeId node;
    bool entersKept;  ///< on the way from the edge's first point

    bool isBefore(const EdgeCut& o) const {
        return std::tie(edge, along, node) < std::tie(o.edge, o.along, o.node);
    }
};

/// A side of the kept part of a triangle, kept on the left.
struct CutSide {
    std::uint32_t triangle;
    NodeId from, to;
    FaceTrace::Kind kind;
    std::uint64_t beyond;  ///< the kept cell beside it
};

class Assembler {
public:
    Assembler(const MendInput& input, const MendRegion& region, const WindingField& field,
              const MendLattice& lattice)
        : input_(input), region_(region), field_(field), lattice_(lattice) {}

    MendAssembly run() {
        result_.mesh.points = input_.mesh.points;
        collectCuts();
        markPoints();
        cutTriangles();
        if (result_.trouble.empty()) joinParts();
        if (result_.trouble.empty()) addKept();
        if (result_.trouble.empty()) fillCells();
        if (result_.trouble.empty()) result_.mesh = withoutUnusedPoints(std::move(result_.mesh));
        std::sort(result_.trouble.begin(), result_.trouble.end());
        return std::move(result_);
    }

private:
    /// What is kept of a triangle that the region cuts: one connected part.
    struct Part {
        std::uint32_t triangle = 0;
        std::vector<std::array<NodeId, 3>> triangles;
    };
    using Kind = FaceTrace::Kind;

    NodeId addPoint(const Vec3& p) {
        result_.mesh.points.push_back(p);
        return std::ssize(result_.mesh.points) - 1;
    }

    /// The point where the solid's border, or an inner part, passes a lattice edge.
    NodeId nodeOnLattice(std::uint64_t edge, double along) {
        const auto [found, isNew] = onLattice_.try_emplace(edge, NodeId{0});
        if (isNew) {
            const LatticePosition low = positionOf(edge >> 2);
            const int axis = axisOf(edge);
            Vec3 p = lattice_.at(low);
            p[axis] = std::clamp(p[axis] + along * lattice_.spacing(), p[axis],
                                 lattice_.coordinate(axis, low[axis] + 1));
            found->second = addPoint(p);
        }
        return found->second;
    }

    NodeId nodeOnFace(std::uint32_t edge, std::uint64_t face, bool isKeptAbove) {
        const auto [found, isNew] = onFace_.try_emplace({edge, face}, NodeId{0});
        if (!isNew) return found->second;
        const int axis = axisOf(face);
        const double plane = lattice_.coordinate(axis, positionOf(face >> 2)[axis]);
        const Vec3 a = result_.mesh.points[input_.edges[edge].a],
                   b = result_.mesh.points[input_.edges[edge].b];
        const double along = (plane - a[axis]) / (b[axis] - a[axis]);
        Vec3 p = a + along * (b - a);
        p[axis] = plane;
        found->second = addPoint(p);
        cuts_.push_back({edge, along, found->second, (a[axis] < plane) == isKeptAbove});
        return found->second;
    }

    NodeId nodeAt(const FacePiece& piece, const FaceNode& node, std::uint64_t face,
                  bool isKeptAbove) {
        if (!node.isOnLattice) {
            return nodeOnFace(static_cast<std::uint32_t>(node.number), face, isKeptAbove);
        }
        return nodeOnLattice(node.number, region_.planeAlong(node.number, piece.triangle));
    }

    void collectCuts() {
        cells_ = region_.cells();
        for (const std::uint64_t cell : cells_) {
            const LatticePosition at = positionOf(cell);
            for (int f = 0; f < kBoxFaces; ++f) {
                const LatticePosition beyond = neighbourOf(at, f);
                if (region_.contains(beyond)) continue;
                const std::uint64_t face = faceOfCell(at, f);
                const FaceTrace& trace = region_.traceOf(face);
                const bool isKeptAbove = f % 2 == 1;
                std::vector<NodeId> line;
                for (const FacePiece& piece : trace.pieces) {
                    NodeId from = nodeAt(piece, piece.start, face, isKeptAbove),
                           to = nodeAt(piece, piece.end, face, isKeptAbove);
                    if (line.empty()) line.push_back(from);
                    line.push_back(to);
                    if (!isKeptAbove) std::swap(from, to);
                    sides_.push_back({piece.triangle, from, to, trace.kind, keyOf(beyond)});
                }
                if (trace.kind == Kind::Border) lines_.emplace(face, std::move(line));
            }
        }
        std::sort(cuts_.begin(), cuts_.end(),
                  [](const EdgeCut& a, const EdgeCut& b) { return a.isBefore(b); });
        std::stable_sort(sides_.begin(), sides_.end(), [](const CutSide& a, const CutSide& b) {
            return a.triangle < b.triangle;
        });
    }

    void markPoints() {
        isInRegion_.resize(input_.mesh.points.size());
        for (const Triangle& t : input_.mesh.triangles) {
            for (const VertexId v : t) {
                isInRegion_[v] = region_.contains(lattice_.cellOf(input_.mesh.points[v])) ? 1 : 0;
            }
        }
    }

    std::span<const EdgeCut> cutsOf(std::uint32_t edge) const {
        const auto [first, last] =
            std::equal_range(cuts_.begin(), cuts_.end(), EdgeCut{edge, 0, 0, false},
                             [](const EdgeCut& a, const EdgeCut& b) { return a.edge < b.edge; });
        return {cuts_.data() + (first - cuts_.begin()), static_cast<std::size_t>(last - first)};
    }
    std::span<const CutSide> sidesOf(std::uint32_t triangle) const {
        const auto [first, last] = std::equal_range(
            sides_.begin(), sides_.end(), CutSide{triangle, 0, 0, Kind::None, 0},
            [](const CutSide& a, const CutSide& b) { return a.triangle < b.triangle; });
        return {sides_.data() + (first - sides_.begin()), static_cast<std::size_t>(last - first)};
    }

    /// The cells of a triangle go to the region.
    void giveUp(std::uint32_t triangle) {
        region_.forEachCellOf(cornersOf(input_.mesh, triangle), [&](const LatticePosition& cell) {
            if (!region_.contains(cell)) result_.trouble.push_back(keyOf(cell));
        });
        if (result_.trouble.empty()) {
            throw InternalError("mend: a triangle can't be cut along the lattice");
        }
    }

    /// Sides of the kept part along an edge of the mesh, in the triangle's direction. `interval`
    /// numbers them from the edge's first point. \return false where they do not alternate
    template <class Add>
    bool sidesAlong(std::uint32_t triangle, int i, const Add& add) const {
        const std::uint32_t e = input_.edgeOf[triangle][i];
        const MendInput::Edge& edge = input_.edges[e];
        const std::span<const EdgeCut> cuts = cutsOf(e);
        const bool isUp = input_.mesh.triangles[triangle][i] == edge.a;
        bool isKept = isInRegion_[edge.a] == 0;
        NodeId from = edge.a;
        for (std::size_t n = 0; n <= cuts.size(); ++n) {
            const NodeId to = n < cuts.size() ? cuts[n].node : NodeId{edge.b};
            if (isKept) add(isUp ? from : to, isUp ? to : from, e, n);
            if (n == cuts.size()) break;
            if (cuts[n].entersKept == isKept) return false;
            isKept = !isKept;
            from = to;
        }
        return isKept == (isInRegion_[edge.b] == 0);
    }

    void cutTriangles() {
        const auto count = static_cast<std::uint32_t>(input_.mesh.triangles.size());
        state_.assign(count, State::Kept);
        for (std::uint32_t t = 0; t < count; ++t) {
            const auto& edges = input_.edgeOf[t];
            const bool isCut = !sidesOf(t).empty() ||
                               std::any_of(edges.begin(), edges.end(),
                                           [&](std::uint32_t e) { return !cutsOf(e).empty(); });
            if (isCut) {
                state_[t] = State::Cut;
                if (!cutTriangle(t)) giveUp(t);
                continue;
            }
            int inRegion = 0;
            for (const VertexId v : input_.mesh.triangles[t]) inRegion += isInRegion_[v];
            if (inRegion == 3) state_[t] = State::Gone;
            if (inRegion == 1 || inRegion == 2) giveUp(t);
        }
    }

    bool cutTriangle(std::uint32_t t) {
        struct Side {
            NodeId from, to;
            std::uint64_t interval;  ///< of an edge of the mesh, or kWithin
            std::uint64_t beyond;    ///< the kept cell beside it, of one within the triangle
        };
        std::vector<Side> sides;
        for (const CutSide& side : sidesOf(t)) {
            sides.push_back({side.from, side.to, kWithin, side.beyond});
        }
        for (int i = 0; i < 3; ++i) {
            const bool areAlternating =
                sidesAlong(t, i, [&](NodeId from, NodeId to, std::uint32_t edge, std::size_t n) {
                    sides.push_back({from, to, std::uint64_t{edge} << 32 | n, 0});
                });
            if (!areAlternating) return false;
        }
        std::sort(sides.begin(), sides.end(),
                  [](const Side& a, const Side& b) { return a.from < b.from; });
        // where cells that are kept meet at a lattice edge alone, the side goes on in its own cell
        const auto after = [&](const Side& side) {
            auto next =
                std::lower_bound(sides.begin(), sides.end(), side.to,
                                 [](const Side& other, NodeId node) { return other.from < node; });
            const auto begin = next;
            while (next != sides.end() && next->from == side.to && next->beyond != side.beyond) {
                ++next;
            }
            if (next == sides.end() || next->from != side.to) next = begin;
            return static_cast<std::size_t>(next - sides.begin());
        };
        std::vector<std::uint8_t> isUsed(sides.size());
        std::vector<std::vector<std::size_t>> loops;
        for (std::size_t first = 0; first < sides.size(); ++first) {
            if (isUsed[first] != 0) continue;
            std::vector<std::size_t>& loop = loops.emplace_back();
            for (std::size_t n = first; isUsed[n] == 0;) {
                isUsed[n] = 1;
                loop.push_back(n);
                const std::size_t next = after(sides[n]);
                if (next == sides.size() || sides[next].from != sides[n].to) return false;
                n = next;
            }
            if (sides[loop.back()].to != sides[first].from || loop.size() < 3) return false;
        }
        std::vector<std::vector<NodeId>> corners;
        for (const auto& loop : loops) {
            auto& of = corners.emplace_back();
            for (const std::size_t n : loop) of.push_back(sides[n].from);
        }
        const auto groups = filler_.fill(result_.mesh.points, cornersOf(input_.mesh, t), corners);
        if (!groups) return false;
        std::map<NodeId, std::int64_t> partAt;
        for (const PlanarGroup& group : *groups) {
            const std::int64_t part = std::ssize(parts_);
            parts_.push_back({t, group.triangles});
            for (const std::size_t loop : group.loops) {
                for (const std::size_t n : loops[loop]) {
                    partAt.emplace(sides[n].from, part);
                    if (sides[n].interval == kWithin) continue;
                    intervals_.emplace_back(sides[n].interval, part);
                }
            }
        }
        for (const CutSide& side : sidesOf(t)) {
            kinds_.push_back({partAt.at(side.from), side.kind, side.beyond});
        }
        return true;
    }

    /// Parts and kept triangles hang together along edges of the mesh: either all are of the
    /// solid's border, or none.
    void joinParts() {
        const std::int64_t count = std::ssize(input_.mesh.triangles);
        DisjointSets sets(count + std::ssize(parts_));
        for (const MendInput::Edge& edge : input_.edges) {
            if (!edge.isSound) continue;
            const auto [a, b] = edge.triangles;
            if (state_[a] == State::Kept && state_[b] == State::Kept) sets.join(a, b);
        }
        // a cut triangle beside one that is not
        for (std::uint32_t t = 0; t < count; ++t) {
            if (state_[t] != State::Kept) continue;
            for (const std::uint32_t e : input_.edgeOf[t]) {
                const auto [a, b] = input_.edges[e].triangles;
                const bool isBesideCut =
                    input_.edges[e].isSound && (state_[a] == State::Cut || state_[b] == State::Cut);
                if (isBesideCut) intervals_.emplace_back(std::uint64_t{e} << 32, t - count);
            }
        }
        std::sort(intervals_.begin(), intervals_.end());
        for (std::size_t n = 1; n < intervals_.size(); ++n) {
            if (intervals_[n].first != intervals_[n - 1].first) continue;
            sets.join(count + intervals_[n].second, count + intervals_[n - 1].second);
        }
        const auto forEachThere = [&](const auto& visit) {
            for (std::int64_t t = 0; t < count; ++t) {
                if (state_[t] == State::Kept) visit(t, cornersOf(input_.mesh, t), t);
            }
            for (std::int64_t p = 0; p < std::ssize(parts_); ++p) {
                for (const auto& [a, b, c] : parts_[p].triangles) {
                    const auto& points = result_.mesh.points;
                    visit(count + p, Corners{points[a], points[b], points[c]},
                          std::int64_t{parts_[p].triangle});
                }
            }
        };
        // triangles evenly spread over the area of each set
        struct Sample {
            std::int64_t set, triangle;
            Vec3 point;
        };
        std::map<std::int64_t, std::pair<double, double>> areas;  // all, next sample at
        const auto areaOf = [](const Corners& c) {
            return 0.5 * norm(areaVector2(c[0], c[1], c[2]));
        };
        forEachThere([&](std::int64_t member, const Corners& c, std::int64_t) {
            areas[sets.find(member)].first += areaOf(c);
        });
        std::map<std::int64_t, double> passed;
        std::vector<Sample> samples;
        forEachThere([&](std::int64_t member, const Corners& c, std::int64_t t) {
            const std::int64_t set = sets.find(member);
            auto& [all, next] = areas[set];
            double& reached = passed[set];
            reached += areaOf(c);
            if (reached < next) return;
            samples.push_back({set, t, 1.0 / 3 * (c[0] + c[1] + c[2])});
            next = reached + all / kSamples;
        });
        std::vector<std::uint8_t> isOfBorder(samples.size());
        parallelForPieces(std::ssize(samples), 16, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) {
                // half a turn less in front, half a turn more behind
                const double winding = field_.at(samples[n].point, samples[n].triangle);
                isOfBorder[n] = winding >= 0 && winding < 1 ? 1 : 0;
            }
        });
        std::map<std::int64_t, std::int64_t> votes;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            votes[samples[n].set] += isOfBorder[n] != 0 ? 1 : -1;
        }
        isBorder_.assign(count + parts_.size(), 0);
        forEachThere([&](std::int64_t member, const Corners&, std::int64_t) {
            isBorder_[member] = votes[sets.find(member)] > 0 ? 1 : 0;
        });
        for (const KindOfPart& of : kinds_) {
            if ((of.kind == Kind::Border) == (isBorder_[count + of.part] != 0)) continue;
            result_.trouble.push_back(of.beyond);
        }
    }

    void addTriangle(const std::array<NodeId, 3>& t, MendSource source, std::uint64_t cell,
                     std::int64_t origin) {
        result_.mesh.triangles.push_back({t[0], t[1], t[2]});
        result_.source.push_back(source);
        result_.cell.push_back(cell);
        result_.origin.push_back(origin);
    }

    void addKept() {
        const auto& points = result_.mesh.points;
        const auto count = static_cast<std::uint32_t>(input_.mesh.triangles.size());
        std::size_t part = 0;
        for (std::uint32_t t = 0; t < count; ++t) {
            if (state_[t] == State::Kept) {
                if (isBorder_[t] != 0) {
                    addTriangle(input_.mesh.triangles[t], MendSource::Kept, 0, t);
                } else {
                    result_.inner.push_back(cornersOf(input_.mesh, t));
                    result_.innerOf.push_back(t);
                }
            }
            for (; part < parts_.size() && parts_[part].triangle == t; ++part) {
                for (const auto& [a, b, c] : parts_[part].triangles) {
                    if (isBorder_[count + part] != 0) {
                        addTriangle({a, b, c}, MendSource::Cut, 0, t);
                    } else {
                        result_.inner.push_back({points[a], points[b], points[c]});
                        result_.innerOf.push_back(t);
                    }
                }
            }
        }
    }

    unsigned cornersOfCell(const LatticePosition& cell) const {
        unsigned corners = 0;
        for (int c = 0; c < kBoxCorners; ++c) {
            corners |= static_cast<unsigned>(region_.isInside(cornerOfCell(cell, c))) << c;
        }
        return corners;
    }

    void placeCrossings() {
        std::vector<std::uint64_t> edges;
        for (const std::uint64_t cell : cells_) {
            const LatticePosition at = positionOf(cell);
            const unsigned corners = cornersOfCell(at);
            if (corners == 0 || corners == 255) continue;
            for (int e = 0; e < kBoxEdges; ++e) {
                if ((corners >> lowCorner(e) & 1) == (corners >> highCorner(e) & 1)) continue;
                if (!onLattice_.contains(edgeOfCell(at, e))) edges.push_back(edgeOfCell(at, e));
            }
        }
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        std::vector<double> along(edges.size());
        parallelForPieces(std::ssize(edges), 64, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t n = begin; n < end; ++n) along[n] = region_.crossingAlong(edges[n]);
        });
        for (std::size_t n = 0; n < edges.size(); ++n) nodeOnLattice(edges[n], along[n]);
    }

    static int faceBetween(int e, int f) {
        for (int face = 0; face < kBoxFaces; ++face) {
            bool hasFirst = false, hasSecond = false;
            for (int side = 0; side < 4; ++side) {
                hasFirst = hasFirst || faceEdge(face, side) == e;
                hasSecond = hasSecond || faceEdge(face, side) == f;
            }
            if (hasFirst && hasSecond) return face;
        }
        throw InternalError("mend: a loop leaves its cell");
    }

    void fillCells() {
        placeCrossings();
        for (const std::uint64_t cell : cells_) {
            const unsigned corners = cornersOfCell(positionOf(cell));
            if (corners != 0 && corners != 255) fillCell(cell, corners);
        }
    }

    void fillCell(std::uint64_t cell, unsigned corners) {
        const LatticePosition at = positionOf(cell);
        const BoxCases& cases = BoxCases::instance();
        const BoxCase& boxCase = cases[cases.caseIndex(corners, 0)];
        const MendSource source = region_.isTouched(at) ? MendSource::Moved : MendSource::Filled;
        const Vec3 origin = lattice_.at(at);
        std::array<NodeId, kBoxEdges> node{};
        CellCrossings crossings{};
        for (int i = 0; i < boxCase.crossedEdges; ++i) {
            const int e = boxCase.loopEdge[i];
            node[e] = onLattice_.at(edgeOfCell(at, e));
            crossings[e] = 1 / lattice_.spacing() * (result_.mesh.points[node[e]] - origin);
        }
        bool isPlain = true;
        std::vector<std::vector<NodeId>> loops;
        std::size_t first = 0;
        for (int l = 0; l < boxCase.loopCount; ++l) {
            auto& loop = loops.emplace_back();
            const std::size_t length = boxCase.loopLength[l];
            for (std::size_t i = 0; i < length; ++i) {
                const int e = boxCase.loopEdge[first + i],
                          next = boxCase.loopEdge[first + (i + 1) % length];
                loop.push_back(node[e]);
                const int f = faceBetween(e, next);
                if (region_.contains(neighbourOf(at, f))) continue;
                const auto found = lines_.find(faceOfCell(at, f));
                if (found == lines_.end()) throw InternalError("mend: a face without its line");
                std::vector<NodeId> line = found->second;
                if (line.front() != node[e]) std::reverse(line.begin(), line.end());
                if (line.front() != node[e] || line.back() != node[next]) {
                    throw InternalError("mend: a line ends elsewhere");
                }
                if (line.size() > 2) isPlain = false;
                loop.insert(loop.end(), line.begin() + 1, line.end() - 1);
            }
            first += length;
        }
        const auto add = [&](NodeId a, NodeId b, NodeId c) {
            addTriangle({a, b, c}, source, cell, -1);
        };
        if (isPlain && !needsFans(boxCase, crossings)) {
            for (int i = 0; i < boxCase.triangleCount; ++i) {
                const auto& [e, f, g] = boxCase.triangle[i];
                add(node[e], node[f], node[g]);
            }
            return;
        }
        for (const auto& loop : loops) {
            if (loop.size() == 3) {
                add(loop[0], loop[1], loop[2]);
                continue;
            }
            Vec3 sum;
            for (const NodeId n : loop) sum += result_.mesh.points[n] - origin;
            const NodeId middle = addPoint(origin + 1.0 / static_cast<double>(loop.size()) * sum);
            for (std::size_t i = 0; i < loop.size(); ++i) {
                add(middle, loop[i], loop[(i + 1) % loop.size()]);
            }
        }
    }

    enum class State : std::uint8_t { Kept, Cut, Gone };
    struct KindOfPart {
        std::int64_t part;
        Kind kind;
        std::uint64_t beyond;
    };
    static constexpr std::uint64_t kWithin = ~std::uint64_t{0};
    static constexpr int kSamples = 24;  ///< of a set of parts, some more

    const MendInput& input_;
    const MendRegion& region_;
    const WindingField& field_;
    const MendLattice& lattice_;
    MendAssembly result_;
    std::vector<std::uint64_t> cells_;
    std::unordered_map<std::uint64_t, NodeId> onLattice_;
    std::map<std::pair<std::uint32_t, std::uint64_t>, NodeId> onFace_;
    std::vector<EdgeCut> cuts_;
    std::vector<CutSide> sides_;
    /// On a face of the region, the points where the solid's border passes it.
    std::unordered_map<std::uint64_t, std::vector<NodeId>> lines_;
    std::vector<std::uint8_t> isInRegion_;  ///< of each point
    std::vector<State> state_;
    std::vector<Part> parts_;  ///< by triangle
    /// Stretches of edges of the mesh, and the parts at them; negative: a triangle less their
    /// count.
    std::vector<std::pair<std::uint64_t, std::int64_t>> intervals_;
    std::vector<KindOfPart> kinds_;
    std::vector<std::uint8_t> isBorder_;  ///< of triangles, then of parts
    PlanarFiller filler_;
};

}  // namespace

MendAssembly assemble(const MendInput& input, const MendRegion& region, const WindingField& field,
                      const MendLattice& lattice) {
    return Assembler(input, region, field, lattice).run();
}

void dropTriangles(MendAssembly& assembly, const std::vector<std::uint8_t>& isDropped) {
    std::size_t next = 0;
    for (std::size_t t = 0; t < isDropped.size(); ++t) {
        if (isDropped[t] != 0) continue;
        assembly.mesh.triangles[next] = assembly.mesh.triangles[t];
        assembly.source[next] = assembly.source[t];
        assembly.cell[next] = assembly.cell[t];
        assembly.origin[next] = assembly.origin[t];
        ++next;
    }
    assembly.mesh.triangles.resize(next);
    assembly.source.resize(next);
    assembly.cell.resize(next);
    assembly.origin.resize(next);
    assembly.mesh = withoutUnusedPoints(std::move(assembly.mesh));
}

}  // namespace adaptiso::detail
