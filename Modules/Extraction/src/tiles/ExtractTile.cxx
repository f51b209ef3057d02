
#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptive/bricks/Bricks.h"
#include "lattice/LatticeSampler.h"
#include "repair/MeshRepair.h"
#include "tiles/TileGrid.h"

namespace adaptiso {
namespace detail {

BlockGrid tileGrid(const Index3& imageSize) {
    constexpr std::int64_t kMost = 26'000;  // blocks have numbers of 32 bits
    if (*std::max_element(imageSize.begin(), imageSize.end()) > kMost) {
        throw InvalidInput("the image has more than " + std::to_string(kMost) +
                           " voxels along an axis; take a coarser level, or crop it");
    }
    return BlockGrid::make(imageSize, kTileBlock, Border::Closed);
}

bool isCrossed(const LatticeSampler& sampler, const BlockGrid& grid, std::uint32_t block) {
    constexpr int kSamples = kTileBlock + 1;
    constexpr std::uint32_t kAll = (1u << kSamples) - 1;
    std::array<std::uint32_t, std::size_t{kSamples} * kSamples> rows;
    sampler.insideRows(grid.firstSample(block), kSamples, rows.data());
    std::uint32_t all = kAll, any = 0;
    for (const std::uint32_t row : rows) {
        all &= row;
        any |= row;
    }
    return any != 0 && all != kAll;
}

void requireTile(const VolumeView& window, const Index3& first, const ImageGeometry& geometry,
                 const TileCut& cut, const Index3& tile) {
    if (geometry.size != cut.imageSize()) {
        throw InvalidInput("extractTile: the cut is of another volume");
    }
    const IndexBox needed = cut.samplesOf(tile);
    for (int a = 0; a < 3; ++a) {
        if (first[a] > needed.first[a] || first[a] + window.geometry().size[a] < needed.end[a]) {
            throw InvalidInput("extractTile: the window does not hold the tile's samples");
        }
    }
}

}  // namespace detail

namespace {

using namespace detail;

/// A brick's surface, with what its neighbours need to find its vertices on walls.
struct BrickPiece {
    TriangleMesh mesh;
    struct WallVertex {
        std::uint64_t edge;
        VertexId vertex;
    };
    std::vector<WallVertex> walls;
};

class TileMesher {
public:
    TileMesher(const LatticeSampler& sampler, const BlockGrid& grid, const IndexBox& cells)
        : sampler_(sampler), grid_(grid) {
        listBricks(cells);
    }

    TriangleMesh run() {
        std::vector<BrickPiece> pieces(bricks_.size());
        struct Tools {
            BrickMesher mesher;
            FineSurface fine;
        };
        PerThread<Tools> tools([&] { return Tools{BrickMesher(sampler_, grid_, false), {}}; });
        parallelForPieces(std::ssize(bricks_), 1, [&](std::int64_t b, std::int64_t) {
            Brick brick = bricks_[b];
            findBlocks(brick);
            if (brick.blocks.empty()) return;
            Tools& mine = tools.local();
            mine.mesher.mesh(brick, mine.fine);
            pieces[b] = pieceOf(mine.fine);
        });
        return join(pieces);
    }

private:
    void listBricks(const IndexBox& cells) {
        const auto low = [&](std::int64_t cell) {
            return (cell + grid_.offset) / Brick::kSide * Brick::kSide;
        };
        for (std::int64_t z = low(cells.first[2]); z < cells.end[2] + grid_.offset;
             z += Brick::kSide)
            for (std::int64_t y = low(cells.first[1]); y < cells.end[1] + grid_.offset;
                 y += Brick::kSide)
                for (std::int64_t x = low(cells.first[0]); x < cells.end[0] + grid_.offset;
                     x += Brick::kSide)
                    bricks_.push_back({{x, y, z}, {}});
    }

