#include <algorithm>
#include <array>
#include <cmath>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/full/VolumeSurface.h"
#include "tiles/TileGrid.h"

namespace adaptiso {
namespace {

using namespace detail;

/// The lattice of a tile as one of its own: indices begin at `shift`.
class ShiftedSampler final : public LatticeSampler {
public:
    ShiftedSampler(const LatticeSampler& whole, const Index3& shift, const BoundingBox& tile)
        : whole_(whole), shift_(shift), tile_(tile) {}

    void insideRows(const Index3& first, int count, std::uint32_t* rows) const override {
        whole_.insideRows(moved(first), count, rows);
    }
    bool insideJoins(const Index3& corner, int normal) const override {
        return whole_.insideJoins(moved(corner), normal);
    }
    double crossingAlong(const LatticeEdge& edge) const override {
        return whole_.crossingAlong(moved(edge));
    }
    Crossing crossing(const LatticeEdge& edge) const override {
        return whole_.crossing(moved(edge));
    }
    Crossing midpoint(const LatticeEdge& edge) const override {
        return whole_.midpoint(moved(edge));
    }
    /// In the tile: beyond its walls the samples may not be there.
    Vec3 normalAt(const Vec3& index) const override {
        constexpr double kInside = 1e-9;
        Vec3 place;
        for (int a = 0; a < 3; ++a) {
            place[a] = std::clamp(index[a] + static_cast<double>(shift_[a]), tile_.minimum[a],
                                  tile_.maximum[a] - kInside);
        }
        return whole_.normalAt(place);
    }

private:
    Index3 moved(const Index3& p) const {
        return {p[0] + shift_[0], p[1] + shift_[1], p[2] + shift_[2]};
    }
    LatticeEdge moved(const LatticeEdge& edge) const { return {moved(edge.sample), edge.axis}; }

    const LatticeSampler& whole_;
    Index3 shift_;
    BoundingBox tile_;
};

/// A tile as a volume of its own: its lattice begins with its first cell, so that neither numbers
/// of blocks nor single precision are used up by where it lies.
class TileSimplifier {
public:
    TileSimplifier(const LatticeSampler& sampler, const ImageGeometry& geometry, const TileCut& cut,
                   const Index3& tile)
        : whole_(sampler), shift_(shiftOf(cut, tile)), sampler_(sampler, shift_, cut.boxOf(tile)) {
        const Index3 tiles = cut.tiles();
        const IndexBox cells = cut.cellsOf(tile);
        geometry_ = geometry;
        geometry_.originMm = {};
        grid_.blockSize = kTileBlock;
        grid_.offset = kTileBlock;
        for (int a = 0; a < 3; ++a) {
            geometry_.size[a] = grid_.volumeSize[a] = cells.end[a] - shift_[a];
            grid_.blocks[a] = (geometry_.size[a] - 1 + grid_.offset) / kTileBlock + 1;
            hasWall_[a] = {tile[a] > 0, tile[a] + 1 < tiles[a]};
            box_.minimum[a] = static_cast<double>(cells.first[a] - shift_[a]);
            box_.maximum[a] = static_cast<double>(cells.end[a] - shift_[a]);
        }
    }

    /// \throws InternalError  nothing could be proved
    SimplifiedPart run(double maxErrorMm, bool leavesNoise) const {
        const Bricks bricks(grid_, crossedBlocks());
        if (bricks.count() == 0) return {};
        VolumeSurface full(geometry_, sampler_, bricks);
        full.stayIn(movingBox(), boxWithin(box_, geometry_));
        AdaptiveOptions aims;
        aims.maxErrorMm = maxErrorMm;
        aims.leavesNoise = leavesNoise;
        AdaptiveResult made = simplifyWithin(full, aims, {});
        SimplifiedPart part;
        part.errorBoundMm = made.errorBoundMm;
        part.mesh = std::move(made.mesh);
        const Mat3 toIndex = inverse(geometry_.indexToPhysical);
        for (std::size_t v = 0; v < part.mesh.points.size(); ++v) {
            placeInWhole(toIndex * part.mesh.points[v], part.mesh.points[v], part.mesh.normals[v]);
        }
        if (geometry_.isMirrored()) {
            for (Triangle& t : part.mesh.triangles) std::swap(t[1], t[2]);
        }
        return part;
    }

private:
    static Index3 shiftOf(const TileCut& cut, const Index3& tile) {
        return {tile[0] * cut.side(), tile[1] * cut.side(), tile[2] * cut.side()};
    }

