#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "CellContour.h"
#include "Relatives.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::benchmarks {
namespace {

Volume owned(const VolumeView& volume) {
    const auto bytes = std::make_shared<std::vector<std::byte>>(volume.byteCount());
    std::memcpy(bytes->data(), volume.samples(), bytes->size());
    return Volume(VolumeView(bytes->data(), volume.pixelType(), volume.geometry()), bytes);
}

/// Neighbours in the Freudenthal triangulation, and which of them are neighbours of each other.
struct Link {
    std::vector<Index3> offsets;
    std::vector<std::vector<std::size_t>> next;

    Link() {
        for (std::int64_t k = 0; k < 2; ++k) {
            for (std::int64_t j = 0; j < 2; ++j) {
                for (std::int64_t i = 0; i < 2; ++i) {
                    if (i + j + k == 0) continue;
                    offsets.push_back({i, j, k});
                    offsets.push_back({-i, -j, -k});
                }
            }
        }
        next.resize(offsets.size());
        for (std::size_t a = 0; a < offsets.size(); ++a) {
            for (std::size_t b = 0; b < offsets.size(); ++b) {
                const Index3 d{offsets[a][0] - offsets[b][0], offsets[a][1] - offsets[b][1],
                               offsets[a][2] - offsets[b][2]};
                for (const Index3& edge : offsets) {
                    if (edge == d) next[a].push_back(b);
                }
            }
        }
    }
};

/// Pieces of the link whose samples are above (or not) that of the point.
int pieces(const std::array<bool, 14>& isAbove, bool above, const Link& link) {
    std::array<bool, 14> seen{};
    int count = 0;
    for (std::size_t start = 0; start < 14; ++start) {
        if (seen[start] || isAbove[start] != above) continue;
        ++count;
        std::vector<std::size_t> stack{start};
        seen[start] = true;
        while (!stack.empty()) {
            const std::size_t at = stack.back();
            stack.pop_back();
            for (const std::size_t to : link.next[at]) {
                if (seen[to] || isAbove[to] != above) continue;
                seen[to] = true;
                stack.push_back(to);
            }
        }
    }
    return count;
}

bool isCritical(const SampleGrid& grid, std::int64_t i, std::int64_t j, std::int64_t k,
                const Link& link) {
    std::array<bool, 14> isAbove{};
    const float value = grid.at(i, j, k);
    for (std::size_t n = 0; n < 14; ++n) {
        const Index3& d = link.offsets[n];
        const float other = grid.clamped(i + d[0], j + d[1], k + d[2]);
        // of equal samples the one with the larger number is above
        isAbove[n] = other != value ? other > value : d[0] + 2 * d[1] + 4 * d[2] > 0;
    }
    return pieces(isAbove, true, link) != 1 || pieces(isAbove, false, link) != 1;
}

/// The sample that stands for a coarse cell.
float chosen(const SampleGrid& grid, const Index3& low, std::int64_t step, double isovalue,
             const Link& link) {
    const float regular = grid.clamped(low[0], low[1], low[2]);
    const bool isInside = regular >= isovalue;
    float best = regular;
    double farthest = 0;
    for (std::int64_t k = low[2]; k < std::min(low[2] + step, grid.size()[2]); ++k) {
        for (std::int64_t j = low[1]; j < std::min(low[1] + step, grid.size()[1]); ++j) {
            for (std::int64_t i = low[0]; i < std::min(low[0] + step, grid.size()[0]); ++i) {
                const float value = grid.at(i, j, k);
                const double away = std::abs(value - isovalue);
                if ((value >= isovalue) == isInside || away <= farthest) continue;
                if (!isCritical(grid, i, j, k, link)) continue;
                best = value;
                farthest = away;
            }
        }
    }
    return best;
}

}  // namespace

TriangleMesh downsampled(const VolumeView& volume, double isovalue, double coarseness) {
    const Vec3 spacing = volume.geometry().spacingMm();
    const double stepMm = (1 + 7 * coarseness) * std::min({spacing.x, spacing.y, spacing.z});
    PreprocessOptions options;
    if (coarseness > 0) {
        options.smoothSigmaMm = stepMm / 2;
        options.resampleMm = stepMm;
    }
    const Preprocessed coarse = preprocess(owned(volume), options);
    const SpanSpaceIndex index =
        SpanSpaceIndex::build(coarse.volume.view(), {.border = Border::Open});
    ExtractionOptions extraction;
    extraction.isovalue = isovalue;
    extraction.method = Method::MarchingCubes;
    extraction.computeNormals = false;
    return extractSurface(coarse.volume.view(), index, extraction).mesh;
}

TriangleMesh downsampledCritical(const SampleGrid& grid, double isovalue, double coarseness) {
    const auto step = static_cast<std::int64_t>(std::lround(1 + 7 * coarseness));
    const Link link;
    Index3 nodes;
    for (std::size_t axis = 0; axis < 3; ++axis) nodes[axis] = (grid.size()[axis] - 1) / step + 1;
    std::vector<float> values;
    for (std::int64_t k = 0; k < nodes[2]; ++k) {
        for (std::int64_t j = 0; j < nodes[1]; ++j) {
            for (std::int64_t i = 0; i < nodes[0]; ++i) {
                values.push_back(
                    chosen(grid, {i * step, j * step, k * step}, step, isovalue, link));
            }
        }
    }
    ImageGeometry geometry = grid.geometry();
    geometry.size = nodes;
    for (Vec3& column : geometry.indexToPhysical.column) {
        column = static_cast<double>(step) * column;
    }
    ExtractionOptions extraction;
    extraction.isovalue = isovalue;
    extraction.method = Method::MarchingCubes;
    extraction.computeNormals = false;
    const VolumeView view(values.data(), geometry);
    const SpanSpaceIndex index = SpanSpaceIndex::build(view, {.border = Border::Open});
    return extractSurface(view, index, extraction).mesh;
}

}  // namespace adaptiso::benchmarks
