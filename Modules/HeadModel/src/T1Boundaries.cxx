#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "BiasField.h"
#include "BrainSurface.h"
#include "Contrast.h"
#include "FinishBoundaries.h"
#include "Necks.h"
#include "SkullBand.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/HeadModel/Plausibility.h"
#include "adaptiso/HeadModel/SourceError.h"

namespace adaptiso {

using namespace headmodel;

namespace {

/// The head on its working grid.
struct Head {
    UsualHead usual;
    ImageGeometry grid;
    std::vector<float> t1;
    std::vector<std::uint8_t> faces;
    HeadLevels levels;
    double skinLevel = 0;
    Mask mask;                   ///< closed and filled
    double besideCm3 = 0;        ///< as bright as tissue, but no part of it
    double cutMm2 = 0;           ///< of its side, where tissue was taken out of the image
    BiasField bias;              ///< as it was taken out of t1
    bool isFramed = false;       ///< parts thinner than 12 mm do not belong to it
    double darkShare = 1;        ///< of what lies 6 to 16 mm below the skin: bone
    Mask lesion;                 ///< given as such; else empty
    bool isFluidBright = false;  ///< a T2
    bool isLesion(std::int64_t voxel) const { return !lesion.empty() && lesion[voxel] != 0; }
};

double medianWhere(const std::vector<float>& values, const Mask& mask) {
    std::vector<float> chosen;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (mask[n] != 0) chosen.push_back(values[n]);
    }
    if (chosen.empty()) return 0;
    std::nth_element(chosen.begin(), chosen.begin() + std::ssize(chosen) / 2, chosen.end());
    return chosen[chosen.size() / 2];
}

/// The threshold between two classes that a fixed point of means gives [Ridler1978].
double twoClassThreshold(const std::vector<float>& values) {
    double threshold =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    for (int round = 0; round < 100; ++round) {
        double sums[2] = {0, 0};
        std::int64_t counts[2] = {0, 0};
        for (const float value : values) {
            const int side = value >= threshold ? 1 : 0;
            sums[side] += value;
            ++counts[side];
        }
        if (counts[0] == 0 || counts[1] == 0) break;
        const double next =
            (sums[0] / static_cast<double>(counts[0]) + sums[1] / static_cast<double>(counts[1])) /
            2;
        if (std::abs(next - threshold) <= 1e-6 * std::abs(next)) break;
        threshold = next;
    }
    return threshold;
}

Mask ballAround(std::int64_t voxel, const ImageGeometry& grid, double radiusMm) {
    Mask seed(static_cast<std::size_t>(grid.voxelCount()), 0);
    seed[voxel] = 1;
    return dilated(seed, grid, radiusMm);
}

/// Depth inside of a mask that keeps clear of the grid's border: the border is nearer to its middle
/// than the band.
std::vector<float> depthInHeadMm(const Mask& mask, const ImageGeometry& grid) {
    const std::int64_t least = *std::min_element(grid.size.begin(), grid.size.end());
    return depthMm(mask, grid, {(static_cast<double>(least) / 2 + 1) * stepMm(grid), 0});
}

std::int64_t deepestVoxel(const std::vector<float>& depth) {
    return std::max_element(depth.begin(), depth.end()) - depth.begin();
}

Mask headMask(const Head& head, double level, double closingMm) {
    // the scalp may hang together with nothing within it, but it is all around; where a face was
    // taken out it may not enclose the brain
    Mask raw;
    if (head.isFramed) {
        constexpr double kThinMm = 6;
        // skull and scalp are thin too: what lies within them first
        const Mask tissue = filledAtBorder(closed(above(head.t1, level), head.grid, kThinMm),
                                           head.faces, head.grid.size);
        raw = dilated(largestComponent(opened(tissue, head.grid, kThinMm + 2), head.grid.size),
                      head.grid, kThinMm + 2);
        for (std::size_t n = 0; n < raw.size(); ++n) raw[n] &= tissue[n];
    } else {
        const Mask tissue = above(head.t1, level);
        raw = widestComponent(tissue, head.grid.size);
        const Mask largest = largestComponent(tissue, head.grid.size);
        for (std::size_t n = 0; n < raw.size(); ++n) raw[n] |= largest[n];
    }
    raw = closed(raw, head.grid, closingMm);
    return filledAtBorder(raw, head.faces, head.grid.size);
}

double cm3Of(const Mask& mask, const ImageGeometry& grid) {
    return static_cast<double>(voxelsIn(mask)) * std::pow(stepMm(grid), 3) / 1000;
}

/// Least volume of objects beside the head (frames, headphones); ghosts and noise have less.
constexpr double kLeastBesideCm3 = 15;

/// Finds what lies in the air and is as bright as tissue (head.besideCm3), and the skin's isovalue:
/// above the air's noise, and low, since skin is darker than what lies below.
/// \param tissue  the least of tissue
void findSkinLevel(Head& head, const Mask& rough, double tissue) {
    const HeadLevels& levels = head.levels;
    double sum = 0, squares = 0, count = 0;
    const Mask around = dilated(rough, head.grid, 5);
    const auto isAir = [&](std::size_t n) { return around[n] == 0 && head.faces[n] != 0; };
    Mask beside = above(head.t1, tissue);
    for (std::size_t n = 0; n < beside.size(); ++n)
        if (!isAir(n)) beside[n] = 0;
    head.besideCm3 = cm3Of(beside, head.grid);
    const bool hasObjects = head.besideCm3 >= kLeastBesideCm3;
    for (std::size_t n = 0; n < head.t1.size(); ++n) {
        if (!isAir(n) || (hasObjects && beside[n] != 0)) continue;
        sum += head.t1[n];
        squares += head.t1[n] * head.t1[n];
        ++count;
    }
    const double mean = count > 0 ? sum / count : levels.air;
    const double sigma = count > 0 ? std::sqrt(std::max(squares / count - mean * mean, 0.0)) : 0;
    head.skinLevel = std::max(mean + 4 * sigma, mean + 0.25 * (levels.tissue - mean));
}

/// Single samples brighter or darker than anything in a head would move every threshold. NaN
/// becomes the darkest that is left: air.
void clipSpikes(std::vector<float>& values) {
    constexpr double kSpikes = 0.0002;
    std::vector<float> sorted;
    std::copy_if(values.begin(), values.end(), std::back_inserter(sorted),
                 [](float value) { return !std::isnan(value); });
    if (sorted.empty()) throw InvalidInput("all samples are NaN");
    const auto last = static_cast<double>(sorted.size() - 1);
    const auto low = sorted.begin() + static_cast<std::ptrdiff_t>(kSpikes * last);
    const auto high = sorted.begin() + static_cast<std::ptrdiff_t>((1 - kSpikes) * last);
    std::nth_element(sorted.begin(), low, sorted.end());
    const float least = *low;
    std::nth_element(low, high, sorted.end());
    const float most = *high;
    for (float& value : values) value = std::isnan(value) ? least : std::clamp(value, least, most);
}

/// How far below the skin anybody asks for.
constexpr double kMostBelowSkinMm = 16;

/// How deep every voxel lies below the skin, up to kMostBelowSkinMm; the image's border is none.
std::vector<float> belowSkinMm(const Head& head) {
    Mask headAndBeyond = head.mask;
    for (std::size_t n = 0; n < headAndBeyond.size(); ++n) {
        if (head.faces[n] == 0) headAndBeyond[n] = 1;
    }
    return depthMm(headAndBeyond, head.grid, {kMostBelowSkinMm + 1, 0});
}

constexpr double kMostBrainCm3 = 2500;

/// Below this nobody needs to be told of a bias field (ch2: 0.79 to 1.04, darker towards its neck).
constexpr double kNotableBias = 0.3;

constexpr const char* kSkullStripped =
    "there is no skull or skin around the brain (a skull-stripped T1); give the whole T1, and this "
    "image as the brain mask";

/// Refuses an image whose skull was removed: its largest piece is no larger than a brain, and
/// nowhere near its surface is the dark of bone. A whole head shows bone on a fifth of the voxels
/// 6 to 16 mm below its skin (ch2: 31 %), a brain on sulci alone (ch2bet: 3 %). Of a child bone
/// lies higher.
void requireSkull(Head& head, const std::vector<float>& below) {
    constexpr double kLeastDark = 0.1, kBoneMm = 0.75, kBelowBoneMm = 2;  // of the way to the brain
    if (cm3Of(head.mask, head.grid) > kMostBrainCm3) return;
    const double bone = head.levels.air + 0.5 * (head.levels.tissue - head.levels.air);
    const auto darkShare = [&](double toBrainMm) {
        std::int64_t all = 0, dark = 0;
        for (std::size_t n = 0; n < below.size(); ++n) {
            if (head.mask[n] == 0 || below[n] < kBoneMm * toBrainMm ||
                below[n] > kBelowBoneMm * toBrainMm)
                continue;
            ++all;
            if (head.t1[n] < bone) ++dark;
        }
        return all > 0 ? static_cast<double>(dark) / static_cast<double>(all) : 1;
    };
    // a child's scalp may be as thick as an adult's
    head.darkShare = std::max(darkShare(UsualHead().leastBrainToSkinMm),
                              head.usual.isAdult() ? 0 : darkShare(head.usual.leastBrainToSkinMm));
    if (head.darkShare >= kLeastDark) return;
    throw InvalidInput(kSkullStripped);
}

bool isTakenOut(float sample, double least) {
    return sample == 0 || sample == static_cast<float>(least);
}

/// Where tissue ends at once at samples that are exactly 0, or the darkest: what took out a face
/// leaves none of the skin's darker layers and no partial volume. One place for each sample taken
/// out beside half the brain's level or more.
std::vector<Vec3> cutPlaces(const FloatImage& image, double least, double level) {
    const Index3& size = image.geometry.size;
    const std::array<std::int64_t, 3> stride{1, size[0], size[0] * size[1]};
    std::vector<Vec3> places;
    for (std::int64_t k = 1; k + 1 < size[2]; ++k) {
        for (std::int64_t j = 1; j + 1 < size[1]; ++j) {
            for (std::int64_t i = 1; i + 1 < size[0]; ++i) {
                const float* const at = &image.values[i + size[0] * (j + size[1] * k)];
                if (!isTakenOut(*at, least)) continue;
                if (std::none_of(stride.begin(), stride.end(), [&](std::int64_t s) {
                        return at[s] >= level || at[-s] >= level;
                    })) {
                    continue;
                }
                places.push_back(image.geometry.toPhysical(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
            }
        }
    }
    return places;
}

/// A face that was taken out is where the image ends, as at its borders: no skin is there, however
/// near the brain. Bright skin over a masked background makes single such places (ch2: 3 cm2), or
/// many all round: neither is a cut.
void findCut(Head& head, const FloatImage& image) {
    constexpr double kLeastMm2 = 1000, kMostOfSide = 0.3, kReachMm = 17;
    const double half = head.levels.air + 0.5 * (head.levels.tissue - head.levels.air);
    const Mat3 toGrid = inverse(head.grid.indexToPhysical);
    Mask cut(head.mask.size(), 0);
    for (const Vec3& place : cutPlaces(image, head.levels.air, half)) {
        const Vec3 index = toGrid * (place - head.grid.originMm);
        std::int64_t voxel = 0, stride = 1;
        for (int a = 0; a < 3; ++a) {
            voxel +=
                stride * std::clamp<std::int64_t>(std::llround(index[a]), 0, head.grid.size[a] - 1);
            stride *= head.grid.size[a];
        }
        if (head.mask[voxel] == 0) cut[voxel] = 1;
    }
    const double mm2 = static_cast<double>(voxelsIn(cut)) * std::pow(stepMm(head.grid), 2);
    if (mm2 < kLeastMm2) return;
    const auto side = static_cast<double>(sidesOf(head.mask, head.grid, head.faces).size());
    if (mm2 > kMostOfSide * side * std::pow(stepMm(head.grid), 2)) return;
    head.cutMm2 = mm2;
    const Mask beyond = dilated(cut, head.grid, kReachMm);
    for (std::size_t n = 0; n < beyond.size(); ++n) {
        if (beyond[n] != 0 && head.mask[n] == 0 && isTakenOut(head.t1[n], head.levels.air)) {
            head.faces[n] = 0;
        }
    }
    // bone and airways that the cut has opened
    head.mask = filledAtBorder(head.mask, head.faces, head.grid.size);
}

/// Tissue deep in the head is mostly brain: fat, and the dark of bone, lie above.
void takeBiasOut(Head& head, const Mask& rough, const std::vector<float>& depth, double level) {
    constexpr float kDeepMm = 10;
    Mask tissue(rough.size());
    for (std::size_t n = 0; n < tissue.size(); ++n) {
        const bool isTissue = rough[n] != 0 && depth[n] > kDeepMm && head.t1[n] > level;
        tissue[n] = isTissue && !head.isLesion(n) ? 1 : 0;
    }
    head.bias = BiasField::estimated(head.t1, head.levels.air, tissue, head.grid);
    head.bias.removeFrom(head.t1, head.levels.air, head.grid.size);
}

/// The lesion on the head's grid.
Mask lesionOf(const VolumeView& lesion, const Head& head) {
    const FloatImage parts = indicator(lesion, [](double value) { return value > 0; });
    Mask mask = above(resampled(parts, head.grid, 0), kFractionIsovalue);
    if (voxelsIn(mask) == 0)
        throw SourceError(BoundarySource::Lesion, "the lesion mask holds nothing in this head");
    return mask;
}

Head findHead(const VolumeView& t1, const BrainSources& sources, const BoundaryOptions& options,
              bool isFramed) {
    FloatImage image = toFloat(t1, std::numeric_limits<float>::quiet_NaN());
    clipSpikes(image.values);
    backgroundToAir(image);
    const auto [air, brightest] = std::minmax_element(image.values.begin(), image.values.end());
    if (!std::isfinite(*brightest - *air)) {
        throw InvalidInput("many samples are infinite");
    }
    if (!(*air < *brightest)) {
        throw InvalidInput("all samples are equal; there is no head");
    }
    const double rough = twoClassThreshold(image.values);
    Index3 first, last;
    boundingIndices(image.values, image.geometry.size, rough, first, last);
    // a bright ghost in the air may widen the box: that costs time, no more
    constexpr std::int64_t kSoftVoxels = 10;  // skin below the rough threshold
    for (int a = 0; a < 3; ++a) {
        first[a] = std::max<std::int64_t>(first[a] - kSoftVoxels, 0);
        last[a] = std::min<std::int64_t>(last[a] + kSoftVoxels, image.geometry.size[a] - 1);
    }
    Head head;
    head.isFramed = isFramed;
    head.usual = UsualHead(options.ageYears);
    head.grid = workingGrid(image.geometry, first, last, options.stepMm, marginMm(options));
    head.t1 = resampled(image, head.grid, *air);
    head.faces = imageFaces(image.geometry, head.grid);
    if (sources.lesion) head.lesion = lesionOf(*sources.lesion, head);

    Mask roughMask = headMask(head, rough, options.closingMm);
    std::vector<float> depth = depthInHeadMm(roughMask, head.grid);
    const std::int64_t middle = deepestVoxel(depth);
    const double leastMm = head.usual.ageYears < 1 ? 60 : 80;
    if (!(2 * depth[middle] >= leastMm)) {
        throw InvalidInput(
            "the largest object is " + shortNumber(2 * std::max(depth[middle], 0.0f)) +
            " mm thick; a head is " + shortNumber(leastMm) + " mm or more (a mask? wrong units?)");
    }
    head.levels.air = *air;
    takeBiasOut(head, roughMask, depth, rough);
    freeMemory(depth);
    Mask sound = ballAround(middle, head.grid, 35);
    for (std::size_t n = 0; n < head.lesion.size(); ++n) {
        if (head.lesion[n] != 0) sound[n] = 0;
    }
    head.levels.tissue = medianWhere(head.t1, sound);
    freeMemory(sound);
    findSkinLevel(head, roughMask, rough);
    freeMemory(roughMask);
    head.mask = headMask(head, head.skinLevel, options.closingMm);
    const std::vector<float> below = belowSkinMm(head);
    requireSkull(head, below);
    head.isFluidBright = isFluidBright(head.t1, below, head.grid, head.levels);
    findCut(head, image);
    return head;
}

/// The part of `brain` that lies nearer to the skin than `mm`, or outside of it.
double partAtSkin(const Mask& brain, const std::vector<float>& belowSkin, double mm) {
    std::int64_t near = 0;
    for (std::size_t n = 0; n < brain.size(); ++n) {
        if (brain[n] != 0 && belowSkin[n] < mm) ++near;
    }
    return static_cast<double>(near) / static_cast<double>(voxelsIn(brain));
}

/// Checks that a brain has a possible size and does not touch the skin.
bool isPlausibleBrain(const Mask& brain, const Head& head, const std::vector<float>& belowSkin) {
    // scalp and skull are thicker together; on a T2 CSF, which touches the skull, is in it
    const double nearestMm =
        std::min(head.usual.leastBrainToSkinMm, head.isFluidBright ? 5.0 : 8.0);
    const double cm3 = cm3Of(brain, head.grid);
    return cm3 >= std::min(500.0, 0.7 * head.usual.leastInnerSkullCm3) && cm3 <= kMostBrainCm3 &&
           partAtSkin(brain, belowSkin, nearestMm) <= 0.001;
}

/// A mask of something else, or in another place. Looser than what is asked of a guess: brain
/// extractions leave this and that at the rim.
void requirePlausibleMask(const Mask& brain, const Head& head,
                          BoundarySource source = BoundarySource::BrainMask) {
    const std::string name =
        source == BoundarySource::Lesion ? "the lesion mask" : "the brain mask";
    constexpr double kLeastCm3 = 200, kMostAtSkin = 0.02;
    const double nearestMm = head.usual.leastBrainToSkinMm / 2;
    const double cm3 = cm3Of(brain, head.grid);
    if (!(cm3 >= kLeastCm3 && cm3 <= kMostBrainCm3)) {
        throw SourceError(source, name + " holds " + shortNumber(cm3) +
                                      " cm3, must be 200 to 2500 cm3; is it a mask of the brain?");
    }
    const double part = partAtSkin(brain, belowSkinMm(head), nearestMm);
    if (part > kMostAtSkin) {
        throw SourceError(source, name + " lies to " + shortNumber(100 * part) +
                                      " % outside the head or within " + shortNumber(nearestMm) +
                                      " mm of its skin; is it of this head, in the same space?");
    }
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

/// The brain by thresholds and morphology: the first that is plausible, or one not much thinner
/// that muscle has fallen off. Empty where none is.
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

/// Why there is no guess of the brain.
std::string noBrainText(const Head& head) {
    constexpr double kUsuallyDark = 0.18;  // stripped images with wide sulci: up to 12 %
    if (head.isFluidBright) {
        return "CSF is brighter than brain (a T2-weighted image?), and no brain comes loose by "
               "thresholds; give a T1, or a brain mask";
    }
    if (head.darkShare < kUsuallyDark) return kSkullStripped;
    return std::string("no brain comes loose by thresholds") +
           (head.besideCm3 >= kLeastBesideCm3 ? " (something lies beside the head: a stereotactic "
                                                "frame, headphones?)"
                                              : "") +
           "; give a brain mask";
}

/// The brain mask of the caller on the head's grid.
std::vector<float> brainPart(const VolumeView& brainMask, const Head& head) {
    const ValueRange range = valueRange(brainMask);
    if (!(range.maximum > 0))
        throw SourceError(BoundarySource::BrainMask, "the brain mask is empty");
    // a skull-stripped image is a mask where it is not zero; a mask of parts is cut at one half
    const bool isImage = range.maximum > 1 && !std::isnan(range.minimum) && [&] {
        const FloatImage values = toFloat(brainMask, 0);
        return std::any_of(values.values.begin(), values.values.end(),
                           [&](float v) { return v > 0 && v < range.maximum; });
    }();
    const double least = isImage ? 0 : range.maximum / 2;
    FloatImage parts = indicator(brainMask, [&](double value) { return value > least; });
    if (!isImage && range.maximum <= 1) parts = toFloat(brainMask, 0);
    std::vector<float> part = resampled(parts, head.grid, 0);
    if (voxelsIn(above(part, kFractionIsovalue)) == 0) {
        throw SourceError(BoundarySource::BrainMask,
                          "the brain mask lies outside the head's image");
    }
    return part;
}

/// Where a guess took the dura for brain, since a contrast agent made it as bright: the part of the
/// guess's rim that is bright, within 6 mm. Empty without an agent. Then 4 to 20 % of the rim are
/// bright, .23 to .39 of what is in the cortex below (ch2 and copies of it with noise, bias,
/// lesions, an infant's skull); with a bright dura 37 to 66 %, .96 to 2.3 of it. Where grey matter
/// is so dark that white matter alone is found, as at 7 T, 36 %, .71 of it. Brains without a cortex
/// (phantoms) and newborns', whose cortex is the brighter, say nothing.
std::vector<float> duraShare(const Mask& guess, const Head& head) {
    constexpr double kRimMm = 1.5, kBright = 0.9, kLeastShare = 0.25, kLeastRatio = 0.8;
    constexpr double kMostBrightCortex = 0.8, kSpreadMm = 6, kLeastYears = 1;
    if (head.usual.ageYears < kLeastYears) return {};
    const double bright = std::lerp(head.levels.air, head.levels.tissue, kBright);
    const std::vector<float> depth = depthMm(guess, head.grid, DepthBand::within(3 * kRimMm));
    std::vector<float> rim(depth.size()), dura(depth.size());
    double cortex = 0, brightCortex = 0;
    for (std::size_t n = 0; n < depth.size(); ++n) {
        if (!(depth[n] > 0 && depth[n] <= 2 * kRimMm)) continue;
        const float isBright = head.t1[n] > bright ? 1 : 0;
        if (depth[n] <= kRimMm) {
            rim[n] = 1;
            dura[n] = isBright;
        } else {
            ++cortex;
            brightCortex += isBright;
        }
    }
    const double rimShare = std::accumulate(dura.begin(), dura.end(), 0.0) /
                            std::max(std::accumulate(rim.begin(), rim.end(), 0.0), 1.0);
    const double cortexShare = brightCortex / std::max(cortex, 1.0);
    if (rimShare < std::max(kLeastShare, kLeastRatio * cortexShare) ||
        cortexShare > kMostBrightCortex)
        return {};
    rim = smoothed(std::move(rim), head.grid, kSpreadMm);
    dura = smoothed(std::move(dura), head.grid, kSpreadMm);
    for (std::size_t n = 0; n < dura.size(); ++n) {
        dura[n] = rim[n] > 1e-6F ? std::clamp(dura[n] / rim[n], 0.0F, 1.0F) : 0;
    }
    return dura;
}

/// The brain without gaps, and what the image cuts off.
Mask wholeBrain(const Mask& brain, const Head& head, double closingMm) {
    return filledAtBorder(closed(largestComponent(brain, head.grid.size), head.grid, closingMm),
                          head.faces, head.grid.size);
}

/// With what is bright in dents of the brain: sinuses, by a contrast agent.
Mask withSinuses(Mask brain, const Head& head) {
    constexpr double kBright = 1.2, kDentMm = 20;
    const Mask bright = above(head.t1, std::lerp(head.levels.air, head.levels.tissue, kBright));
    const Mask around = wholeBrain(brain, head, kDentMm);
    for (std::size_t n = 0; n < brain.size(); ++n) {
        if (bright[n] && around[n]) brain[n] = 1;
    }
    return brain;
}

/// The inner skull: the brain, closed and grown by the CSF around it, kept below the scalp. A guess
/// that holds the dura ends there already.
std::vector<float> innerSkullPart(const Mask& brain, const Head& head, bool isGuess,
                                  const BoundaryOptions& options, std::vector<std::string>& notes) {
    const double step = stepMm(head.grid);
    const double csfMm = isGuess && head.isFluidBright ? 0 : options.csfMm;
    Mask whole = wholeBrain(brain, head, options.closingMm);
    std::vector<float> dura;
    if (isGuess && !head.isFluidBright) dura = duraShare(whole, head);
    if (!dura.empty()) {
        notes.push_back(
            "the dura is as bright as brain (a contrast agent?): no CSF is added to the guessed "
            "brain where it is");
        whole = wholeBrain(withSinuses(brain, head), head, options.closingMm);
    }
    const double wall = options.minSkullMm + options.minScalpMm;
    std::vector<float> part = depthMm(whole, head.grid, {step, csfMm + step});
    const std::vector<float> below = depthMm(head.mask, head.grid, {wall + step, step});
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            // where half of the rim is bright, the other half is dura in partial volumes
            const double csf = dura.empty() ? csfMm : csfMm * (1 - std::min(1.0F, 2 * dura[n]));
            const float grown = partAtDepth(part[n] + csf, step);
            const double room = below[n] - options.minSkullMm - options.minScalpMm;
            part[n] =
                std::max(partAtDepth(part[n], step), std::min(grown, partAtDepth(room, step)));
        }
    });
    return part;
}

/// Where tissue meets the air around the head: not in the airways, nor where the image ends.
std::vector<Vec3> skinSides(const Head& head) {
    Mask tissue = above(head.t1, head.skinLevel);
    for (std::size_t n = 0; n < tissue.size(); ++n) tissue[n] &= head.mask[n];
    return sidesOf(filledAtBorder(tissue, head.faces, head.grid.size), head.grid, head.faces);
}

/// The brain by what is known of it, or guessed.
Mask brainOf(const BrainSources& sources, const Head& head, Mask guess, RawBoundaries& raw) {
    const bool isGuess = !sources.mask && !sources.aseg;
    Mask brain = sources.mask   ? above(brainPart(*sources.mask, head), kFractionIsovalue)
                 : sources.aseg ? above(asegPart(*sources.aseg, head.grid), kFractionIsovalue)
                                : std::move(guess);
    if (!isGuess) requirePlausibleMask(brain, head);
    if (!head.lesion.empty()) {
        for (std::size_t n = 0; n < brain.size(); ++n) brain[n] |= head.lesion[n];
        requirePlausibleMask(brain, head, BoundarySource::Lesion);
    }
    if (!sources.pial.empty()) {
        const Mask pial = above(pialPart(sources.pial, head.grid), kFractionIsovalue);
        for (std::size_t n = 0; n < brain.size(); ++n) brain[n] |= pial[n];
    }
    const std::string cm3 = shortNumber(cm3Of(brain, head.grid)) + " cm3";
    if (isGuess) {
        raw.warnings.push_back({"guessed-brain", "the brain was guessed by thresholds (" + cm3 +
                                                     "); look at it, or give a brain mask"});
    } else {
        raw.notes.push_back("brain mask: " + cm3);
    }
    return brain;
}

std::string percentOf(double share) {
    return shortNumber(std::round(100 * share)) + " %";
}

/// A brain was found, but not all of it: no sign of an infant.
class LostBrain : public InvalidInput {
    using InvalidInput::InvalidInput;
};

/// Checks the inner skull's place by the tissue around it. Right ones have 2 to 8 % of
/// rays that begin in tissue (at the temples and the base), brains that lost a part 13 to 60 %.
void requireBandInSight(const SkullBand& band, bool isGuess, std::vector<Warning>& warnings) {
    constexpr double kUsuallySeen = 0.6, kUsuallyInTissue = 0.12, kMostInTissue = 0.3;
    constexpr double kLeastSeen = 0.2;       // stripped images: 0 to 5 %
    constexpr double kMostUnseenMm2 = 2500;  // ch2 and copies of it: at most 21 cm2; a flap: 37
    if (band.seenFraction < kLeastSeen) {
        throw InvalidInput("the skull shows on " + percentOf(band.seenFraction) +
                           " of the rays from the brain outwards: " + kSkullStripped);
    }
    if (isGuess && band.tissueFraction > kMostInTissue) {
        throw LostBrain("a part of the brain is lost by thresholds: outside what was found, " +
                        percentOf(band.tissueFraction) +
                        " of the rays to the scalp begin in 4 mm of tissue as bright as brain; "
                        "give a brain mask, or of a child below 5 years --age");
    }
    if (band.tissueFraction > kUsuallyInTissue) {
        warnings.push_back(
            {"brain-doubtful",
             percentOf(band.tissueFraction) +
                 " of the rays to the scalp begin in 4 mm of tissue as bright as brain, "
                 "2 to 8 % are usual: a part of the brain may be lost, or muscle taken "
                 "for it; look at the result, or give a better brain mask"});
    }
    if (band.seenFraction < kUsuallySeen) {
        warnings.push_back(
            {"skull-unseen",
             "the skull shows on only " + shortNumber(100 * band.seenFraction) +
                 " % of the rays to the scalp: the brain or its mask may lie wrong, or "
                 "the image be too noisy; look at the result"});
    }
    if (band.unseenMm2 > kMostUnseenMm2) {
        const Vec3& p = band.unseenMm;
        const auto text = [](double mm) { return shortNumber(std::round(mm)); };
        warnings.push_back(
            {"skull-unseen",
             "the skull does not show on " + shortNumber(std::round(band.unseenMm2 / 100)) +
                 " cm2 in one piece, around (" + text(-p.x) + ", " + text(-p.y) + ", " + text(p.z) +
                 ") mm RAS: a hole (craniotomy), a lesion at the cortex, a dura as bright as brain "
                 "(a contrast agent), or a brain that is wrong there; look at the result"});
    }
}

/// Thresholds are made for brains whose levels lie within a third of each other: within the inner
/// skull of ch2, with noise, a bias field, or an infant's size, quartiles lie 0.28 to 0.30 of the
/// median apart; with 7 T contrast 0.52, and what is dark is lost.
void warnOfContrast(const std::vector<float>& innerSkull, const Head& head,
                    std::vector<Warning>& warnings) {
    constexpr double kRimMm = 6, kWide = 0.42;
    const Mask deep = eroded(above(innerSkull, kFractionIsovalue), head.grid, kRimMm);
    std::vector<float> levels;
    for (std::size_t n = 0; n < deep.size(); ++n) {
        if (deep[n] != 0) levels.push_back(head.t1[n]);
    }
    if (levels.empty()) return;
    const auto quartile = [&](std::size_t quarters) {
        const auto at =
            levels.begin() + static_cast<std::ptrdiff_t>((levels.size() - 1) * quarters / 4);
        std::nth_element(levels.begin(), at, levels.end());
        return *at - head.levels.air;
    };
    const double middle = quartile(2);
    if (!(middle > 0)) return;
    const double spread = (quartile(3) - quartile(1)) / middle;
    if (spread <= kWide) return;
    warnings.push_back({"brain-doubtful",
                        "the brain's levels spread by " + percentOf(spread) +
                            " between quartiles, some 30 % are usual (the contrast of 7 T, large "
                            "ventricles?): what is dark may be lost; look at the result, or give a "
                            "brain mask"});
}

}  // namespace

