// Gaussians by Deriche's recursion of fourth order [Deriche1993], with the coefficients, the
// borders and the order of every sum of ITK's RecursiveGaussianImageFilter, so that results are the
// same to the bit. ITK takes one row after the other, through iterators; here 8 go side by side in
// vector registers, in the volume's own memory, and rows of zeros, which stay zeros, cost nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ImageSteps.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {
namespace {

constexpr std::int64_t kLanes = 8;
using Lanes = std::array<double, kLanes>;
using Four = std::array<double, 4>;

/// The recursion's coefficients, named as in ITK.
struct Coefficients {
    Four n;   ///< N0 to N3: of the samples, forwards
    Four m;   ///< M1 to M4: of the samples, backwards
    Four d;   ///< D1 to D4: of the results
    Four bn;  ///< BN1 to BN4, BM1 to BM4: of what lies before the first, beyond the last sample
    Four bm;
};

Coefficients coefficientsFor(double sigmaVoxels) {
    constexpr double kA1 = 1.3530, kB1 = 1.8151, kW1 = 0.6681, kL1 = -1.3932;
    constexpr double kA2 = -0.3531, kB2 = 0.0902, kW2 = 2.0787, kL2 = -1.3732;
    const double sin1 = std::sin(kW1 / sigmaVoxels), sin2 = std::sin(kW2 / sigmaVoxels);
    const double cos1 = std::cos(kW1 / sigmaVoxels), cos2 = std::cos(kW2 / sigmaVoxels);
    const double exp1 = std::exp(kL1 / sigmaVoxels), exp2 = std::exp(kL2 / sigmaVoxels);

    Coefficients c{};
    auto& [d1, d2, d3, d4] = c.d;
    d4 = exp1 * exp1 * exp2 * exp2;
    d3 = -2 * cos1 * exp1 * exp2 * exp2;
    d3 += -2 * cos2 * exp2 * exp1 * exp1;
    d2 = 4 * cos2 * cos1 * exp1 * exp2;
    d2 += exp1 * exp1 + exp2 * exp2;
    d1 = -2 * (exp2 * cos2 + exp1 * cos1);
    const double sumD = 1.0 + d1 + d2 + d3 + d4;

    auto& [n0, n1, n2, n3] = c.n;
    n0 = kA1 + kA2;
    n1 = exp2 * (kB2 * sin2 - (kA2 + 2 * kA1) * cos2);
    n1 += exp1 * (kB1 * sin1 - (kA1 + 2 * kA2) * cos1);
    n2 = (kA1 + kA2) * cos2 * cos1;
    n2 -= kB1 * cos2 * sin1 + kB2 * cos1 * sin2;
    n2 *= 2 * exp1 * exp2;
    n2 += kA2 * exp1 * exp1 + kA1 * exp2 * exp2;
    n3 = exp2 * exp1 * exp1 * (kB2 * sin2 - kA2 * cos2);
    n3 += exp1 * exp2 * exp2 * (kB1 * sin1 - kA1 * cos1);
    const double gain = 2 * (n0 + n1 + n2 + n3) / sumD - n0;
    for (double& n : c.n) n *= 1.0 / gain;

    c.m = {n1 - d1 * n0, n2 - d2 * n0, n3 - d3 * n0, -d4 * n0};
    const double sumN = n0 + n1 + n2 + n3;
    const double sumM = c.m[0] + c.m[1] + c.m[2] + c.m[3];
    for (std::size_t k = 0; k < 4; ++k) {
        c.bn[k] = c.d[k] * sumN / sumD;
        c.bm[k] = c.d[k] * sumM / sumD;
    }
    return c;
}

/// Rows side by side, forwards along them: results[i] from samples i, i - 1, ... and the results
/// before it; `stride` is 1, or -1 to go backwards. Before the first sample it is taken to have
/// gone on for ever, with what weighs `beyond` as its result.
void recur(const Four& ofSamples, const Four& ofResults, const Four& beyond, const Lanes* samples,
           std::int64_t firstSample, Lanes* results, std::int64_t stride, std::int64_t count) {
    const auto [n0, n1, n2, n3] = ofSamples;
    for (std::int64_t i = 0; i < count; ++i) {
        const auto sample = [&](std::int64_t back) -> const Lanes& {
            return samples[stride * std::max<std::int64_t>(i + firstSample - back, 0)];
        };
        const auto former = [&](std::int64_t back) -> const Lanes& {
            return back <= i ? results[stride * (i - back)] : samples[0];
        };
        Four d = ofResults;
        for (std::int64_t k = i; k < 4; ++k) d[k] = beyond[k];
        const Lanes &s0 = sample(0), &s1 = sample(1), &s2 = sample(2), &s3 = sample(3);
        const Lanes &r1 = former(1), &r2 = former(2), &r3 = former(3), &r4 = former(4);
        Lanes result;
        for (std::int64_t l = 0; l < kLanes; ++l) {
            const double sum = s0[l] * n0 + s1[l] * n1 + s2[l] * n2 + s3[l] * n3;
            result[l] = sum - (r1[l] * d[0] + r2[l] * d[1] + r3[l] * d[2] + r4[l] * d[3]);
        }
        results[stride * i] = result;
    }
}

/// Rows of `data` side by side, smoothed; the other two are as long, for what comes between.
void smoothLanes(const Coefficients& c, std::vector<Lanes>& data, std::vector<Lanes>& forwards,
                 std::vector<Lanes>& backwards) {
    const std::int64_t count = std::ssize(data), last = count - 1;
    recur(c.n, c.d, c.bn, data.data(), 0, forwards.data(), 1, count);
    // the sample itself was counted forwards
    recur(c.m, c.d, c.bm, data.data() + last, -1, backwards.data() + last, -1, count);
    for (std::int64_t i = 0; i < count; ++i) {
        for (std::int64_t l = 0; l < kLanes; ++l) data[i][l] = forwards[i][l] + backwards[i][l];
    }
}

/// Smooths `lanes` rows of `count` samples in place, which begin at first, first + laneStride, ...
class RowSmoother {
public:
    RowSmoother(const Coefficients& coefficients, std::int64_t count)
        : coefficients_(coefficients), data_(count), forwards_(count), backwards_(count) {}

