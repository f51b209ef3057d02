#include "BiasField.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::headmodel {
namespace {

using Terms = std::array<double, BiasField::kTerms>;

constexpr double kBlockMm = 4;
constexpr std::size_t kFewestBlocks = 1000;

/// One block of tissue.
struct Block {
    Vec3 index;        ///< of its middle, in voxels
    double logarithm;  ///< of its mean above the air
};

std::vector<Block> blocksOf(const std::vector<float>& values, double airLevel, const Mask& tissue,
                            const ImageGeometry& grid) {
    const auto side = std::max<std::int64_t>(std::llround(kBlockMm / stepMm(grid)), 1);
    const std::int64_t whole = side * side * side;
    const double middle = static_cast<double>(side - 1) / 2;
    std::vector<Block> blocks;
    for (std::int64_t k = 0; k + side <= grid.size[2]; k += side) {
        for (std::int64_t j = 0; j + side <= grid.size[1]; j += side) {
            for (std::int64_t i = 0; i + side <= grid.size[0]; i += side) {
                double sum = 0;
                std::int64_t count = 0;
                forEachRow({i, j, k}, {side, side, side}, grid.size,
                           [&](std::int64_t first, std::int64_t) {
                               for (std::int64_t n = first; n < first + side; ++n) {
                                   if (tissue[n] == 0) continue;
                                   sum += values[n] - airLevel;
                                   ++count;
                               }
                           });
                if (count < whole) continue;
                blocks.push_back(
                    {Vec3{static_cast<double>(i) + middle, static_cast<double>(j) + middle,
                          static_cast<double>(k) + middle},
                     portable::log(sum / static_cast<double>(count))});
            }
        }
    }
    return blocks;
}

Terms termsAt(const Vec3& p) {
    return {p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z};
}

/// Quadratics that are orthonormal over the blocks: a step along one is as large as along another.
struct Base {
    std::vector<Terms> atBlock;                      ///< values of the nine quadratics
    std::array<Terms, BiasField::kTerms> ofTerms{};  ///< each as a sum of terms
    Terms mean{};                                    ///< of the terms over the blocks
};

Base orthonormalBase(const std::vector<Terms>& terms) {
    Base base;
    const auto count = static_cast<double>(terms.size());
    for (const Terms& t : terms) {
        for (int n = 0; n < BiasField::kTerms; ++n) base.mean[n] += t[n] / count;
    }
    base.atBlock = terms;
    for (Terms& t : base.atBlock) {
        for (int n = 0; n < BiasField::kTerms; ++n) t[n] -= base.mean[n];
    }
    const auto product = [&](int a, int b) {
        double sum = 0;
        for (const Terms& t : base.atBlock) sum += t[a] * t[b];
        return sum / count;
    };
    for (int n = 0; n < BiasField::kTerms; ++n) {
        base.ofTerms[n][n] = 1;
        for (int m = 0; m < n; ++m) {
            const double part = product(n, m);
            for (Terms& t : base.atBlock) t[n] -= part * t[m];
            for (int k = 0; k < BiasField::kTerms; ++k) {
                base.ofTerms[n][k] -= part * base.ofTerms[m][k];
            }
        }
        const double size = std::sqrt(std::max(product(n, n), 1e-12));
        for (Terms& t : base.atBlock) t[n] /= size;
        for (double& k : base.ofTerms[n]) k /= size;
    }
    return base;
}

/// Entropy of the blocks' logarithms without a field: of a histogram smoothed by its bins' width.
class Entropy {
public:
    Entropy(const std::vector<Block>& blocks, const Base& base) : blocks_(blocks), base_(base) {
        std::vector<double> sorted;
        for (const Block& block : blocks) sorted.push_back(block.logarithm);
        const auto middle = sorted.begin() + std::ssize(sorted) / 2;
        std::nth_element(sorted.begin(), middle, sorted.end());
        median_ = *middle;
    }

    double without(const Terms& field) const {
        constexpr int kBins = 64;
        constexpr double kLeast = -2, kMost = 1.2;  // 0.14 to 3.3 times the median
        std::array<double, kBins + 3> histogram{};
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            double value = blocks_[b].logarithm - median_;
            for (int n = 0; n < BiasField::kTerms; ++n) value -= field[n] * base_.atBlock[b][n];
            const double at =
                1 + std::clamp((value - kLeast) / (kMost - kLeast) * kBins, 0.0, kBins - 0.001);
            const auto bin = static_cast<int>(at);
            histogram[bin] += bin + 1 - at;
            histogram[bin + 1] += at - bin;
        }
        double entropy = 0;
        const auto count = static_cast<double>(blocks_.size());
        for (int n = 1; n + 1 < static_cast<int>(histogram.size()); ++n) {
            const double share =
                (histogram[n - 1] + 2 * histogram[n] + histogram[n + 1]) / (4 * count);
            if (share > 0) entropy -= share * portable::log(share);
        }
        return entropy;
    }

private:
    const std::vector<Block>& blocks_;
    const Base& base_;
    double median_ = 0;
};

