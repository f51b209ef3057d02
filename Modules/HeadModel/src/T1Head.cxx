#include "T1Head.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "Contrast.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadModel/SourceError.h"
#include "adaptiso/Preprocessing/LabelValues.h"

namespace adaptiso::headmodel {

Mask ballAround(std::int64_t voxel, const ImageGeometry& grid, double radiusMm) {
    Mask seed(static_cast<std::size_t>(grid.voxelCount()), 0);
    seed[voxel] = 1;
    return dilated(seed, grid, radiusMm);
}

std::vector<float> depthInHeadMm(const Mask& mask, const ImageGeometry& grid) {
    const std::int64_t least = *std::min_element(grid.size.begin(), grid.size.end());
    return depthMm(mask, grid, {(static_cast<double>(least) / 2 + 1) * stepMm(grid), 0});
}

std::int64_t deepestVoxel(const std::vector<float>& depth) {
    return std::max_element(depth.begin(), depth.end()) - depth.begin();
}

double cm3Of(const Mask& mask, const ImageGeometry& grid) {
    return static_cast<double>(voxelsIn(mask)) * std::pow(stepMm(grid), 3) / 1000;
}

std::vector<float> belowSkinMm(const Head& head) {
    constexpr double kMostMm = 16;
    Mask headAndBeyond = head.mask;
    for (std::size_t n = 0; n < headAndBeyond.size(); ++n) {
        if (head.faces[n] == 0) headAndBeyond[n] = 1;
    }
    return depthMm(headAndBeyond, head.grid, {kMostMm + 1, 0});
}

namespace {

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

}  // namespace

Head findHead(const VolumeView& t1, const BrainSources& sources, const BoundaryOptions& options,
              bool isFramed) {
    if (const auto labels = findLabelValues(t1)) {
        throw InvalidInput("holds " + std::to_string(labels->count) +
                           " labels and no grey values; give it as the label map (--labels), or "
                           "the scan that it was made of");
    }
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

}  // namespace adaptiso::headmodel
