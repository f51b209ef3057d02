#include "ErrorBound.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "PieceBound.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<Corners, 4> quarter(const Corners& t) {
    const Vec3 a = 0.5 * (t[0] + t[1]), b = 0.5 * (t[1] + t[2]), c = 0.5 * (t[2] + t[0]);
    return {{{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}}};
}

TriangleMesh meshOf(const SimplifiedSurface& surface) {
    TriangleMesh mesh;
    mesh.points = surface.points;
    mesh.triangles.reserve(surface.triangles.size());
    for (const auto& t : surface.triangles) {
        mesh.triangles.push_back({static_cast<VertexId>(t[0]), static_cast<VertexId>(t[1]),
                                  static_cast<VertexId>(t[2])});
    }
    return mesh;
}

/// Triangles of the simplified surface by the bricks whose neighbourhood they reach into, and by
/// their places.
class Lookup {
public:
    Lookup(const SimplifiedSurface& surface, const Bricks& bricks, const MetricFrame& frame)
        : surface_(surface),
          bricks_(bricks),
          frame_(frame),
          mesh_(meshOf(surface)),
          tree_(mesh_),
          ofBrick_(bricks.count()) {
        for (std::uint64_t t = 0; t < surface.triangles.size(); ++t) {
            forEachBrickNear(t, [&](std::int64_t b) { ofBrick_[b].push_back(t); });
        }
    }

    Corners cornersOf(std::uint64_t t) const {
        const auto& c = surface_.triangles[t];
        return {surface_.points[c[0]], surface_.points[c[1]], surface_.points[c[2]]};
    }
    /// Calls f(corners) for all triangles that may lie within a distance of a piece.
    template <class F>
    void forEachNear(const Corners& piece, double distanceMm, const F& f) const {
        CornerBox box = boxOf(piece);
        box.widen(distanceMm);
        tree_.forEachOverlap({box.low, box.high}, [&](std::int64_t t) { f(cornersOf(t)); });
    }
    std::span<const std::uint64_t> ofBrick(std::int64_t b) const { return ofBrick_[b]; }

    /// Lattice position (continuous) of a point of the metric frame.
    Vec3 latticeOf(const Vec3& p) const {
        const auto offset = static_cast<double>(bricks_.grid().offset);
        return frame_.toIndex(p) + Vec3{offset, offset, offset};
    }

    /// The brick that answers for a point: the one that it lies in, or else the first one that has
    /// it in its halo with room around; kNone where there is none.
    std::int64_t brickFor(const Vec3& lattice) const {
        Index3 place;
        for (int a = 0; a < 3; ++a) place[a] = floorOf(lattice[a] / Brick::kSide);
        const std::int64_t own = bricks_.at(place);
        if (own != Bricks::kNone) return own;
        std::int64_t best = Bricks::kNone;
        for (int n = 0; n < 27; ++n) {
            const std::int64_t other =
                bricks_.at({place[0] + n % 3 - 1, place[1] + n / 3 % 3 - 1, place[2] + n / 9 - 1});
            if (other == Bricks::kNone || !isNear(bricks_[other], lattice)) continue;
            if (best == Bricks::kNone || other < best) best = other;
        }
        return best;
    }

private:
    static constexpr double kRoom = BrickMesher::kHalo / 2.0;

    static std::int64_t floorOf(double x) { return static_cast<std::int64_t>(std::floor(x)); }

    static bool isNear(const Brick& brick, const Vec3& lattice) {
        for (int a = 0; a < 3; ++a) {
            const double p = lattice[a] - static_cast<double>(brick.low[a]);
            if (p < -kRoom || p > Brick::kSide + kRoom) return false;
        }
        return true;
    }

