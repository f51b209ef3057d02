#include "adaptive/bricks/Bricks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "adaptiso/Extraction/detail/BoxCases.h"
#include "adaptive/bricks/SheetTest.h"
#include "cells/CellTriangles.h"

namespace adaptiso::detail {
namespace {

constexpr int kMargin = 1;         ///< samples around a block that the sheet test looks at
constexpr int kLargestBlock = 16;  ///< cells a side
constexpr int kPositions = Brick::kSide + 1;
constexpr int kCellCentre = 3;  ///< in place of an edge's axis

/// \param p  lattice position relative to the brick
std::size_t edgeSlot(const std::array<int, 3>& p, int axis) {
    return 3 * static_cast<std::size_t>((p[2] * kPositions + p[1]) * kPositions + p[0]) +
           static_cast<std::size_t>(axis);
}

/// Relative to the brick, of an edge's first sample.
std::array<int, 3> positionOf(const EdgeKey& edge, const Brick& brick) {
    std::array<int, 3> p{};
    for (int a = 0; a < 3; ++a) p[a] = static_cast<int>(edge.position(a) - brick.low[a]);
    return p;
}

bool isCrossed(const LatticeEdge& edge, const LatticeSampler& sampler) {
    std::array<std::uint32_t, 4> rows{};
    sampler.insideRows(edge.sample, 2, rows.data());
    const std::array<std::uint32_t, 3> ends{rows[0] >> 1, rows[1], rows[2]};
    return ((rows[0] ^ ends[edge.axis]) & 1u) != 0;
}

/// The surface of a cell that needs fans.
template <class VertexOn>
void addFans(const BoxCase& boxCase, const CellCrossings& crossings, const VertexOn& vertexOn,
             FineSurface& surface) {
    const auto triangle = [&](int e, int f, int g) {
        surface.triangles.push_back({vertexOn(e), vertexOn(f), vertexOn(g)});
    };
    const auto fan = [&](std::span<const std::uint8_t> loop, const Vec3& middle) {
        std::array<std::uint32_t, kBoxEdges> ring{};
        for (std::size_t i = 0; i < loop.size(); ++i) ring[i] = vertexOn(loop[i]);
        const auto centre = static_cast<std::uint32_t>(surface.vertices.size());
        FineVertex vertex;
        vertex.index = middle;
        vertex.edge = EdgeKey::make({0, 0, 0}, kCellCentre);
        vertex.isSingleSheet = false;
        surface.vertices.push_back(vertex);
        ++surface.middles;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            surface.triangles.push_back({centre, ring[i], ring[(i + 1) % loop.size()]});
        }
    };
    forEachFan(boxCase, crossings, triangle, fan);
}

/// The surface of a cell: fans where those of the table would cross.
/// \param sample  the cell's lowest
template <class VertexOn>
void addTriangles(const LatticeSampler& sampler, const Index3& sample, const BoxCase& boxCase,
                  bool mayCross, const VertexOn& vertexOn, FineSurface& surface) {
    if (mayCross) {
        const CellCrossings crossings = crossingsOfCell(sampler, sample, boxCase);
        if (needsFans(boxCase, crossings)) {
            addFans(boxCase, crossings, vertexOn, surface);
            return;
        }
    }
    for (int i = 0; i < boxCase.triangleCount; ++i) {
        const auto& [e, f, g] = boxCase.triangle[i];
        surface.triangles.push_back({vertexOn(e), vertexOn(f), vertexOn(g)});
    }
}

}  // namespace

