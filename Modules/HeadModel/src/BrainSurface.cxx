#include "BrainSurface.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "FinishBoundaries.h"
#include "T1Head.h"
#include "Voxelized.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::headmodel {
namespace {

void unite(std::vector<float>& part, const std::vector<float>& more) {
    for (std::size_t n = 0; n < part.size(); ++n) part[n] = std::max(part[n], more[n]);
}

/// Part of the mask that is tissue: CSF is dark in a T1. All of it where that leaves too little.
std::vector<float> tissuePart(const BrainInT1& head, std::vector<std::string>& notes) {
    constexpr double kLevel = 0.5, kLeastShare = 0.6;
    const double level = head.levels.air + kLevel * (head.levels.tissue - head.levels.air);
    Mask tissue = head.mask;
    for (std::size_t n = 0; n < tissue.size(); ++n) {
        if (head.t1[n] < level) tissue[n] = 0;
    }
    // dura and vessels hang on by thin strands
    constexpr double kStrandMm = 1;
    tissue = largestComponent(opened(tissue, head.grid, kStrandMm), head.grid.size);
    const auto all = static_cast<double>(voxelsIn(head.mask));
    if (static_cast<double>(voxelsIn(filled(tissue, head.grid.size))) < kLeastShare * all) {
        notes.push_back(
            "brain surface: the mask's own, since less than 60 % of it is as bright as tissue");
        std::vector<float> part(head.mask.size());
        std::copy(head.mask.begin(), head.mask.end(), part.begin());
        return part;
    }
    notes.push_back("brain surface: where the T1 rises above " + shortNumber(level) +
                    " within the brain");
    return partByLevel(tissue, head.t1, level, head.levels.air, head.faces, head.grid);
}

}  // namespace

std::vector<float> cortexPart(const std::vector<TriangleMesh>& surfaces, BoundarySource source,
                              const ImageGeometry& grid) {
    std::vector<float> part(static_cast<std::size_t>(grid.voxelCount()), 0);
    for (const TriangleMesh& surface : surfaces) {
        constexpr double kNoClosing = 0;  // sulci are the brain solid's business
        const std::vector<float> one = surfacePart(surface, grid, kNoClosing);
        const double cm3 = cm3Of(above(one, kFractionIsovalue), grid);
        if (cm3 < 50) {
            throw SourceError(
                source, std::string(source == BoundarySource::Pial ? "a pial" : "a white") +
                            " surface encloses " + shortNumber(cm3) +
                            " cm3 of this head, must be 50 or more; is it of this head, in the "
                            "same space?");
        }
        unite(part, one);
    }
    return part;
}

std::vector<float> asegPart(const VolumeView& aseg, const ImageGeometry& grid) {
    return resampled(indicator(aseg,
                               [](double label) {
                                   // 24 CSF; from 165 to 165 and 256 on (but for cortex and white
                                   // matter, from 1000 on) what lies outside of the brain
                                   const bool isOutside = label == 24 || label == 165 ||
                                                          (label >= 256 && label < 1000);
                                   const bool isCallosum = label >= 250 && label <= 255;
                                   return isCallosum || (label > 0 && !isOutside);
                               }),
                     grid, 0);
}

std::vector<float> brainSurfacePart(const BrainSources& sources, const BrainInT1& head,
                                    const BoundaryOptions& options, std::vector<std::string>& notes,
                                    std::vector<Vec3>& seenMm) {
    std::vector<float> part;
    if (sources.aseg) {
        part = asegPart(*sources.aseg, head.grid);
        notes.push_back("brain surface: by the labels");
    } else {
        part = tissuePart(head, notes);
    }
    if (!sources.pial.empty()) {
        unite(part, cortexPart(sources.pial, BoundarySource::Pial, head.grid));
        notes.push_back("brain surface: holds the pial surfaces");
    }
    seenMm = sidesOf(above(part, kFractionIsovalue), head.grid, head.faces);
    return solidOf(std::move(part), head.grid, head.faces, options.sulciMm);
}

std::vector<float> whiteMatterPart(const BrainSources& sources, const ImageGeometry& grid,
                                   const std::vector<std::uint8_t>& faces,
                                   const BoundaryOptions& options, std::vector<std::string>& notes,
                                   std::vector<Vec3>& seenMm) {
    if (!sources.aseg && sources.white.empty()) {
        throw InvalidInput("a T1 alone does not show white matter; give --aseg or --white");
    }
    std::vector<float> part = cortexPart(sources.white, BoundarySource::White, grid);
    if (sources.aseg) {
        const std::vector<std::int64_t> labels = tissuePreset("aseg").white;
        const std::set<std::int64_t> white(labels.begin(), labels.end());
        unite(
            part,
            resampled(indicator(*sources.aseg,
                                [&](double label) { return white.contains(std::llround(label)); }),
                      grid, 0));
    }
    seenMm = sidesOf(above(part, kFractionIsovalue), grid, faces);
    return whiteSolid(std::move(part), grid, faces, options.sulciMm, notes);
}

std::vector<float> whiteSolid(std::vector<float> part, const ImageGeometry& grid,
                              const std::vector<std::uint8_t>& faces, double sulciMm,
                              std::vector<std::string>& notes) {
    // what a ball can't leave (ventricles, deep grey matter), even where folds stay open
    constexpr double kDoorMm = 3;
    const Mask given = above(part, kFractionIsovalue);
    const Mask shut = closed(given, grid, kDoorMm), whole = filled(shut, grid.size);
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (whole[n] != 0 && shut[n] == 0) part[n] = 1;
    }
    // a fold holds two banks of cortex and a sulcus; hemispheres are joined before the largest
    // piece is chosen
    const Mask joined = closed(above(part, kFractionIsovalue), grid, std::max(2 * sulciMm, 1.0));
    for (std::size_t n = 0; n < part.size(); ++n) {
        if (joined[n] != 0 && part[n] < kFractionIsovalue) part[n] = 1;
    }
    part = solidOf(std::move(part), grid, faces, 0);
    const Mask solid = above(part, kFractionIsovalue);
    Mask lost = given, added = solid;
    for (std::size_t n = 0; n < given.size(); ++n) {
        if (solid[n] != 0) lost[n] = 0;
        if (given[n] != 0) added[n] = 0;
    }
    constexpr double kMostLost = 0.2;
    const double cm3 = cm3Of(given, grid), lostCm3 = cm3Of(lost, grid);
    if (cm3 == 0 || lostCm3 > kMostLost * cm3) {
        throw InvalidInput("the white matter is no single piece: " + shortNumber(lostCm3) + " of " +
                           shortNumber(cm3) + " cm3 are apart from the largest");
    }
    notes.push_back("white matter: " + shortNumber(cm3) + " cm3 in the input; " +
                    shortNumber(cm3Of(added, grid)) +
                    " cm3 within it (ventricles, deep grey matter) and in its folds were filled" +
                    (lostCm3 > 0 ? ", " + shortNumber(lostCm3) + " cm3 of loose pieces left out"
                                 : std::string()));
    return part;
}

}  // namespace adaptiso::headmodel