    template <class F>
    void forEachBrickNear(std::uint64_t t, const F& f) const {
        Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
        for (const std::uint64_t v : surface_.triangles[t]) {
            const Vec3 p = latticeOf(surface_.points[v]);
            for (int a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
        }
        Index3 first, last;
        for (int a = 0; a < 3; ++a) {
            first[a] = floorOf((low[a] - kRoom) / Brick::kSide);
            last[a] = floorOf((high[a] + kRoom) / Brick::kSide);
        }
        for (std::int64_t z = first[2]; z <= last[2]; ++z) {
            for (std::int64_t y = first[1]; y <= last[1]; ++y) {
                for (std::int64_t x = first[0]; x <= last[0]; ++x) {
                    const std::int64_t b = bricks_.at({x, y, z});
                    if (b != Bricks::kNone) f(b);
                }
            }
        }
    }

    const SimplifiedSurface& surface_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    TriangleMesh mesh_;
    AabbTree tree_;
    std::vector<std::vector<std::uint64_t>> ofBrick_;
};

/// The proof for one brick; keeps its working memory from brick to brick.
class BrickProof {
public:
    BrickProof(const SimplifiedSurface& surface, const Lookup& lookup,
               const LatticeSampler& sampler, const Bricks& bricks, const MetricFrame& frame,
               double enoughMm, double limitMm)
        : surface_(surface),
          lookup_(lookup),
          bricks_(bricks),
          frame_(frame),
          enoughMm_(enoughMm),
          limitMm_(limitMm),
          mesher_(sampler, bricks.grid()),
          cellAt_(std::size_t{kCells} * kCells * kCells) {}

    struct Result {
        double fromFineMm = 0, toFineMm = 0;
        std::vector<Vec3> beyondLimit;
        double provedArea = 0;  ///< of the simplified surface, mm2
    };

    Result prove(std::int64_t brick) {
        mesher_.meshWithHalo(bricks_, brick, fine_);
        points_.resize(fine_.vertices.size());
        for (std::size_t v = 0; v < points_.size(); ++v) {
            points_[v] = frame_.fromIndex(fine_.vertices[v].index);
        }
        Result result;
        fromFine_ = toFine_ = PieceBound(enoughMm_);
        worstFromFineMm_ = worstToFineMm_ = 0;
        beyondLimit_.clear();
        findStandIns(brick);
        for (std::size_t t = 0; t < fine_.ownTriangles; ++t) {
            proveFine(t);
        }
        brick_ = brick;
        low_ = bricks_[brick].low;
        rememberCells();
        for (const std::uint64_t t : lookup_.ofBrick(brick)) {
            const Corners corners = lookup_.cornersOf(t);
            const double area = norm(areaVector2(corners[0], corners[1], corners[2]));
            provePiece(corners, area, result);
        }
        forgetCells();
        result.fromFineMm = std::max(worstFromFineMm_, fromFine_.boundMm());
        result.toFineMm = std::max(worstToFineMm_, toFine_.boundMm());
        result.beyondLimit = beyondLimit_;
        return result;
    }

private:
    static constexpr int kCells = Brick::kSide + 2 * BrickMesher::kHalo;

    /// The triangle that stands for each of the brick's own vertices.
    void findStandIns(std::int64_t brick) {
        standIn_.resize(fine_.ownVertices);
        std::uint64_t within = surface_.firstSample[brick];
        const std::uint64_t firstOnWall = surface_.firstSample.back();
        for (std::size_t v = 0; v < fine_.ownVertices; ++v) {
            const FineVertex& vertex = fine_.vertices[v];
            if (!vertex.isOnWall) {
                standIn_[v] = surface_.sampleTriangle[within++];
                continue;
            }
            const auto at = std::lower_bound(surface_.wallEdges.begin(), surface_.wallEdges.end(),
                                             vertex.edge.word);
            standIn_[v] = surface_.sampleTriangle[firstOnWall + (at - surface_.wallEdges.begin())];
        }
    }

    /// What lies beyond the limit is noted, and does not loosen the bound of the rest.
    void prove(const Corners& piece, PieceBound& bound, double& worstMm) {
        const PieceBound before = bound.withoutNearby();
        bound.include(piece);
        if (bound.boundMm() <= limitMm_) return;
        worstMm = std::max(worstMm, bound.boundMm());
        beyondLimit_.push_back((1.0 / 3) * (piece[0] + piece[1] + piece[2]));
        bound = before;
    }