Bricks::Bricks(const BlockGrid& grid, const std::vector<std::uint32_t>& blocks) : grid_(grid) {
    const std::int64_t perSide = Brick::kSide / grid.blockSize;
    constexpr std::int64_t kNone = -1;
    Index3 places;
    for (int a = 0; a < 3; ++a) places[a] = (grid.blocks[a] + perSide - 1) / perSide;
    std::vector<std::int64_t> numberAt(static_cast<std::size_t>(places[0] * places[1] * places[2]),
                                       kNone);
    const auto placeOf = [&](std::int64_t b) {
        return Index3{b % grid.blocks[0] / perSide, b / grid.blocks[0] % grid.blocks[1] / perSide,
                      b / (grid.blocks[0] * grid.blocks[1]) / perSide};
    };
    const auto slotOf = [&](const Index3& p) {
        return p[0] + places[0] * (p[1] + places[1] * p[2]);
    };
    for (const std::uint32_t block : blocks) numberAt[slotOf(placeOf(block))] = 0;
    for (std::int64_t slot = 0; slot < std::ssize(numberAt); ++slot) {
        if (numberAt[slot] == kNone) continue;
        numberAt[slot] = count();
        Brick& brick = bricks_.emplace_back();
        brick.low = {slot % places[0] * Brick::kSide, slot / places[0] % places[1] * Brick::kSide,
                     slot / (places[0] * places[1]) * Brick::kSide};
    }
    for (const std::uint32_t block : blocks) {
        bricks_[numberAt[slotOf(placeOf(block))]].blocks.push_back(block);
    }
}

BrickMesher::BrickMesher(const LatticeSampler& sampler, const BlockGrid& grid, bool findsSheets)
    : sampler_(sampler),
      grid_(grid),
      findsSheets_(findsSheets),
      vertexOnEdge_(3 * std::size_t{kPositions} * kPositions * kPositions),
      rows_(std::size_t{kLargestBlock + 1 + 2 * kMargin} * (kLargestBlock + 1 + 2 * kMargin)) {}

void BrickMesher::mesh(const Brick& brick, FineSurface& surface) {
    for (const std::size_t slot : slots_) vertexOnEdge_[slot] = 0;
    slots_.clear();
    surface.vertices.clear();
    surface.triangles.clear();
    surface.cellsSeen = surface.cellsCrossed = surface.middles = 0;
    for (const std::uint32_t block : brick.blocks) {
        meshBlock(brick, block, surface);
    }
}

void BrickMesher::findGaps(const Brick& brick, FineSurface& surface) const {
    for (FineVertex& vertex : surface.vertices) {
        if (vertex.edge.axis() != kCellCentre) vertex.gap = gapOf(brick, surface, vertex);
    }
}

float BrickMesher::gapOf(const Brick& brick, const FineSurface& surface,
                         const FineVertex& vertex) const {
    const int axis = vertex.edge.axis();
    const double along = vertex.index[axis];
    const int step = along - std::floor(along) < 0.5 ? -1 : 1;
    std::array<int, 3> p = positionOf(vertex.edge, brick);
    p[axis] += step;
    double other = 0;
    if (p[axis] >= 0 && p[axis] < Brick::kSide) {
        const std::uint32_t number = vertexOnEdge_[edgeSlot(p, axis)];
        if (number == 0) return FineVertex::kNoGap;
        other = surface.vertices[number - 1].index[axis];
    } else {  // in the brick beside this one
        LatticeEdge edge = vertex.edge.latticeEdge(grid_.offset);
        edge.sample[axis] += step;
        if (!isCrossed(edge, sampler_)) return FineVertex::kNoGap;
        other = static_cast<double>(edge.sample[axis]) + sampler_.crossingAlong(edge);
    }
    return static_cast<float>(std::abs(other - along));
}

/// How many cells of a block lie in the volume, by axis.
std::array<int, 3> BrickMesher::cellsOf(std::uint32_t block) const {
    const int n = grid_.blockSize;
    std::array cells{n, n, n};
    if (grid_.border == Border::Closed) return cells;
    const Index3 first = grid_.firstSample(block);
    for (int a = 0; a < 3; ++a) {
        cells[a] =
            static_cast<int>(std::clamp<std::int64_t>(grid_.volumeSize[a] - 1 - first[a], 0, n));
    }
    return cells;
}