    std::vector<std::uint32_t> crossedBlocks() const {
        std::vector<std::uint32_t> blocks;
        for (std::uint32_t b = 0; b < static_cast<std::uint32_t>(grid_.blockCount()); ++b) {
            if (isCrossed(sampler_, grid_, b)) blocks.push_back(b);
        }
        return blocks;
    }

    /// All but the outermost cells at walls that other tiles have too.
    BoundingBox movingBox() const {
        constexpr double kKept = 1 + 1e-9, kBeyond = 2;
        BoundingBox moving;
        for (int a = 0; a < 3; ++a) {
            moving.minimum[a] = box_.minimum[a] + (hasWall_[a][0] ? kKept : -kBeyond);
            moving.maximum[a] = box_.maximum[a] + (hasWall_[a][1] ? -kKept : kBeyond);
        }
        return moving;
    }

    bool isOnWall(const Vec3& index, int axis) const {
        constexpr double kNear = 1e-6;  // new vertices keep farther away, and so do others
        return (hasWall_[axis][0] && std::abs(index[axis] - box_.minimum[axis]) < kNear) ||
               (hasWall_[axis][1] && std::abs(index[axis] - box_.maximum[axis]) < kNear);
    }

    /// A vertex on a wall gets the bits that the other tile's has: they follow from the samples.
    void placeInWhole(const Vec3& index, Vec3& point, Normal& normal) const {
        for (int a = 0; a < 3; ++a) point[a] = index[a] + static_cast<double>(shift_[a]);
        if (!isOnWall(index, 0) && !isOnWall(index, 1) && !isOnWall(index, 2)) return;
        const LatticeEdge edge = edgeAt(point);
        for (int a = 0; a < 3; ++a) point[a] = static_cast<double>(edge.sample[a]);
        point[edge.axis] += whole_.crossingAlong(edge);
        const Normal known = toNormal(whole_.crossing(edge).normal);
        if (!(known == toNormal({}))) normal = known;
    }

    /// The lattice edge that a vertex of full resolution lies on.
    static LatticeEdge edgeAt(const Vec3& place) {
        LatticeEdge edge{{}, 0};
        double farthest = -1;
        for (int a = 0; a < 3; ++a) {
            const double away = std::abs(place[a] - std::round(place[a]));
            if (away > farthest) edge.axis = a;
            farthest = std::max(farthest, away);
        }
        for (int a = 0; a < 3; ++a) {
            const double along = a == edge.axis ? std::floor(place[a]) : std::round(place[a]);
            edge.sample[a] = static_cast<std::int64_t>(along);
        }
        return edge;
    }

    const LatticeSampler& whole_;
    Index3 shift_;
    ShiftedSampler sampler_;
    ImageGeometry geometry_;  ///< of the tile's own indices, about its first
    BlockGrid grid_;
    BoundingBox box_;  ///< the tile's own indices
    std::array<std::array<bool, 2>, 3> hasWall_{};
};

}  // namespace

SimplifiedPart extractSimplifiedTile(const VolumeView& window, const Index3& first,
                                     const ImageGeometry& geometry, double isovalue,
                                     const TileCut& cut, const Index3& tile, double maxErrorMm,
                                     bool leavesNoise) {
    requireTile(window, first, geometry, cut, tile);
    if (!canSimplifyInBoxes(geometry)) {
        throw InvalidInput("extractSimplifiedTile: the volume's axes are not at right angles");
    }
    const auto sampler = LatticeSampler::makeOfWindow(window, first, geometry, isovalue);
    try {
        return TileSimplifier(*sampler, geometry, cut, tile).run(maxErrorMm, leavesNoise);
    } catch (const InternalError&) {  // nothing could be proved
        SimplifiedPart whole;
        whole.mesh = extractTile(window, first, geometry, isovalue, cut, tile);
        whole.isUnchanged = true;
        return whole;
    }
}

}  // namespace adaptiso