    void proveFine(std::size_t t) {
        const auto& v = fine_.triangles[t];
        const Corners piece{points_[v[0]], points_[v[1]], points_[v[2]]};
        fromFine_.nearby().clear();
        for (const std::uint32_t corner : v) {
            fromFine_.nearby().push_back(lookup_.cornersOf(standIn_[corner]));
            if (fromFine_.isWithin(piece, fromFine_.nearby().back())) return;
        }
        if (fromFine_.isWithin(piece)) return;
        // all that can be nearer than what the corners are known to be
        double reachMm = fromFine_.boundMm();
        for (const Vec3& corner : piece) {
            double nearest = kInfinity;
            for (const Corners& stand : fromFine_.nearby()) {
                nearest = std::min(nearest, squaredDistanceToTriangle(corner, stand));
            }
            reachMm = std::max(reachMm, std::sqrt(nearest));
        }
        fromFine_.nearby().clear();
        lookup_.forEachNear(piece, reachMm,
                            [&](const Corners& near) { fromFine_.nearby().push_back(near); });
        prove(piece, fromFine_, worstFromFineMm_);
    }

    std::size_t cellSlot(int x, int y, int z) const {
        constexpr int kHalo = BrickMesher::kHalo;
        return static_cast<std::size_t>(x + kHalo + kCells * (y + kHalo + kCells * (z + kHalo)));
    }
    void rememberCells() {
        for (std::uint32_t c = 0; c < fine_.cells.size(); ++c) {
            const auto& p = fine_.cells[c].position;
            cellAt_[cellSlot(p[0], p[1], p[2])] = c + 1;
        }
        fine_.cells.push_back({{0, 0, 0}, static_cast<std::uint32_t>(fine_.triangles.size())});
    }
    void forgetCells() {
        fine_.cells.pop_back();
        for (const auto& cell : fine_.cells) {
            cellAt_[cellSlot(cell.position[0], cell.position[1], cell.position[2])] = 0;
        }
    }

    /// Goes over the pieces of a triangle of the simplified surface that this brick answers for.
    /// \param area2  twice the piece's area
    void provePiece(const Corners& piece, double area2, Result& result) {
        std::array<Vec3, 3> lattice;
        Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
        for (int c = 0; c < 3; ++c) {
            lattice[c] = lookup_.latticeOf(piece[c]);
            for (int a = 0; a < 3; ++a) {
                lattice[c][a] -= static_cast<double>(low_[a]);
                low[a] = std::min(low[a], lattice[c][a]);
                high[a] = std::max(high[a], lattice[c][a]);
            }
        }
        constexpr double kRoom = BrickMesher::kHalo / 2.0;
        for (int a = 0; a < 3; ++a) {
            if (high[a] < -kRoom || low[a] > Brick::kSide + kRoom) return;
        }
        const double side = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
        if (side <= 1) {
            const Vec3 middle = (1.0 / 3) * (piece[0] + piece[1] + piece[2]);
            if (lookup_.brickFor(lookup_.latticeOf(middle)) != brick_) return;
            result.provedArea += 0.5 * area2;
            proveLeaf(piece, low, high);
            return;
        }
        for (const Corners& part : quarter(piece)) provePiece(part, area2 / 4, result);
    }

    void proveLeaf(const Corners& piece, const Vec3& low, const Vec3& high) {
        collectNear(low, high, 0.5);
        toFine_.nearby().clear();
        keepNearest(piece);
        for (const std::uint32_t t : near_) toFine_.nearby().push_back(fineCorners(t));
        if (!near_.empty() && toFine_.isWithin(piece, toFine_.nearby().front())) return;
        if (toFine_.isWithin(piece)) return;
        collectNear(low, high, 1.5);
        toFine_.nearby().clear();
        for (const std::uint32_t t : near_) toFine_.nearby().push_back(fineCorners(t));
        prove(piece, toFine_, worstToFineMm_);
    }

