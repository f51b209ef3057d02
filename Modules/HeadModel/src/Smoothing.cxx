// A sampled Gaussian, axis after axis. The solids of a head are 0 or 1 but near their surfaces, so
// runs of samples around which all are alike are copied; the rest is computed a run at once. ITK's
// recursive filter costs as much everywhere, and is a Gaussian to about 1 %.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ImageSteps.h"

namespace adaptiso::headmodel {
namespace {

constexpr std::int64_t kRun = 32;  ///< samples along x that are looked at together

/// Weights of the samples 0, 1, 2, ... away; what lies beyond 4.5 standard deviations is 7e-6.
std::vector<float> gaussianWeights(double sigmaVoxels) {
    const auto reach = static_cast<std::int64_t>(std::ceil(4.5 * sigmaVoxels));
    std::vector<double> exact(reach + 1);
    double sum = -1;  // the middle one counts once
    for (std::int64_t d = 0; d <= reach; ++d) {
        const double z = static_cast<double>(d) / sigmaVoxels;
        exact[d] = std::exp(-z * z / 2);
        sum += 2 * exact[d];
    }
    std::vector<float> weights(exact.size());
    for (std::size_t d = 0; d < exact.size(); ++d) weights[d] = static_cast<float>(exact[d] / sum);
    return weights;
}

std::int64_t runsIn(std::int64_t width) {
    return (width + kRun - 1) / kRun;
}

/// The value that all samples of a run have; NaN where they differ.
float commonValue(const float* run) {
    bool isSame = true;
    for (std::int64_t i = 1; i < kRun; ++i) isSame &= run[i] == run[0];
    return isSame ? run[0] : std::numeric_limits<float>::quiet_NaN();
}

/// Rows of whole runs, and what is common to each run.
struct Plane {
    Plane(std::int64_t width, std::int64_t rows)
        : runs(runsIn(width)),
          count(rows),
          samples(runs * kRun * rows),
          common(static_cast<std::size_t>(runs * rows)) {}
    float* row(std::int64_t n) { return samples.data() + n * runs * kRun; }

    /// Takes a row over, its last sample repeated to the end of the last run.
    void take(std::int64_t n, const float* from, std::int64_t width) {
        float* const to = row(n);
        std::copy_n(from, width, to);
        std::fill(to + width, to + runs * kRun, from[width - 1]);
        look(n);
    }
    void look(std::int64_t n) {
        for (std::int64_t r = 0; r < runs; ++r)
            common[n * runs + r] = commonValue(row(n) + r * kRun);
    }

    std::int64_t runs, count;
    std::vector<float> samples, common;
};

/// All of values[first], values[first + stride], ... are the same, and none is NaN.
bool areSame(const float* values, std::int64_t first, std::int64_t last, std::int64_t stride) {
    for (std::int64_t n = first; n <= last; ++n) {
        if (!(values[n * stride] == values[first * stride])) return false;
    }
    return true;
}

/// to = weights[0] * middle + the sum over d of weights[d] * (before(d) + after(d)), for a run.
template <class Before, class After>
void weigh(const std::vector<float>& weights, const float* middle, const Before& before,
           const After& after, float* __restrict to) {
    float sums[kRun];
    for (std::int64_t i = 0; i < kRun; ++i) sums[i] = weights[0] * middle[i];
    for (std::int64_t d = 1; d < std::ssize(weights); ++d) {
        const float weight = weights[d];
        const float* const low = before(d);
        const float* const high = after(d);
        for (std::int64_t i = 0; i < kRun; ++i) sums[i] += weight * (low[i] + high[i]);
    }
    std::copy_n(sums, kRun, to);
}

/// Along a row, in place. `padded` is room for the row and the weights' reach on both sides.
void smoothAlong(Plane& plane, std::int64_t n, const std::vector<float>& weights,
                 std::vector<float>& padded) {
    const std::int64_t reach = std::ssize(weights) - 1, width = plane.runs * kRun;
    const std::int64_t reachRuns = runsIn(reach);
    const float* const common = plane.common.data() + n * plane.runs;
    if (areSame(common, 0, plane.runs - 1, 1)) return;
    float* const row = plane.row(n);
    padded.resize(width + 2 * reach);
    std::fill_n(padded.begin(), reach, row[0]);
    std::copy_n(row, width, padded.begin() + reach);
    std::fill(padded.begin() + reach + width, padded.end(), row[width - 1]);
    for (std::int64_t r = 0; r < plane.runs; ++r) {
        if (areSame(common, std::max<std::int64_t>(r - reachRuns, 0),
                    std::min(r + reachRuns, plane.runs - 1), 1)) {
            continue;
        }
        const float* const middle = padded.data() + reach + r * kRun;
        weigh(
            weights, middle, [&](std::int64_t d) { return middle - d; },
            [&](std::int64_t d) { return middle + d; }, row + r * kRun);
    }
    plane.look(n);
}

/// Across rows: row `n` of the result, `width` samples of it. `room` holds whole runs.
void smoothAcross(Plane& plane, std::int64_t n, const std::vector<float>& weights,
                  std::vector<float>& room, std::int64_t width, float* to) {
    const std::int64_t reach = std::ssize(weights) - 1;
    const std::int64_t first = std::max<std::int64_t>(n - reach, 0);
    const std::int64_t last = std::min(n + reach, plane.count - 1);
    room.resize(plane.runs * kRun);
    for (std::int64_t r = 0; r < plane.runs; ++r) {
        const float* const common = plane.common.data() + r;
        float* const run = room.data() + r * kRun;
        if (areSame(common, first, last, plane.runs)) {
            std::fill_n(run, kRun, common[n * plane.runs]);
            continue;
        }
        weigh(
            weights, plane.row(n) + r * kRun,
            [&](std::int64_t d) { return plane.row(std::max(n - d, first)) + r * kRun; },
            [&](std::int64_t d) { return plane.row(std::min(n + d, last)) + r * kRun; }, run);
    }
    std::copy_n(room.begin(), width, to);
}

}  // namespace

std::vector<float> smoothed(std::vector<float> values, const ImageGeometry& grid, double sigmaMm) {
    if (sigmaMm < stepMm(grid) / 3) return values;
    const std::vector<float> weights = gaussianWeights(sigmaMm / stepMm(grid));
    const auto [width, rows, slices] = grid.size;
    const std::int64_t slice = width * rows;
    parallelForPieces(slices, 4,
                      [&, width = width, rows = rows](std::int64_t begin, std::int64_t end) {
                          Plane plane(width, rows);
                          std::vector<float> room;
                          for (std::int64_t k = begin; k < end; ++k) {
                              float* const first = values.data() + k * slice;
                              for (std::int64_t j = 0; j < rows; ++j) {
                                  plane.take(j, first + j * width, width);
                                  smoothAlong(plane, j, weights, room);
                              }
                              for (std::int64_t j = 0; j < rows; ++j) {
                                  smoothAcross(plane, j, weights, room, width, first + j * width);
                              }
                          }
                      });
    parallelForPieces(rows, 4,
                      [&, width = width, slices = slices](std::int64_t begin, std::int64_t end) {
                          Plane plane(width, slices);
                          std::vector<float> room;
                          for (std::int64_t j = begin; j < end; ++j) {
                              float* const first = values.data() + j * width;
                              for (std::int64_t k = 0; k < slices; ++k)
                                  plane.take(k, first + k * slice, width);
                              for (std::int64_t k = 0; k < slices; ++k) {
                                  smoothAcross(plane, k, weights, room, width, first + k * slice);
                              }
                          }
                      });
    return values;
}

}  // namespace adaptiso::headmodel
