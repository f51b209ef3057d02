// Seed propagation from an extrema graph [Itoh1995] beside the kd-tree: what each looks at to find
// the cells that a surface goes through.
//
//   peerSeeds VOLUME --iso V      prints one JSON object
//
// The graph's nodes are the local minima and maxima (a plateau counts once, by its first voxel),
// its arcs straight walks of cells from one to the next. A surface that is closed holds an extremum
// and leaves one out, so an arc meets it; one that is not meets the border, whose cells are looked
// at too. From the cells that are met the surface is followed over shared faces.
// Departures: nodes are joined in the order of a Morton curve, which makes one path of them, where
// the paper looks for near neighbours; the arcs' cells are looked at one after the other, where the
// paper sorts those of the border by their range.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../RunBenchmark.h"
#include "PeerFiles.h"
#include "Relatives/SampleGrid.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

class ExtremaGraph {
public:
    explicit ExtremaGraph(const SampleGrid& grid) : grid_(grid) {
        findExtrema();
        std::sort(extrema_.begin(), extrema_.end(),
                  [](const Index3& a, const Index3& b) { return mortonOf(a) < mortonOf(b); });
        for (std::size_t n = 1; n < extrema_.size(); ++n) walk(extrema_[n - 1], extrema_[n]);
        std::sort(arcCells_.begin(), arcCells_.end());
        arcCells_.erase(std::unique(arcCells_.begin(), arcCells_.end()), arcCells_.end());
        const Index3 cells = grid_.cells();
        for (std::int64_t k = 0; k < cells[2]; ++k) {
            for (std::int64_t j = 0; j < cells[1]; ++j) {
                const bool isFace = j == 0 || j + 1 == cells[1] || k == 0 || k + 1 == cells[2];
                for (std::int64_t i = 0; i < cells[0];
                     i += isFace ? 1 : std::max<std::int64_t>(cells[0] - 1, 1)) {
                    borderCells_.push_back(cell(i, j, k));
                }
            }
        }
    }

    /// The cells that the surface goes through.
    std::vector<std::int64_t> propagate(double isovalue) {
        std::vector<bool> isSeen(static_cast<std::size_t>(grid_.geometry().voxelCount()));
        std::vector<std::int64_t> found;
        const auto look = [&](std::int64_t n) {
            if (isSeen[static_cast<std::size_t>(n)]) return;
            isSeen[static_cast<std::size_t>(n)] = true;
            ++visited;
            const Index3 at = placeOf(n);
            if (grid_.isActive(at[0], at[1], at[2], isovalue)) found.push_back(n);
        };
        for (const std::int64_t n : arcCells_) look(n);
        for (const std::int64_t n : borderCells_) look(n);
        searched = visited;
        seeds = std::ssize(found);
        const Index3 cells = grid_.cells();
        for (std::size_t n = 0; n < found.size(); ++n) {
            const Index3 at = placeOf(found[n]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                for (const std::int64_t d : {-1, 1}) {
                    Index3 to = at;
                    to[axis] += d;
                    if (to[axis] < 0 || to[axis] >= cells[axis]) continue;
                    if (crosses(at, axis, d, isovalue)) look(cell(to[0], to[1], to[2]));
                }
            }
        }
        return found;
    }