    /// The fine triangles in the cells up to `reach` around a box.
    void collectNear(const Vec3& low, const Vec3& high, double reach) {
        near_.clear();
        std::array<int, 3> first{}, last{};
        for (int a = 0; a < 3; ++a) {
            constexpr int kHalo = BrickMesher::kHalo;
            first[a] = std::max(-kHalo, static_cast<int>(std::floor(low[a] - reach)));
            last[a] =
                std::min(Brick::kSide + kHalo - 1, static_cast<int>(std::floor(high[a] + reach)));
        }
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    const std::uint32_t cell = cellAt_[cellSlot(x, y, z)];
                    if (cell == 0) continue;
                    for (std::uint32_t t = fine_.cells[cell - 1].firstTriangle;
                         t < fine_.cells[cell].firstTriangle; ++t) {
                        near_.push_back(t);
                    }
                }
            }
        }
    }

    Corners fineCorners(std::uint32_t t) const {
        const auto& v = fine_.triangles[t];
        return {points_[v[0]], points_[v[1]], points_[v[2]]};
    }

    /// Of the fine triangles near a piece, keeps the few whose middles are nearest: they mostly do.
    void keepNearest(const Corners& piece) {
        constexpr std::size_t kFew = 6;
        if (near_.size() <= kFew) return;
        const Vec3 middle = piece[0] + piece[1] + piece[2];
        ranked_.clear();
        for (const std::uint32_t t : near_) {
            const auto& v = fine_.triangles[t];
            ranked_.push_back(
                {squaredNorm(points_[v[0]] + points_[v[1]] + points_[v[2]] - middle), t});
        }
        std::partial_sort(ranked_.begin(), ranked_.begin() + kFew, ranked_.end());
        near_.resize(kFew);
        for (std::size_t i = 0; i < kFew; ++i) near_[i] = ranked_[i].second;
    }

    const SimplifiedSurface& surface_;
    const Lookup& lookup_;
    const Bricks& bricks_;
    const MetricFrame& frame_;
    double enoughMm_, limitMm_;
    PieceBound fromFine_, toFine_;
    BrickMesher mesher_;
    FineSurface fine_;
    std::vector<Vec3> points_;
    std::vector<std::uint64_t> standIn_;
    ZeroedTable cellAt_;  ///< number + 1
    std::vector<std::uint32_t> near_;
    std::vector<std::pair<double, std::uint32_t>> ranked_;
    double worstFromFineMm_ = 0, worstToFineMm_ = 0;
    std::vector<Vec3> beyondLimit_;
    std::int64_t brick_ = 0;
    Index3 low_{};
};

/// The largest distance of a sample to the triangle that stands for it: no bound can be less.
double largestSampleDistance(const SimplifiedSurface& surface, const Lookup& lookup) {
    constexpr std::int64_t kPiece = 1 << 14;
    const auto count = static_cast<std::int64_t>(surface.samples.size());
    std::vector<double> largest((count + kPiece - 1) / kPiece, 0);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t s = begin; s < end; ++s) {
            const auto& p = surface.samples[s];
            largest[begin / kPiece] =
                std::max(largest[begin / kPiece],
                         squaredDistanceToTriangle({p[0], p[1], p[2]},
                                                   lookup.cornersOf(surface.sampleTriangle[s])));
        }
    });
    double result = 0;
    for (const double d : largest) result = std::max(result, d);
    return std::sqrt(result);
}

}  // namespace

ErrorBound boundError(const SimplifiedSurface& surface, const LatticeSampler& sampler,
                      const Bricks& bricks, const MetricFrame& frame, double limitMm) {
    const Lookup lookup(surface, bricks, frame);
    // bounds are as tight as the largest sample's distance; below a hundredth of a voxel none cares
    const double enough = std::min(
        limitMm, std::max(largestSampleDistance(surface, lookup), 0.01 * frame.narrowestMm()));
    tbb::enumerable_thread_specific<BrickProof> proofs(
        [&] { return BrickProof(surface, lookup, sampler, bricks, frame, enough, limitMm); });
    std::vector<BrickProof::Result> results(bricks.count());
    parallelForPieces(bricks.count(), 1,
                      [&](std::int64_t b, std::int64_t) { results[b] = proofs.local().prove(b); });
    double area = 0, provedArea = 0;
    for (std::uint64_t t = 0; t < surface.triangles.size(); ++t) {
        const Corners c = lookup.cornersOf(t);
        area += 0.5 * norm(areaVector2(c[0], c[1], c[2]));
    }
    ErrorBound bound;
    for (const auto& result : results) {
        bound.fromFineMm = std::max(bound.fromFineMm, result.fromFineMm);
        bound.toFineMm = std::max(bound.toFineMm, result.toFineMm);
        bound.beyondLimit.insert(bound.beyondLimit.end(), result.beyondLimit.begin(),
                                 result.beyondLimit.end());
        provedArea += result.provedArea;
    }
    if (!(provedArea > (1 - 1e-9) * area)) bound.toFineMm = kInfinity;  // far from every brick
    return bound;
}

}  // namespace adaptiso::detail
