#include "BrainGuess.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {

double partAtSkin(const Mask& brain, const std::vector<float>& belowSkin, double mm) {
    std::int64_t near = 0;
    for (std::size_t n = 0; n < brain.size(); ++n) {
        if (brain[n] != 0 && belowSkin[n] < mm) ++near;
    }
    return static_cast<double>(near) / static_cast<double>(voxelsIn(brain));
}

namespace {

/// Checks that a brain has a possible size and does not touch the skin.
bool isPlausibleBrain(const Mask& brain, const Head& head, const std::vector<float>& belowSkin) {
    // scalp and skull are thicker together; on a T2 CSF, which touches the skull, is in it
    const double nearestMm =
        std::min(head.usual.leastBrainToSkinMm, head.isFluidBright ? 5.0 : 8.0);
    const double cm3 = cm3Of(brain, head.grid);
    return cm3 >= std::min(500.0, 0.7 * head.usual.leastInnerSkullCm3) && cm3 <= kMostBrainCm3 &&
           partAtSkin(brain, belowSkin, nearestMm) <= 0.001;
}

/// Without what hangs on by less than 16 mm: vessels, nerves, muscle below the skull's base.
Mask withoutTongues(const Mask& brain, const Head& head) {
    constexpr double kSulcusMm = 6, kTongueMm = 8, kRoundingMm = 2;
    const Mask bulk = opened(closed(brain, head.grid, kSulcusMm), head.grid, kTongueMm);
    Mask result = dilated(largestComponent(bulk, head.grid.size), head.grid, kRoundingMm);
    for (std::size_t n = 0; n < brain.size(); ++n) result[n] &= brain[n];
    return result;
}

/// With voxels whose 26 neighbours are in the mask but for a few: noise makes holes that an erosion
/// would widen to pits. A gap between two solids, one voxel wide, has 18 neighbours and stays.
Mask withoutHoles(const Mask& mask, const Index3& size) {
    constexpr int kLeastNeighbours = 20;
    Mask result = mask;
    const std::int64_t row = size[0], slice = size[0] * size[1];
    parallelForPieces(size[2], 1, [&](std::int64_t k, std::int64_t) {
        if (k == 0 || k + 1 == size[2]) return;
        for (std::int64_t j = 1; j + 1 < size[1]; ++j) {
            for (std::int64_t i = 1; i + 1 < size[0]; ++i) {
                const std::int64_t n = i + row * j + slice * k;
                if (mask[n] != 0 || mask[n - 1] + mask[n + 1] == 0) continue;
                int count = 0;
                for (std::int64_t z = n - slice; z <= n + slice; z += slice) {
                    for (std::int64_t y = z - row; y <= z + row; y += row) {
                        count += mask[y - 1] + mask[y] + mask[y + 1];
                    }
                }
                result[n] = count >= kLeastNeighbours ? 1 : 0;
            }
        }
    });
    return result;
}

/// Search for the brain by thresholds and morphology.
class BrainSearch {
public:
    explicit BrainSearch(const Head& head)
        : head_(head), tissue_(head.t1.size()), belowSkin_(belowSkinMm(head)) {
        const std::vector<float> depth = depthInHeadMm(head.mask, head.grid);
        const double span = head.levels.tissue - head.levels.air;
        const double scalpMm = std::min(4.0, head.usual.leastBrainToSkinMm);
        for (std::size_t n = 0; n < tissue_.size(); ++n) {
            const double level = (head.t1[n] - head.levels.air) / span;
            // on a T2 all that is not dark as bone: brain and CSF
            const bool isTissue = head.isFluidBright ? level > 0.4 : level > 0.55 && level < 1.45;
            tissue_[n] = (isTissue || head.isLesion(n)) && depth[n] > scalpMm ? 1 : 0;
        }
        tissue_ = withoutHoles(tissue_, head.grid.size);
        middle_ = ballAround(deepestVoxel(depth), head.grid, 20);
    }

