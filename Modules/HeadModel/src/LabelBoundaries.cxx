#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "BrainSurface.h"
#include "FinishBoundaries.h"
#include "Necks.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadModel/SourceError.h"

namespace adaptiso {

using namespace headmodel;

namespace {

/// Closing of the inner and outer skull of a segmentation: cracks between tissues, thin canals.
constexpr double kSeamMm = 3;

/// Whether a sample of a label map is one of a list (or, with `others`, of none of the rest).
bool holds(const std::vector<std::int64_t>& list, double sample) {
    return std::any_of(list.begin(), list.end(),
                       [&](std::int64_t label) { return sample == static_cast<double>(label); });
}

/// Interpolated slices of thick voxels need more smoothing than their grid has.
double sigmaFor(const ImageGeometry& image, const BoundaryOptions& options) {
    const Vec3 spacing = image.spacingMm();
    return std::max(options.smoothingMm, 0.6 * std::max({spacing.x, spacing.y, spacing.z}));
}

/// Tissues in another order than they were named give a model as well, but of no head: most of a
/// layer must lie outside of the solid within it, and in its own.
void requireOrder(const std::vector<FloatImage>& enclosed, const RawBoundaries& raw) {
    constexpr std::array<const char*, 3> kTissue{"brain", "skull", "scalp"};
    for (std::size_t n = 1; n < enclosed.size(); ++n) {
        FloatImage layer = enclosed[n];
        for (std::size_t v = 0; v < layer.values.size(); ++v) {
            layer.values[v] -= enclosed[n - 1].values[v];
        }
        const std::vector<float> part = resampled(layer, raw.grid, 0);
        double all = 0, inner = 0, own = 0;
        for (std::size_t v = 0; v < part.size(); ++v) {
            all += part[v];
            if (raw.parts[n - 1][v] >= kFractionIsovalue) inner += part[v];
            if (raw.parts[n][v] >= kFractionIsovalue) own += part[v];
        }
        const std::string tissue = kTissue[n], within = kTissue[n - 1];
        if (inner > 0.5 * all) {
            throw InvalidInput("most of the " + tissue + " lies inside the " + within +
                               "; are the tissues named in the right order?");
        }
        if (own < 0.5 * all) {
            throw InvalidInput("most of the " + tissue + " hangs together with no " + within +
                               "; are the tissues named in the right order?");
        }
    }
}

/// All of an image that is not 0, besides what is there.
void unite(FloatImage& solid, const VolumeView& mask) {
    const FloatImage more = indicator(mask, [](double sample) { return sample != 0; });
    for (std::size_t v = 0; v < solid.values.size(); ++v) {
        solid.values[v] = std::max(solid.values[v], more.values[v]);
    }
}

/// \param enclosed  by inner skull, outer skull and skin
SegmentedHead segmentedHead(const std::vector<FloatImage>& enclosed) {
    SegmentedHead head;
    head.grid = enclosed[0].geometry;
    const double voxelMm3 = std::abs(determinant(head.grid.indexToPhysical));
    for (std::size_t n = 0; n < enclosed.size(); ++n) {
        double sum = 0;
        for (const float part : enclosed[n].values) sum += part;
        head.enclosedMm3[n] = voxelMm3 * sum;
    }
    head.isSkull.resize(enclosed[0].values.size());
    for (std::size_t v = 0; v < head.isSkull.size(); ++v) {
        head.isSkull[v] =
            enclosed[1].values[v] - enclosed[0].values[v] >= kFractionIsovalue ? 1 : 0;
    }
    return head;
}

/// \param enclosed  by inner skull, outer skull and skin
/// \param inner     by the surfaces wanted within these, from outside in: brain, white matter
HeadBoundaries boundariesFrom(std::vector<FloatImage> enclosed, std::vector<FloatImage> inner,
                              BoundaryOptions options) {
    const ImageGeometry image = enclosed.front().geometry;
    Index3 first, last;
    if (!boundingIndices(enclosed.back().values, enclosed.back().geometry.size, kFractionIsovalue,
                         first, last)) {
        throw InvalidInput("the head is empty");
    }
    std::optional<SegmentedHead> segmented;
    if (enclosed.size() == 3) segmented = segmentedHead(enclosed);
    RawBoundaries raw;
    raw.grid = workingGrid(image, first, last, options.stepMm, marginMm(options));
    const std::vector<std::uint8_t> faces = imageFaces(image, raw.grid);
    for (std::size_t n = 0; n < enclosed.size(); ++n) {
        tell(options, "boundaries", static_cast<double>(n) / static_cast<double>(enclosed.size()));
        const bool isSkin = n == 2;
        raw.parts.push_back(
            solidOf(resampled(enclosed[n], raw.grid, 0), raw.grid, faces,
                    isSkin ? options.closingMm : std::min(kSeamMm, options.closingMm)));
    }
    for (const FloatImage& one : enclosed) {
        raw.seenMm.push_back(sidesOf(
            largestComponent(above(resampled(one, raw.grid, 0), kFractionIsovalue), raw.grid.size),
            raw.grid, faces));
    }
    for (const FloatImage& one : inner) {
        std::vector<float> part = resampled(one, raw.grid, 0);
        raw.innerSeenMm.push_back(sidesOf(above(part, kFractionIsovalue), raw.grid, faces));
        raw.inner.push_back(
            raw.inner.empty()
                ? solidOf(std::move(part), raw.grid, faces, options.sulciMm)
                : whiteSolid(std::move(part), raw.grid, faces, options.sulciMm, raw.notes));
    }
    freeMemory(inner);
    requireOrder(enclosed, raw);
    freeMemory(enclosed);  // what follows takes memory of its own
    cutNecks(raw, options);
    if (raw.parts.size() > 1) limitOuterSkull(raw, options);
    options.smoothingMm = sigmaFor(image, options);
    HeadBoundaries boundaries = finished(std::move(raw), options);
    boundaries.segmented = std::move(segmented);
    return boundaries;
}

void requireDistinct(const TissueLabels& tissues) {
    std::set<std::int64_t> seen;
    for (const auto* list :
         {&tissues.white, &tissues.brain, &tissues.csf, &tissues.skull, &tissues.scalp}) {
        for (const std::int64_t label : *list) {
            if (!seen.insert(label).second) {
                throw InvalidInput("label " + std::to_string(label) + " is named twice");
            }
        }
    }
    for (const std::int64_t label : tissues.spongy) {
        const bool isSkull = std::ranges::find(tissues.skull, label) != tissues.skull.end();
        if (!isSkull && !seen.insert(label).second) {
            throw InvalidInput("label " + std::to_string(label) + " is named twice");
        }
    }
}

void requireSome(const FloatImage& more, const FloatImage* less, const char* tissue) {
    for (std::size_t n = 0; n < more.values.size(); ++n) {
        if (more.values[n] > (less != nullptr ? less->values[n] : 0.0f)) return;
    }
    throw InvalidInput(std::string("the image holds no label of the tissue ") + tissue);
}

/// FreeSurfer's colour table: white matter of cerebrum and cerebellum, brain stem, ventral DC,
/// corpus callosum, fornix, hypointensities, those of wmparc; deep grey matter and ventricles,
/// which lie within it. Hippocampus and amygdala are grey.
std::vector<std::int64_t> freeSurferWhite() {
    std::vector<std::int64_t> labels{2,   41,  7,   46,  16,  28,  60,   77,   78, 79, 192,
                                     250, 251, 252, 253, 254, 255, 5001, 5002,          // white
                                     10,  49,  11,  50,  12,  51,  13,   52,   26, 58,  // deep grey
                                     4,   43,  5,   44,  14,  15,  31,   63,   72};  // ventricles
    for (std::int64_t label = 3000; label < 5000; ++label) labels.push_back(label);
    return labels;
}

const std::vector<std::pair<std::string, TissueLabels>>& presets() {
    // 165 Skull, 258 Head-ExtraCerebral, 259 Eye-Fluid; 24 CSF, 257 CSF-ExtraCerebral
    static const TissueLabels kFreeSurfer{{},   {165},     {258, 259},
                                          true, {24, 257}, freeSurferWhite()};
    static const std::vector<std::pair<std::string, TissueLabels>> kPresets{
        // SimNIBS 4: 1 white, 2 grey, 3 CSF, 4 bone, 5 scalp, 6 eyes, 7 compact and 8 spongy bone,
        // 9 blood, 10 muscle
        {"charm", {{2}, {4, 7, 8}, {5, 6, 10}, false, {3, 9}, {1}}},
        // SimNIBS 3: the first six alone
        {"headreco", {{2}, {4}, {5, 6}, false, {3}, {1}}},
        // GRACE: 1 white, 2 grey, 3 eyes, 4 CSF, 5 air, 6 blood, 7 cancellous and 8 cortical bone,
        // 9
        // skin, 10 fat, 11 muscle. Blood is that of vessels in the skull and outside of it; air
        // that
        // of sinuses: neither has a side
        {"grace", {{2}, {7, 8}, {3, 9, 10, 11}, false, {4}, {1}}},
        {"aseg", kFreeSurfer},
        {"samseg", kFreeSurfer},
        {"synthseg", kFreeSurfer},
        // class_map["total"] of TotalSegmentator 2
        {"totalsegmentator", {{90}, {91}, {}, false, {}}},
    };
    return kPresets;
}

}  // namespace

std::vector<std::string> tissuePresetNames() {
    std::vector<std::string> names;
    for (const auto& [name, labels] : presets()) names.push_back(name);
    return names;
}

TissueLabels tissuePreset(std::string_view name) {
    for (const auto& [own, labels] : presets()) {
        if (own == name) return labels;
    }
    throw InvalidInput("tissuePreset: '" + std::string(name) + "' is no preset");
}

HeadBoundaries boundariesFromLabels(const VolumeView& labels, const TissueLabels& tissues,
                                    const BoundaryOptions& options,
                                    const std::optional<VolumeView>& headMask) {
    checkOptions(options);
    requireDistinct(tissues);
    if (headMask && headMask->geometry() != labels.geometry()) {
        throw SourceError(BoundarySource::HeadMask,
                          "the head mask is on another grid than the labels");
    }
    const auto isBrain = [&](double sample) {
        if (holds(tissues.brain, sample) || holds(tissues.white, sample)) return true;
        return tissues.othersAreBrain && sample != 0 && !std::isnan(sample) &&
               !holds(tissues.csf, sample) && !holds(tissues.skull, sample) &&
               !holds(tissues.spongy, sample) && !holds(tissues.scalp, sample);
    };
    const auto isInCavity = [&](double sample) {
        return isBrain(sample) || holds(tissues.csf, sample);
    };
    const auto isInSkull = [&](double sample) {
        return isInCavity(sample) || holds(tissues.skull, sample) || holds(tissues.spongy, sample);
    };
    std::vector<FloatImage> inner, enclosed{indicator(labels, isInCavity)};
    requireSome(enclosed[0], nullptr, "brain");
    if (options.innerSurfaces > 0) {
        inner.push_back(indicator(labels, isBrain));
        requireSome(inner[0], nullptr, "brain");
        requireSome(enclosed[0], inner.data(), "CSF");
    }
    if (options.innerSurfaces > 1) {
        inner.push_back(
            indicator(labels, [&](double sample) { return holds(tissues.white, sample); }));
        requireSome(inner[1], nullptr, "white matter");
        requireSome(inner[0], &inner[1], "brain besides white matter");
    }
    if (!options.innerSkullOnly) {
        enclosed.push_back(indicator(labels, isInSkull));
        requireSome(enclosed[1], &enclosed[0], "skull");
        enclosed.push_back(indicator(labels, [&](double sample) {
            return isInSkull(sample) || holds(tissues.scalp, sample);
        }));
        if (headMask) unite(enclosed[2], *headMask);
        requireSome(enclosed[2], &enclosed[1], "scalp");
    }
    HeadBoundaries boundaries = boundariesFrom(std::move(enclosed), std::move(inner), options);
    if (boundaries.segmented && !tissues.spongy.empty()) {
        const FloatImage spongy =
            indicator(labels, [&](double sample) { return holds(tissues.spongy, sample); });
        requireSome(spongy, nullptr, "spongy bone");
        boundaries.segmented->isSpongy.assign(spongy.values.begin(), spongy.values.end());
    }
    return boundaries;
}

HeadBoundaries boundariesFromProbabilities(std::span<const VolumeView> maps,
                                           const BoundaryOptions& options) {
    checkOptions(options);
    constexpr std::size_t kTissueMaps = 2, kBrainMaps = 3, kMaps = 5;
    const std::size_t needed = options.innerSkullOnly ? kBrainMaps : kMaps;
    if (maps.size() < needed) {
        throw InvalidInput("there are " + std::to_string(maps.size()) + " maps, must be " +
                           std::to_string(needed) +
                           " or more (c1 grey, c2 white, c3 CSF, c4 "
                           "skull, c5 scalp)");
    }
    double full = 1;
    for (std::size_t n = 0; n < needed; ++n) {
        if (maps[n].geometry() != maps[0].geometry()) {
            throw InvalidInput("map " + std::to_string(n + 1) +
                               " is on another grid than the first");
        }
        full = std::max(full, valueRange(maps[n]).maximum);
    }
    std::vector<FloatImage> enclosed, inner;
    const auto scaled = [&](FloatImage image) {
        for (float& value : image.values) {
            value = std::clamp(value / static_cast<float>(full), 0.0f, 1.0f);
        }
        return image;
    };
    FloatImage sum = toFloat(maps[0], 0);
    for (std::size_t n = 0; n < needed; ++n) {
        if (n > 0) {
            const FloatImage more = toFloat(maps[n], 0);
            for (std::size_t v = 0; v < sum.values.size(); ++v) sum.values[v] += more.values[v];
        }
        const bool isWholeBrain = n + 1 == kTissueMaps && options.innerSurfaces > 0;
        if (isWholeBrain) inner.push_back(scaled(sum));
        if (isWholeBrain && options.innerSurfaces > 1) inner.push_back(scaled(toFloat(maps[n], 0)));
        if (n + 1 >= kBrainMaps) enclosed.push_back(scaled(sum));
    }
    return boundariesFrom(std::move(enclosed), std::move(inner), options);
}

}  // namespace adaptiso