    /// Those of the brick's blocks that the surface passes through.
    void findBlocks(Brick& brick) const {
        constexpr int kPerSide = Brick::kSide / kTileBlock;
        for (int n = 0; n < kPerSide * kPerSide * kPerSide; ++n) {
            const Index3 at{brick.low[0] / kTileBlock + n % kPerSide,
                            brick.low[1] / kTileBlock + n / kPerSide % kPerSide,
                            brick.low[2] / kTileBlock + n / (kPerSide * kPerSide)};
            if (at[0] >= grid_.blocks[0] || at[1] >= grid_.blocks[1] || at[2] >= grid_.blocks[2]) {
                continue;
            }
            const auto block = static_cast<std::uint32_t>(
                at[0] + grid_.blocks[0] * (at[1] + grid_.blocks[1] * at[2]));
            if (isCrossed(sampler_, grid_, block)) brick.blocks.push_back(block);
        }
        std::sort(brick.blocks.begin(), brick.blocks.end());
    }

    BrickPiece pieceOf(const FineSurface& fine) const {
        BrickPiece piece;
        TriangleMesh& mesh = piece.mesh;
        for (const FineVertex& v : fine.vertices) {
            const bool isMiddle = v.edge.axis() == 3;
            const Vec3 normal = isMiddle
                                    ? sampler_.normalAt(v.index)
                                    : sampler_.crossing(v.edge.latticeEdge(grid_.offset)).normal;
            if (v.isOnWall) piece.walls.push_back({v.edge.word, std::ssize(mesh.points)});
            mesh.points.push_back(v.index);
            mesh.normals.push_back(toNormal(normal));
        }
        for (const auto& [a, b, c] : fine.triangles) mesh.triangles.push_back({a, b, c});
        return piece;
    }

    /// Vertices are numbered in the order in which bricks first have them.
    static TriangleMesh join(std::vector<BrickPiece>& pieces) {
        TriangleMesh whole;
        std::size_t points = 0, triangles = 0;
        for (const BrickPiece& piece : pieces) {
            points += piece.mesh.points.size();
            triangles += piece.mesh.triangles.size();
        }
        whole.points.reserve(points);
        whole.normals.reserve(points);
        whole.triangles.reserve(triangles);
        std::unordered_map<std::uint64_t, VertexId> onWall;
        std::vector<VertexId> number;
        for (BrickPiece& piece : pieces) {
            constexpr VertexId kNew = -1;
            number.assign(piece.mesh.points.size(), kNew);
            for (const auto& [edge, vertex] : piece.walls) {
                const auto known = onWall.find(edge);
                if (known != onWall.end()) number[vertex] = known->second;
            }
            for (std::size_t v = 0; v < number.size(); ++v) {
                if (number[v] != kNew) continue;
                number[v] = std::ssize(whole.points);
                whole.points.push_back(piece.mesh.points[v]);
                whole.normals.push_back(piece.mesh.normals[v]);
            }
            for (const auto& [edge, vertex] : piece.walls) onWall.emplace(edge, number[vertex]);
            for (const auto& [a, b, c] : piece.mesh.triangles) {
                whole.triangles.push_back({number[a], number[b], number[c]});
            }
            piece = {};
        }
        return whole;
    }

    const LatticeSampler& sampler_;
    const BlockGrid& grid_;
    std::vector<Brick> bricks_;
};

/// Gives vertices where the volume has no gradient the normal of the triangles around.
void completeNormalsOf(TriangleMesh& mesh, const ImageGeometry& geometry) {
    const Normal none = toNormal({});
    if (std::find(mesh.normals.begin(), mesh.normals.end(), none) == mesh.normals.end()) return;
    TriangleMesh physical = physicalMesh(mesh, geometry);
    completeNormals(physical);
    mesh.normals = std::move(physical.normals);
}

}  // namespace

TriangleMesh extractTile(const VolumeView& window, const Index3& first,
                         const ImageGeometry& geometry, double isovalue, const TileCut& cut,
                         const Index3& tile) {
    requireTile(window, first, geometry, cut, tile);
    const auto sampler = LatticeSampler::makeOfWindow(window, first, geometry, isovalue);
    TriangleMesh mesh = TileMesher(*sampler, tileGrid(geometry.size), cut.cellsOf(tile)).run();
    completeNormalsOf(mesh, geometry);
    return mesh;
}

TriangleMesh physicalMesh(const TriangleMesh& mesh, const ImageGeometry& geometry) {
    TriangleMesh physical = mesh;
    for (Vec3& p : physical.points) p = geometry.toPhysical(p);
    if (geometry.isMirrored()) {
        for (Triangle& t : physical.triangles) std::swap(t[1], t[2]);
    }
    return physical;
}

}  // namespace adaptiso
