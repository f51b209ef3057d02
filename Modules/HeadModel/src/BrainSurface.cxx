#include "BrainSurface.h"

#include <algorithm>

#include "FinishBoundaries.h"
#include "T1Head.h"
#include "Voxelized.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/SourceError.h"

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

std::vector<float> pialPart(const std::vector<TriangleMesh>& pial, const ImageGeometry& grid) {
    std::vector<float> part(static_cast<std::size_t>(grid.voxelCount()), 0);
    for (const TriangleMesh& surface : pial) {
        constexpr double kNoClosing = 0;  // sulci are the brain solid's business
        const std::vector<float> one = surfacePart(surface, grid, kNoClosing);
        const double cm3 = cm3Of(above(one, kFractionIsovalue), grid);
        if (cm3 < 50) {
            throw SourceError(
                BoundarySource::Pial,
                "a pial surface encloses " + shortNumber(cm3) +
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
        unite(part, pialPart(sources.pial, head.grid));
        notes.push_back("brain surface: holds the pial surfaces");
    }
    seenMm = sidesOf(above(part, kFractionIsovalue), head.grid, head.faces);
    return solidOf(std::move(part), head.grid, head.faces, options.sulciMm);
}

}  // namespace adaptiso::headmodel