HeadBoundaries boundariesFromT1(const VolumeView& t1, const std::optional<VolumeView>& brainMask,
                                const BoundaryOptions& options) {
    BrainSources sources;
    sources.mask = brainMask;
    return boundariesFromT1(t1, sources, options);
}

namespace {

HeadBoundaries foundInT1(const VolumeView& t1, const BrainSources& sources,
                         const BoundaryOptions& asked) {
    checkOptions(asked);
    BoundaryOptions options = asked;
    if (options.skullMm == 0) options.skullMm = UsualHead(options.ageYears).skullMm;
    if (!(options.skullMm >= options.minSkullMm && options.skullMm <= options.maxSkullMm)) {
        throw InvalidInput("skullMm is " + shortNumber(options.skullMm) +
                           " mm, must be minSkullMm to maxSkullMm");
    }
    tell(options, "head", 0);
    const bool isGuess = !sources.mask && !sources.aseg;
    Head head = findHead(t1, sources, options, false);
    tell(options, "brain", 0);
    Mask guess;
    if (isGuess) {
        const UsualHead own = head.usual;
        // what keeps an adult's distance from the skin holds less scalp than what keeps a child's
        head.usual.leastBrainToSkinMm = UsualHead().leastBrainToSkinMm;
        guess = guessedBrain(head);
        head.usual = own;
        if (guess.empty() && !own.isAdult()) guess = guessedBrain(head);
        if (guess.empty()) {
            // a stereotactic frame, a coil or a pad that is as bright as tissue
            Head bare = findHead(t1, sources, options, true);
            guess = guessedBrain(bare);
            if (!guess.empty()) head = std::move(bare);
        }
        if (guess.empty()) throw InvalidInput(noBrainText(head));
    }
    RawBoundaries raw;
    raw.grid = head.grid;
    raw.notes.push_back("skin at " + shortNumber(head.skinLevel) + ", brain tissue at " +
                        shortNumber(head.levels.tissue));
    if (head.bias.most() - head.bias.least() > kNotableBias) {
        raw.notes.push_back("the same tissue is " + shortNumber(head.bias.least()) + " to " +
                            shortNumber(head.bias.most()) +
                            " times as bright as usual from place to place (a bias field): taken "
                            "out for this model, not in the image");
    }
    if (head.isFramed) {
        raw.notes.push_back(
            "what is thinner than 12 mm was left aside (a stereotactic frame, a coil?)");
    }
    if (head.besideCm3 >= kLeastBesideCm3) {
        raw.notes.push_back(shortNumber(head.besideCm3) +
                            " cm3 beside the head are as bright as tissue (a stereotactic frame, "
                            "headphones?): left aside");
    }
    if (head.cutMm2 > 0) {
        raw.notes.push_back("about " + shortNumber(head.cutMm2 / 100) +
                            " cm2 of the head's side are cut (a face taken out?): no skin is seen "
                            "there");
    }
    if (head.isFluidBright) {
        if (options.withBrain && !sources.aseg && sources.pial.empty()) {
            throw InvalidInput(
                "CSF is brighter than brain (a T2-weighted image): it does not show where the "
                "brain ends by itself; give --aseg or --pial, or a T1");
        }
        raw.warnings.push_back(
            {"t2-weighted", std::string("CSF is brighter than brain (a T2-weighted image?): ") +
                                (isGuess ? "what is bright within the skull was taken for brain "
                                           "and CSF"
                                         : "the brain is the mask's") +
                                "; look at the result, or give a T1"});
    }
    Mask brain = brainOf(sources, head, std::move(guess), raw);
    raw.parts.push_back(innerSkullPart(brain, head, isGuess, options, raw.notes));
    if (isGuess && !head.isFluidBright) warnOfContrast(raw.parts[0], head, raw.warnings);
    cutNecks(raw, options);
    if (options.withBrain) {
        raw.brain = brainSurfacePart(sources, {head.grid, head.t1, head.faces, head.levels, brain},
                                     options, raw.notes, raw.brainSeenMm);
    }
    freeMemory(brain);
    tell(options, "skull", 0);
    SkullBand band =
        findSkullBand(head.t1, head.grid, smoothed(raw.parts[0], head.grid, options.smoothingMm),
                      head.mask, head.faces, head.levels, options);
    if (UsualHead(options.ageYears).isSkullThin()) {  // rays look through it into the scalp
        band.tissueFraction = 0;
        raw.notes.push_back(
            "at this age the skull is too thin to show holes or that brain is lost: look at the "
            "inner skull");
    }
    requireBandInSight(band, isGuess, raw.warnings);
    if (!options.innerSkullOnly) {
        raw.notes.push_back("skull band seen on " + shortNumber(100 * band.seenFraction) +
                            " % of the rays to the scalp, median thickness " +
                            shortNumber(band.medianThicknessMm) + " mm; elsewhere " +
                            shortNumber(options.skullMm) + " mm");
        // no T1 shows the inner skull: CSF and bone are dark alike
        raw.seenMm = {{}, std::move(band.seenMm), skinSides(head)};
        raw.parts.push_back(std::move(band.outerSkull));
        raw.parts.push_back(partByLevel(head.mask, head.t1, head.skinLevel, head.levels.air,
                                        head.faces, head.grid));
        head = Head();  // a whole head's worth of memory
        limitOuterSkull(raw, options);
    }
    return finished(std::move(raw), options);
}

/// An infant's head by an infant's limits, where an adult's give none.
bool isInfant(const VolumeView& t1, const BrainSources& sources, BoundaryOptions options) {
    constexpr double kYears = 0.25, kMostCm3 = 1550;  // of 2 years
    options.ageYears = kYears;
    options.innerSkullOnly = true;
    options.withBrain = false;
    try {
        const HeadBoundaries found = foundInT1(t1, sources, options);
        const FractionField& solid = found.solids.front();
        return cm3Of(above(solid.part, kFractionIsovalue), solid.grid) < kMostCm3;
    } catch (const InvalidInput&) {
        return false;
    }
}

}  // namespace

HeadBoundaries boundariesFromT1(const VolumeView& t1, const BrainSources& sources,
                                const BoundaryOptions& options) {
    try {
        return foundInT1(t1, sources, options);
    } catch (const SourceError&) {
        throw;
    } catch (const LostBrain&) {
        throw;
    } catch (const InvalidInput&) {
        if (!UsualHead(options.ageYears).isAdult() || !isInfant(t1, sources, options)) throw;
    }
    throw InvalidInput(
        "no adult's brain is found, but an infant's (small, near the skin): give --age in years, "
        "or of an adult another brain mask");
}

}  // namespace adaptiso
