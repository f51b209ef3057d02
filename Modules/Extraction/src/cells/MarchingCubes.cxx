#include "cells/MarchingCubes.h"

#include <algorithm>
#include <span>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/detail/BoxCases.h"
#include "cells/CellTriangles.h"
#include "lattice/ActiveBlocks.h"
#include "lattice/Bits.h"
#include "lattice/BlockSamples.h"
#include "lattice/LatticeSampler.h"
#include "repair/MeshRepair.h"

namespace adaptiso::detail {
namespace {

template <int N>
class MarchingCubes {
public:
    MarchingCubes(const LatticeSampler& sampler, const ActiveBlocks& active)
        : sampler_(sampler), active_(active), blocks_(active.count()) {}

    void countAll() {
        parallelForPieces(active_.count(), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t b = begin; b < end; ++b) countBlock(b);
        });
        for (Block& block : blocks_) {
            const std::int64_t triangles = block.firstTriangle;
            block.firstTriangle = triangleCount_;
            block.firstVertex = vertexCount_;
            triangleCount_ += triangles;
            for (const auto& bits : block.vertices) vertexCount_ += bits.count();
            vertexCount_ += block.middles;
            middleCount_ += block.middles;
        }
    }

    /// Triangles, were no loop filled from its middle: that takes two more.
    std::int64_t tableTriangles() const { return triangleCount_ - 2 * middleCount_; }

    void fill(TriangleMesh& mesh, const ImageGeometry& geometry) const {
        const bool isMirrored = geometry.isMirrored();
        mesh.points.resize(vertexCount_);
        mesh.normals.resize(vertexCount_);
        mesh.triangles.resize(triangleCount_);
        parallelForPieces(active_.count(), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t b = begin; b < end; ++b) fillBlock(b, mesh, isMirrored, geometry);
        });
    }

