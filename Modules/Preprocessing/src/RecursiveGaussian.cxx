#include "RecursiveGaussian.h"

#include <array>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {
namespace {

using Four = std::array<double, 4>;

/// The filter's coefficients: of the samples (causal n, anticausal m), of the results before (d),
/// and of the border's value in their place (bn, bm).
struct Coefficients {
    Four n, m, d, bn, bm;
};

/// \param sigma  in steps
Coefficients coefficientsFor(double sigma) {
    constexpr double kA1 = 1.3530, kB1 = 1.8151, kW1 = 0.6681, kL1 = -1.3932;
    constexpr double kA2 = -0.3531, kB2 = 0.0902, kW2 = 2.0787, kL2 = -1.3732;
    const double sin1 = portable::sin(kW1 / sigma), sin2 = portable::sin(kW2 / sigma);
    const double cos1 = portable::cos(kW1 / sigma), cos2 = portable::cos(kW2 / sigma);
    const double exp1 = portable::exp(kL1 / sigma), exp2 = portable::exp(kL2 / sigma);

    Coefficients c{};
    c.d[3] = exp1 * exp1 * exp2 * exp2;
    c.d[2] = -2 * cos1 * exp1 * exp2 * exp2;
    c.d[2] += -2 * cos2 * exp2 * exp1 * exp1;
    c.d[1] = 4 * cos2 * cos1 * exp1 * exp2;
    c.d[1] += exp1 * exp1 + exp2 * exp2;
    c.d[0] = -2 * (exp2 * cos2 + exp1 * cos1);
    const double sumD = 1.0 + c.d[0] + c.d[1] + c.d[2] + c.d[3];

    c.n[0] = kA1 + kA2;
    c.n[1] = exp2 * (kB2 * sin2 - (kA2 + 2 * kA1) * cos2);
    c.n[1] += exp1 * (kB1 * sin1 - (kA1 + 2 * kA2) * cos1);
    c.n[2] = (kA1 + kA2) * cos2 * cos1;
    c.n[2] -= kB1 * cos2 * sin1 + kB2 * cos1 * sin2;
    c.n[2] *= 2 * exp1 * exp2;
    c.n[2] += kA2 * exp1 * exp1 + kA1 * exp2 * exp2;
    c.n[3] = exp2 * exp1 * exp1 * (kB2 * sin2 - kA2 * cos2);
    c.n[3] += exp1 * exp2 * exp2 * (kB1 * sin1 - kA1 * cos1);
    const double alpha = 2 * (c.n[0] + c.n[1] + c.n[2] + c.n[3]) / sumD - c.n[0];
    for (double& n : c.n) n *= 1.0 / alpha;

    for (int i = 0; i < 3; ++i) c.m[i] = c.n[i + 1] - c.d[i] * c.n[0];
    c.m[3] = -c.d[3] * c.n[0];
    const double sumN = c.n[0] + c.n[1] + c.n[2] + c.n[3];
    const double sumM = c.m[0] + c.m[1] + c.m[2] + c.m[3];
    for (int i = 0; i < 4; ++i) {
        c.bn[i] = c.d[i] * sumN / sumD;
        c.bm[i] = c.d[i] * sumM / sumD;
    }
    return c;
}

/// out = data * a summed over four, then minus four results before times d.
double step(const Four& data, const Four& a, const Four& before, const Four& d) {
    const double sum = data[0] * a[0] + data[1] * a[1] + data[2] * a[2] + data[3] * a[3];
    return sum - (before[0] * d[0] + before[1] * d[1] + before[2] * d[2] + before[3] * d[3]);
}

/// Filters one line forwards and backwards, and adds both.
void filterLine(const Coefficients& c, const std::vector<double>& data, std::vector<double>& out) {
    const auto length = std::ssize(data);
    Four seen, before, feedback = c.bn;
    seen.fill(data.front());
    before.fill(data.front());
    for (std::int64_t i = 0; i < length; ++i) {
        if (i > 0) seen = {data[i], seen[0], seen[1], seen[2]};
        out[i] = step(seen, c.n, before, feedback);
        // where results take the border's place, their own coefficients do
        if (i < 4) feedback[i] = c.d[i];
        before = {out[i], before[0], before[1], before[2]};
    }
    seen.fill(data.back());
    before.fill(data.back());
    feedback = c.bm;
    for (std::int64_t i = length - 1; i >= 0; --i) {
        const double result = step(seen, c.m, before, feedback);
        if (const std::int64_t done = length - 1 - i; done < 4) feedback[done] = c.d[done];
        before = {result, before[0], before[1], before[2]};
        seen = {data[i], seen[0], seen[1], seen[2]};
        out[i] += result;
    }
}

template <class T>
void smoothLinesOf(const T* from, float* to, const ImageGeometry& geometry, int axis,
                   double sigmaMm) {
    const Coefficients coefficients =
        coefficientsFor(sigmaMm / norm(geometry.indexToPhysical.column[axis]));
    const Index3& size = geometry.size;
    const Index3 stride{1, size[0], size[0] * size[1]};
    const int across = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
    parallelForPieces(size[across] * size[up], 64, [&](std::int64_t begin, std::int64_t end) {
        std::vector<double> data(static_cast<std::size_t>(size[axis])), out(data.size());
        for (std::int64_t line = begin; line < end; ++line) {
            const std::int64_t first =
                line % size[across] * stride[across] + line / size[across] * stride[up];
            for (std::int64_t i = 0; i < size[axis]; ++i) {
                data[i] = static_cast<double>(from[first + i * stride[axis]]);
            }
            filterLine(coefficients, data, out);
            for (std::int64_t i = 0; i < size[axis]; ++i) {
                to[first + i * stride[axis]] = static_cast<float>(out[i]);
            }
        }
    });
}

}  // namespace

void smoothLines(const float* from, float* to, const ImageGeometry& geometry, int axis,
                 double sigmaMm) {
    smoothLinesOf(from, to, geometry, axis, sigmaMm);
}

void smoothLines(const double* from, float* to, const ImageGeometry& geometry, int axis,
                 double sigmaMm) {
    smoothLinesOf(from, to, geometry, axis, sigmaMm);
}

}  // namespace adaptiso::detail