/// \param cell  relative to the brick
std::uint32_t BrickMesher::vertexOn(const Brick& brick, const std::array<int, 3>& cell, int edge,
                                    bool isSingle, FineSurface& surface) {
    const int corner = lowCorner(edge), axis = edgeAxis(edge);
    std::array<int, 3> p{};
    for (int a = 0; a < 3; ++a) p[a] = cell[a] + (corner >> a & 1);
    const std::size_t at = edgeSlot(p, axis);
    std::uint32_t& slot = vertexOnEdge_[at];
    if (slot == 0) {
        slots_.push_back(at);
        slot = static_cast<std::uint32_t>(surface.vertices.size() + 1);
        const Index3 lattice{brick.low[0] + p[0], brick.low[1] + p[1], brick.low[2] + p[2]};
        FineVertex vertex;
        vertex.edge = EdgeKey::make(lattice, axis);
        const LatticeEdge onEdge = vertex.edge.latticeEdge(grid_.offset);
        for (int a = 0; a < 3; ++a) vertex.index[a] = static_cast<double>(onEdge.sample[a]);
        vertex.index[axis] += sampler_.crossingAlong(onEdge);
        for (int a = 0; a < 3; ++a) {
            if (a != axis && (p[a] == 0 || p[a] == Brick::kSide)) vertex.isOnWall = true;
        }
        surface.vertices.push_back(vertex);
    }
    if (!isSingle) surface.vertices[slot - 1].isSingleSheet = false;
    return slot - 1;
}

/// Which faces of a cell that are ambiguous join what is inside, by bits.
unsigned BrickMesher::joinedFaces(const Index3& sample, unsigned ambiguous) const {
    unsigned joined = 0;
    for (int face = 0; ambiguous >> face != 0; ++face) {
        if ((ambiguous >> face & 1u) == 0) continue;
        Index3 low = sample;
        low[face / 2] += face & 1;
        joined |= static_cast<unsigned>(sampler_.insideJoins(low, face / 2)) << face;
    }
    return joined;
}

void BrickMesher::meshBlock(const Brick& brick, std::uint32_t block, FineSurface& surface) {
    const BoxCases& cases = BoxCases::instance();
    const int count = grid_.blockSize + 1 + 2 * kMargin;
    const Index3 first = grid_.firstSample(block);
    sampler_.insideRows({first[0] - kMargin, first[1] - kMargin, first[2] - kMargin}, count,
                        rows_.data());
    std::array<int, 3> inBrick{};
    for (int a = 0; a < 3; ++a) {
        inBrick[a] = static_cast<int>(first[a] + grid_.offset - brick.low[a]);
    }

    const std::array<int, 3> cells = cellsOf(block);
    surface.cellsSeen += std::int64_t{cells[0]} * cells[1] * cells[2];
    const std::uint32_t cellsInRow = (1u << cells[0]) - 1;
    for (int z = 0; z < cells[2]; ++z) {
        for (int y = 0; y < cells[1]; ++y) {
            const auto row = [&](int dy, int dz) {
                return rows_[static_cast<std::size_t>(z + dz) * count + y + dy];
            };
            const std::uint32_t all = row(1, 1) & row(2, 1) & row(1, 2) & row(2, 2);
            const std::uint32_t any = row(1, 1) | row(2, 1) | row(1, 2) | row(2, 2);
            std::uint32_t crossed = ((any | any >> 1) & ~(all & all >> 1)) >> kMargin;
            crossed &= cellsInRow;
            for (; crossed != 0; crossed &= crossed - 1) {
                const int x = std::countr_zero(crossed);
                const auto window = [&] {
                    std::uint64_t inside = 0;
                    for (int dz = 0; dz < 4; ++dz) {
                        for (int dy = 0; dy < 4; ++dy) {
                            inside |= static_cast<std::uint64_t>(row(dy, dz) >> x & 15u)
                                      << (4 * (dy + 4 * dz));
                        }
                    }
                    return inside;
                };
                const auto pair = [&](int dy, int dz) { return row(dy, dz) >> (x + 1) & 3u; };
                const unsigned corners =
                    pair(1, 1) | pair(2, 1) << 2 | pair(1, 2) << 4 | pair(2, 2) << 6;
                const Index3 sample{first[0] + x, first[1] + y, first[2] + z};
                const unsigned ambiguous = cases.ambiguousFaces(corners);
                const BoxCase& boxCase =
                    cases[cases.caseIndex(corners, joinedFaces(sample, ambiguous))];
                const bool isSingle = findsSheets_ && isSingleSheet(window());
                ++surface.cellsCrossed;
                const auto at = [&](int edge) {
                    return vertexOn(brick, {inBrick[0] + x, inBrick[1] + y, inBrick[2] + z}, edge,
                                    isSingle, surface);
                };
                addTriangles(sampler_, sample, boxCase, ambiguous != 0, at, surface);
            }
        }
    }
}

}  // namespace adaptiso::detail