private:
    static constexpr std::int64_t kPiece = 64;

    struct Block {
        std::array<Bits<N * N * N>, 3> vertices{};  ///< crossed lattice edges, by axis
        std::int64_t firstVertex = 0;
        std::int64_t firstTriangle = 0;  ///< while counting, the number of triangles
        std::int64_t middles = 0;        ///< vertices in the middle of loops; after the others
    };

    static int cellOf(int x, int y, int z) { return x + N * (y + N * z); }
    Index3 firstSample(std::int64_t b) const {
        return active_.grid().firstSample(active_.block(b));
    }

    /// Cells of a block in the volume, along each axis, and lattice positions whose edges bound
    /// one.
    struct Extent {
        std::array<int, 3> cells, positions;
    };
    Extent extentOf(const Index3& first) const {
        Extent extent{{N, N, N}, {N, N, N}};
        const BlockGrid& grid = active_.grid();
        if (grid.border == Border::Closed) return extent;
        const bool hasCells = *std::min_element(grid.volumeSize.begin(), grid.volumeSize.end()) > 1;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t left = hasCells ? grid.volumeSize[axis] - 1 - first[axis] : -1;
            extent.cells[axis] = static_cast<int>(std::clamp<std::int64_t>(left, 0, N));
            extent.positions[axis] = static_cast<int>(std::clamp<std::int64_t>(left + 1, 0, N));
        }
        return extent;
    }

    template <class F>
    void forEachCell(const BlockSamples<N>& samples, const Extent& extent, const F& f) const {
        for (int z = 0; z < extent.cells[2]; ++z) {
            for (int y = 0; y < extent.cells[1]; ++y) {
                for (int x = 0; x < extent.cells[0]; ++x) {
                    const Box cell{x, y, z, 1};
                    const unsigned corners = samples.corners(cell);
                    if (corners == 0 || corners == 255) continue;
                    unsigned joined = 0;
                    const unsigned ambiguous = cases_.ambiguousFaces(corners);
                    for (int face = 0; ambiguous >> face != 0; ++face) {
                        if ((ambiguous >> face & 1u) == 0) continue;
                        std::array<int, 3> corner{x, y, z};
                        corner[face / 2] += face & 1;
                        joined |= static_cast<unsigned>(samples.insideJoins(corner, face / 2, 1))
                                  << face;
                    }
                    f(cell, cases_[cases_.caseIndex(corners, joined)], ambiguous != 0);
                }
            }
        }
    }

    void countBlock(std::int64_t b) {
        Block& block = blocks_[b];
        const Extent extent = extentOf(firstSample(b));
        const BlockSamples<N> samples(sampler_, firstSample(b));
        for (int z = 0; z < extent.positions[2]; ++z) {
            for (int y = 0; y < extent.positions[1]; ++y) {
                const std::uint32_t row = samples.row(y, z);
                const std::array<std::uint32_t, 3> crossed{
                    row ^ (row >> 1), row ^ samples.row(y + 1, z), row ^ samples.row(y, z + 1)};
                for (int axis = 0; axis < 3; ++axis) {
                    for (int x = 0; x < extent.positions[0]; ++x) {
                        if (crossed[axis] >> x & 1u) block.vertices[axis].set(cellOf(x, y, z));
                    }
                }
            }
        }
        forEachCell(samples, extent, [&](const Box& cell, const BoxCase& boxCase, bool mayCross) {
            if (mayCross) {
                const CellCrossings crossings = crossingsOf(samples, cell, boxCase);
                if (needsFans(boxCase, crossings)) {
                    forEachFan(
                        boxCase, crossings, [&](int, int, int) { ++block.firstTriangle; },
                        [&](std::span<const std::uint8_t> loop, const Vec3&) {
                            block.firstTriangle += static_cast<std::int64_t>(loop.size());
                            ++block.middles;
                        });
                    return;
                }
            }
            block.firstTriangle += boxCase.triangleCount;
        });
    }

    CellCrossings crossingsOf(const BlockSamples<N>& samples, const Box& cell,
                              const BoxCase& boxCase) const {
        return crossingsOfCell(sampler_, samples.sampleAt({cell.x, cell.y, cell.z}), boxCase);
    }

    /// \return the number of the block's next vertex
    std::int64_t fillVertices(std::int64_t b, TriangleMesh& mesh) const {
        const Block& block = blocks_[b];
        const Index3 first = firstSample(b);
        std::int64_t v = block.firstVertex;
        for (int axis = 0; axis < 3; ++axis) {
            block.vertices[axis].forEach([&](int cell) {
                const Crossing crossing = sampler_.crossing(
                    {{first[0] + cell % N, first[1] + cell / N % N, first[2] + cell / (N * N)},
                     axis});
                mesh.points[v] = crossing.pointMm;
                mesh.normals[v++] = toNormal(crossing.normal);
            });
        }
        return v;
    }

    void fillBlock(std::int64_t b, TriangleMesh& mesh, bool isMirrored,
                   const ImageGeometry& geometry) const {
        const Block& block = blocks_[b];
        const Index3 first = firstSample(b);
        std::int64_t v = fillVertices(b, mesh);
        std::array<std::int64_t, 8> owner;
        for (int high = 0; high < 8; ++high) {
            owner[high] =
                high == 0 ? b : active_.neighbour(b, {high & 1, high >> 1 & 1, high >> 2});
        }
        const auto vertexOn = [&](const Box& cell, int edge) {
            const int corner = lowCorner(edge), axis = edgeAxis(edge);
            std::array<int, 3> p{cell.x + (corner & 1), cell.y + (corner >> 1 & 1),
                                 cell.z + (corner >> 2)};
            int high = 0;
            for (int a = 0; a < 3; ++a) {
                if (p[a] == N) {
                    p[a] = 0;
                    high |= 1 << a;
                }
            }
            const Block& home = blocks_[owner[high]];
            std::int64_t number = home.firstVertex;
            for (int a = 0; a < axis; ++a) number += home.vertices[a].count();
            return number + home.vertices[axis].rank(cellOf(p[0], p[1], p[2]));
        };
        const BlockSamples<N> samples(sampler_, first);
        std::int64_t t = block.firstTriangle;
        forEachCell(
            samples, extentOf(first), [&](const Box& cell, const BoxCase& boxCase, bool mayCross) {
                std::array<VertexId, kBoxEdges> vertex;
                vertex.fill(-1);
                const auto at = [&](int edge) {
                    if (vertex[edge] < 0) vertex[edge] = vertexOn(cell, edge);
                    return vertex[edge];
                };
                const auto add = [&](VertexId p, VertexId q, VertexId r) {
                    mesh.triangles[t++] = isMirrored ? Triangle{p, r, q} : Triangle{p, q, r};
                };
                const auto addAt = [&](int e, int f, int g) { add(at(e), at(f), at(g)); };
                if (mayCross) {
                    const CellCrossings crossings = crossingsOf(samples, cell, boxCase);
                    if (needsFans(boxCase, crossings)) {
                        forEachFan(boxCase, crossings, addAt,
                                   [&](std::span<const std::uint8_t> loop, const Vec3& middle) {
                                       mesh.points[v] = geometry.toPhysical(middle);
                                       mesh.normals[v] = toNormal(sampler_.normalAt(middle));
                                       for (std::size_t i = 0; i < loop.size(); ++i) {
                                           add(v, at(loop[i]), at(loop[(i + 1) % loop.size()]));
                                       }
                                       ++v;
                                   });
                        return;
                    }
                }
                for (int i = 0; i < boxCase.triangleCount; ++i) {
                    const auto& [e, f, g] = boxCase.triangle[i];
                    addAt(e, f, g);
                }
            });
    }

    const LatticeSampler& sampler_;
    const ActiveBlocks& active_;
    const BoxCases& cases_ = BoxCases::instance();
    std::vector<Block> blocks_;
    std::int64_t vertexCount_ = 0;
    std::int64_t triangleCount_ = 0;
    std::int64_t middleCount_ = 0;
};

template <int N>
Extraction march(const LatticeSampler& sampler, const ActiveBlocks& active,
                 const ImageGeometry& geometry) {
    Extraction result;
    MarchingCubes<N> method(sampler, active);
    method.countAll();
    method.fill(result.mesh, geometry);
    result.statistics.marchingCubesTriangles = method.tableTriangles();
    return result;
}

}  // namespace

Extraction extractMarchingCubes(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                                const ExtractionOptions& options) {
    const ActiveBlocks active(grid, std::move(query.blocks));
    const auto sampler = LatticeSampler::make(volume, options.isovalue, grid.border);
    const ImageGeometry& geometry = volume.geometry();
    if (options.progress) options.progress("extract", 0);
    Extraction result;
    switch (grid.blockSize) {
        case 2:
            result = march<2>(*sampler, active, geometry);
            break;
        case 4:
            result = march<4>(*sampler, active, geometry);
            break;
        case 8:
            result = march<8>(*sampler, active, geometry);
            break;
        default:
            result = march<16>(*sampler, active, geometry);
            break;
    }
    completeNormals(result.mesh);
    result.statistics.blocksTotal = grid.blockCount();
    result.statistics.blocksActive = active.count();
    result.statistics.indexNodesVisited = query.nodesVisited;
    if (options.progress) options.progress("extract", 1);
    return result;
}

}  // namespace adaptiso::detail
