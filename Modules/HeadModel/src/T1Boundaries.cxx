#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "BrainGuess.h"
#include "BrainSurface.h"
#include "FinishBoundaries.h"
#include "Necks.h"
#include "SkullBand.h"
#include "T1Head.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/Plausibility.h"
#include "adaptiso/HeadModel/SourceError.h"
#include "adaptiso/Preprocessing/LabelValues.h"

namespace adaptiso {

using namespace headmodel;

namespace {

/// Below this nobody needs to be told of a bias field (ch2: 0.79 to 1.04, darker towards its neck).
constexpr double kNotableBias = 0.3;

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
        const Mask pial =
            above(cortexPart(sources.pial, BoundarySource::Pial, head.grid), kFractionIsovalue);
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

/// Checks the inner skull's place by the tissue around it. Guesses that are right have 2 to 8 % of
/// rays that begin in tissue (at the temples and the base), those that lost a part 13 to 60 %.
/// Masks are drawn to their makers' liking there: they are judged by the upper three fifths, where
/// ch2's has 4 %, eroded by 2, 3 and 4 mm 7, 12 and 32 %.
void requireBandInSight(const SkullBand& band, bool isGuess, double csfMm, RawBoundaries& found) {
    std::vector<Warning>& warnings = found.warnings;
    constexpr double kUsuallySeen = 0.6, kUsuallyInTissue = 0.12, kUsuallyOfMask = 0.1,
                     kMostInTissue = 0.3;
    constexpr double kLeastSeen = 0.2;       // stripped images: 0 to 5 %
    constexpr double kMostUnseenMm2 = 2500;  // ch2 and copies of it: at most 21 cm2; a flap: 37
    found.figures.push_back({"skullSeenShare", band.seenFraction, kUsuallySeen});
    found.figures.push_back({"skullUnseenMm2", band.unseenMm2, {}, kMostUnseenMm2});
    found.figures.push_back(
        isGuess
            ? HeadFigure{"tissueOutsideShare", band.tissueFraction, {}, kUsuallyInTissue}
            : HeadFigure{"tissueOutsideMaskShare", band.upperTissueFraction, {}, kUsuallyOfMask});
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
    if (isGuess && band.tissueFraction > kUsuallyInTissue) {
        warnings.push_back(
            {"brain-doubtful",
             percentOf(band.tissueFraction) +
                 " of the rays to the scalp begin in 4 mm of tissue as bright as brain, "
                 "2 to 8 % are usual: a part of the brain may be lost, or muscle taken "
                 "for it; look at the result, or give a brain mask"});
    } else if (!isGuess && band.upperTissueFraction > kUsuallyOfMask) {
        const bool isSmall = band.seenFraction >= kUsuallySeen;  // else rays begin in the scalp
        warnings.push_back(
            {"brain-doubtful",
             std::string("the brain mask may be too ") + (isSmall ? "small" : "large") +
                 ": outside of it, " + percentOf(band.upperTissueFraction) +
                 " of the rays from the vault to the scalp begin in 4 mm of tissue as bright as "
                 "brain, 1 to 7 % are usual; give a " +
                 (isSmall ? "larger one, or --csf more than " + shortNumber(csfMm) + " mm"
                          : std::string("smaller one"))});
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
        const auto text = [](double mm) { return formatFixed(mm, 1); };
        const std::string unseen = "the skull does not show on " +
                                   shortNumber(std::round(band.unseenMm2 / 100)) +
                                   " cm2 in one piece";
        found.doubts.push_back({unseen, band.unseenMm});
        warnings.push_back(
            {"skull-unseen",
             unseen + ", around (" + text(-p.x) + ", " + text(-p.y) + ", " + text(p.z) +
                 ") mm RAS: a hole (craniotomy), a lesion at the cortex, a dura as bright as brain "
                 "(a contrast agent), or a brain that is wrong there; look at the result"});
    }
}

/// Thresholds are made for brains whose levels lie within a third of each other: within the inner
/// skull of ch2, with noise, a bias field, or an infant's size, quartiles lie 0.28 to 0.30 of the
/// median apart; with 7 T contrast 0.52, and what is dark is lost.
void judgeContrast(const std::vector<float>& innerSkull, const Head& head, RawBoundaries& raw) {
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
    raw.figures.push_back({"brainLevelSpread", spread, {}, kWide});
    if (spread <= kWide) return;
    raw.warnings.push_back(
        {"brain-doubtful",
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
        if (options.innerSurfaces > 0 && !sources.aseg && sources.pial.empty()) {
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
    if (isGuess && !head.isFluidBright) judgeContrast(raw.parts[0], head, raw);
    cutNecks(raw, options);
    if (options.innerSurfaces > 0) {
        raw.inner.push_back(brainSurfacePart(sources,
                                             {head.grid, head.t1, head.faces, head.levels, brain},
                                             options, raw.notes, raw.innerSeenMm.emplace_back()));
    }
    if (options.innerSurfaces > 1) {
        raw.inner.push_back(whiteMatterPart(sources, head.grid, head.faces, options, raw.notes,
                                            raw.innerSeenMm.emplace_back()));
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
    requireBandInSight(band, isGuess, options.csfMm, raw);
    if (const auto labels = sources.mask ? findLabelValues(*sources.mask) : std::nullopt) {
        raw.warnings.push_back({"looks-like-labels",
                                "the brain mask holds " + std::to_string(labels->count) +
                                    " different whole numbers, as label maps do; all that is not 0 "
                                    "counts as brain"});
    }
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
    options.innerSurfaces = 0;
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