    void smooth(float* first, std::int64_t stride, std::int64_t laneStride, std::int64_t lanes) {
        bool isEmpty = true;
        for (std::int64_t i = 0; i < std::ssize(data_); ++i) {
            const float* const at = first + i * stride;
            for (std::int64_t l = 0; l < kLanes; ++l) {
                const float value = l < lanes ? at[l * laneStride] : 0.0f;
                isEmpty &= value == 0;
                data_[i][l] = value;
            }
        }
        if (isEmpty) return;
        smoothLanes(coefficients_, data_, forwards_, backwards_);
        for (std::int64_t i = 0; i < std::ssize(data_); ++i) {
            float* const at = first + i * stride;
            for (std::int64_t l = 0; l < lanes; ++l) {
                at[l * laneStride] = static_cast<float>(data_[i][l]);
            }
        }
    }

private:
    const Coefficients& coefficients_;
    std::vector<Lanes> data_, forwards_, backwards_;
};

}  // namespace

std::vector<float> smoothed(std::vector<float> values, const ImageGeometry& grid, double sigmaMm) {
    if (sigmaMm < stepMm(grid) / 3) return values;
    const Coefficients coefficients = coefficientsFor(sigmaMm / stepMm(grid));
    const Index3& size = grid.size;
    const Index3 stride{1, size[0], size[0] * size[1]};
    for (const int axis : {2, 0, 1}) {
        // rows side by side: neighbours along x, or along y where rows run along x
        const int lane = axis == 0 ? 1 : 0, outer = 3 - axis - lane;
        parallelForPieces(size[outer], 1, [&](std::int64_t n, std::int64_t) {
            RowSmoother smoother(coefficients, size[axis]);
            for (std::int64_t from = 0; from < size[lane]; from += kLanes) {
                smoother.smooth(values.data() + n * stride[outer] + from * stride[lane],
                                stride[axis], stride[lane], std::min(kLanes, size[lane] - from));
            }
        });
    }
    return values;
}

}  // namespace adaptiso::headmodel