/// The least entropy that steps along one quadratic at a time reach, ever shorter ones.
Terms leastEntropy(const Entropy& entropy) {
    constexpr double kLongest = 0.16, kShortest = 0.005, kWorth = 1e-5;
    constexpr int kMostRounds = 10;
    Terms field{};
    double least = entropy.without(field);
    const auto isBetterBy = [&](int n, double step) {
        Terms tried = field;
        tried[n] += step;
        const double found = entropy.without(tried);
        if (!(found < least - kWorth)) return false;
        field = tried;
        least = found;
        return true;
    };
    for (double step = kLongest; step >= kShortest; step /= 2) {
        bool hasMoved = true;
        for (int round = 0; round < kMostRounds && hasMoved; ++round) {
            hasMoved = false;
            for (int n = 0; n < BiasField::kTerms; ++n) {
                for (const double way : {step, -step}) {
                    while (isBetterBy(n, way)) hasMoved = true;
                }
            }
        }
    }
    return field;
}

/// e^x to 0.3 % for |x| < 0.4, by the same operations on every processor.
double roughExp(double x) {
    double power = 1 + x / 32;
    for (int n = 0; n < 5; ++n) power *= power;
    return power;
}

}  // namespace

BiasField BiasField::estimated(const std::vector<float>& values, double airLevel,
                               const Mask& tissue, const ImageGeometry& grid) {
    BiasField field;
    const std::vector<Block> blocks = blocksOf(values, airLevel, tissue, grid);
    if (blocks.size() < kFewestBlocks) return field;
    std::int64_t longest = 1;
    for (int a = 0; a < 3; ++a) {
        field.middle_[a] = static_cast<double>(grid.size[a] - 1) / 2;
        longest = std::max(longest, grid.size[a]);
    }
    field.perVoxel_ = 2 / static_cast<double>(longest);
    std::vector<Terms> terms;
    for (const Block& block : blocks) {
        terms.push_back(termsAt(field.perVoxel_ * (block.index - field.middle_)));
    }
    const Base base = orthonormalBase(terms);
    const Terms found = leastEntropy(Entropy(blocks, base));
    for (int n = 0; n < kTerms; ++n) {
        for (int k = 0; k < kTerms; ++k) field.coefficients_[k] += found[n] * base.ofTerms[n][k];
    }
    field.leastLog_ = -1e9;
    field.mostLog_ = 1e9;
    std::vector<double> logarithms;
    for (const Block& block : blocks) logarithms.push_back(field.logarithmAt(block.index));
    std::sort(logarithms.begin(), logarithms.end());
    const auto last = static_cast<double>(logarithms.size() - 1);
    const auto quantile = [&](double share) {
        return logarithms[static_cast<std::size_t>(share * last)];
    };
    // what few blocks at the rim alone have is no more than the polynomial's swing
    constexpr double kRim = 0.005;
    field.offset_ = quantile(0.5);
    field.leastLog_ = quantile(kRim) - field.offset_;
    field.mostLog_ = quantile(1 - kRim) - field.offset_;
    return field;
}

double BiasField::logarithmAt(const Vec3& index) const {
    const Terms terms = termsAt(perVoxel_ * (index - middle_));
    double sum = -offset_;
    for (int n = 0; n < kTerms; ++n) sum += coefficients_[n] * terms[n];
    return std::clamp(sum, leastLog_, mostLog_);
}

void BiasField::removeFrom(std::vector<float>& values, double airLevel, const Index3& size) const {
    if (leastLog_ == mostLog_) return;
    parallelForPieces(size[1] * size[2], 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t row = begin; row < end; ++row) {
            Vec3 index{0, static_cast<double>(row % size[1]), static_cast<double>(row / size[1])};
            for (std::int64_t i = 0; i < size[0]; ++i) {
                index.x = static_cast<double>(i);
                float& value = values[row * size[0] + i];
                value = static_cast<float>(airLevel +
                                           (value - airLevel) * roughExp(-logarithmAt(index)));
            }
        }
    });
}

double BiasField::least() const {
    return portable::exp(leastLog_);
}

double BiasField::most() const {
    return portable::exp(mostLog_);
}

}  // namespace adaptiso::headmodel