    std::int64_t extrema() const { return std::ssize(extrema_); }
    std::int64_t visited = 0;   ///< cells looked at
    std::int64_t searched = 0;  ///< of them, for seeds
    std::int64_t seeds = 0;

private:
    static std::uint64_t mortonOf(const Index3& p) {
        std::uint64_t code = 0;
        for (int bit = 0; bit < 21; ++bit) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                code |= static_cast<std::uint64_t>(p[axis] >> bit & 1) << (3 * bit + int(axis));
            }
        }
        return code;
    }
    std::int64_t cell(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return grid_.number(i, j, k);
    }
    Index3 placeOf(std::int64_t n) const {
        const Index3& size = grid_.size();
        return {n % size[0], n / size[0] % size[1], n / size[0] / size[1]};
    }

    /// The surface goes through the face towards a neighbour.
    bool crosses(const Index3& at, std::size_t axis, std::int64_t d, double isovalue) const {
        Index3 p = at;
        p[axis] += d > 0 ? 1 : 0;
        int inside = 0;
        for (int n = 0; n < 4; ++n) {
            Index3 q = p;
            q[(axis + 1) % 3] += n & 1;
            q[(axis + 2) % 3] += n >> 1;
            inside += grid_.at(q[0], q[1], q[2]) >= isovalue;
        }
        return inside > 0 && inside < 4;
    }

    /// Plateaus are grown; one is an extremum when all around it is lower, or all higher.
    void findExtrema() {
        const Index3& size = grid_.size();
        std::vector<bool> isSeen(static_cast<std::size_t>(grid_.geometry().voxelCount()));
        std::vector<std::int64_t> plateau;
        for (std::int64_t n = 0; n < grid_.geometry().voxelCount(); ++n) {
            if (isSeen[static_cast<std::size_t>(n)]) continue;
            const Index3 first = placeOf(n);
            const float value = grid_.at(first[0], first[1], first[2]);
            bool hasLower = false, hasHigher = false;
            plateau.assign(1, n);
            isSeen[static_cast<std::size_t>(n)] = true;
            for (std::size_t at = 0; at < plateau.size(); ++at) {
                const Index3 p = placeOf(plateau[at]);
                for (std::int64_t k = std::max<std::int64_t>(p[2] - 1, 0);
                     k <= std::min(p[2] + 1, size[2] - 1); ++k) {
                    for (std::int64_t j = std::max<std::int64_t>(p[1] - 1, 0);
                         j <= std::min(p[1] + 1, size[1] - 1); ++j) {
                        for (std::int64_t i = std::max<std::int64_t>(p[0] - 1, 0);
                             i <= std::min(p[0] + 1, size[0] - 1); ++i) {
                            const float other = grid_.at(i, j, k);
                            hasLower = hasLower || other < value;
                            hasHigher = hasHigher || other > value;
                            const std::int64_t to = grid_.number(i, j, k);
                            if (other != value || isSeen[static_cast<std::size_t>(to)]) continue;
                            isSeen[static_cast<std::size_t>(to)] = true;
                            plateau.push_back(to);
                        }
                    }
                }
            }
            if (hasLower != hasHigher) extrema_.push_back(first);
        }
    }

    /// Cells that the straight line from one sample to another runs through or along.
    void walk(const Index3& from, const Index3& to) {
        std::int64_t steps = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            steps = std::max(steps, 2 * std::abs(to[axis] - from[axis]));
        }
        Index3 before = from;
        for (std::int64_t step = 0; step <= steps; ++step) {
            Index3 at;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double part = static_cast<double>(step) / static_cast<double>(steps);
                at[axis] = std::llround(static_cast<double>(from[axis]) +
                                        part * static_cast<double>(to[axis] - from[axis]));
            }
            // every cell that holds both samples, so that a change between them is met
            Index3 low;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::clamp<std::int64_t>(std::min(at[axis], before[axis]), 0,
                                                     grid_.cells()[axis] - 1);
            }
            arcCells_.push_back(cell(low[0], low[1], low[2]));
            before = at;
        }
    }

    const SampleGrid& grid_;
    std::vector<Index3> extrema_;
    std::vector<std::int64_t> arcCells_, borderCells_;
};

nlohmann::ordered_json measure(const std::string& file, double isovalue) {
    const Volume volume = readVolumeFile(file);
    const SampleGrid grid(volume.view());
    std::int64_t active = 0;
    const Index3 cells = grid.cells();
    for (std::int64_t k = 0; k < cells[2]; ++k) {
        for (std::int64_t j = 0; j < cells[1]; ++j) {
            for (std::int64_t i = 0; i < cells[0]; ++i) active += grid.isActive(i, j, k, isovalue);
        }
    }
    Clock::time_point begin = Clock::now();
    ExtremaGraph graph(grid);
    const double graphSeconds = secondsSince(begin);
    begin = Clock::now();
    const std::int64_t found = std::ssize(graph.propagate(isovalue));
    const double propagationSeconds = secondsSince(begin);

    nlohmann::ordered_json report{{"cells", cells[0] * cells[1] * cells[2]},
                                  {"activeCells", active},
                                  {"extrema", graph.extrema()},
                                  {"graphSeconds", graphSeconds},
                                  {"searchedCells", graph.searched},
                                  {"seeds", graph.seeds},
                                  {"visitedCells", graph.visited},
                                  {"foundCells", found},
                                  {"propagationSeconds", propagationSeconds}};
    for (const int side : {4, 8}) {
        begin = Clock::now();
        const SpanSpaceIndex index =
            SpanSpaceIndex::build(volume.view(), {.blockSize = side, .border = Border::Open});
        const double buildSeconds = secondsSince(begin);
        begin = Clock::now();
        const BlockQuery query = index.blocksAt(isovalue);
        report["kdTree"].push_back({{"blockSize", side},
                                    {"buildSeconds", buildSeconds},
                                    {"nodesVisited", query.nodesVisited},
                                    {"blocks", query.blocks.size()},
                                    {"visitedCells", std::ssize(query.blocks) * side * side * side},
                                    {"searchSeconds", secondsSince(begin)}});
    }
    return report;
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("What an extrema graph and the kd-tree look at", "peerSeeds");
    std::string file;
    double isovalue = 0;
    app.add_option("volume", file, "A volume of peerVolume's")->required();
    app.add_option("--iso", isovalue, "Isovalue")->required();
    return runBenchmark(app, argc, argv,
                        [&] { std::cout << measure(file, isovalue).dump() << '\n'; });
}