    /// Voxels connected with the head's middle by more than twice `radiusMm`.
    Mask looseAt(double radiusMm) const {
        const Index3& size = head_.grid.size;
        const Mask core = componentsWith(middle_, eroded(tissue_, head_.grid, radiusMm), size);
        Mask brain = dilated(core, head_.grid, radiusMm + 1);
        for (std::size_t v = 0; v < brain.size(); ++v) brain[v] &= tissue_[v];
        return filled(largestComponent(brain, size), size);
    }

    bool isPlausible(const Mask& brain) const { return isPlausibleBrain(brain, head_, belowSkin_); }

private:
    const Head& head_;
    Mask tissue_, middle_;
    std::vector<float> belowSkin_;
};

/// Muscle below the skull's base that still hangs on `brain`, and no longer on `next`: a lump far
/// below its middle. What an erosion takes of a brain are tips of gyri.
bool dropsMuscle(const Mask& brain, const Mask& next, const ImageGeometry& grid) {
    constexpr double kTipMm = 3, kLeastCm3 = 15, kLeastBelowMm = 40;
    Mask lump = brain;
    for (std::size_t n = 0; n < lump.size(); ++n) {
        if (next[n] != 0) lump[n] = 0;
    }
    lump = largestComponent(opened(lump, grid, kTipMm), grid.size);
    const auto heightMm = [&](const Mask& mask) {
        Vec3 sum;
        for (std::int64_t n = 0; n < std::ssize(mask); ++n) {
            if (mask[n] == 0) continue;
            sum = sum + Vec3{static_cast<double>(n % grid.size[0]),
                             static_cast<double>(n / grid.size[0] % grid.size[1]),
                             static_cast<double>(n / (grid.size[0] * grid.size[1]))};
        }
        return grid.toPhysical(1 / static_cast<double>(voxelsIn(mask)) * sum).z;
    };
    return static_cast<double>(voxelsIn(lump)) * std::pow(stepMm(grid), 3) >= 1000 * kLeastCm3 &&
           heightMm(next) - heightMm(lump) >= kLeastBelowMm;
}

}  // namespace

Mask guessedBrain(const Head& head) {
    constexpr double kFirstMm = 2, kStepMm = 0.5;
    constexpr int kSteps = 12, kStepsAhead = 2;
    const BrainSearch search(head);
    Mask brain;
    int found = kSteps + 1;
    for (int n = 0; n <= std::min(kSteps, found + kStepsAhead); ++n) {
        Mask loose = search.looseAt(kFirstMm + n * kStepMm);
        if (!search.isPlausible(loose)) {
            if (found <= kSteps) break;
        } else if (found > kSteps || dropsMuscle(brain, loose, head.grid)) {
            found = std::min(found, n);
            brain = std::move(loose);
        }
    }
    return found > kSteps ? Mask{} : withoutTongues(brain, head);
}

std::string noBrainText(const Head& head) {
    constexpr double kUsuallyDark = 0.18;  // stripped images with wide sulci: up to 12 %
    if (head.isFluidBright) {
        return "CSF is brighter than brain (a T2-weighted image?), and no brain comes loose by "
               "thresholds; give a T1, or a brain mask";
    }
    if (head.darkShare < kUsuallyDark) return kSkullStripped;
    constexpr double kStrongBias = 3;  // ch2 with 2.8 is modelled, with 5 refused
    if (head.bias.most() > kStrongBias * head.bias.least()) {
        return "no brain comes loose by thresholds (the same tissue is " +
               shortNumber(head.bias.least()) + " to " + shortNumber(head.bias.most()) +
               " times as bright as usual from place to place, a strong bias field); correct it "
               "first, or give a brain mask";
    }
    return std::string("no brain comes loose by thresholds") +
           (head.besideCm3 >= kLeastBesideCm3 ? " (something lies beside the head: a stereotactic "
                                                "frame, headphones?)"
                                              : "") +
           "; give a brain mask";
}

}  // namespace adaptiso::headmodel
