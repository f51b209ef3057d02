#include "adaptiso/HeadModel/ConductivityModel.h"

#include <array>
#include <cmath>
#include <string>

#include "FinishBoundaries.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

const HeadTissue& tissueWithin(HeadSurface surface, std::size_t count) {
    // by HeadSurface; then the brain of models without a surface of its own, or of white matter
    static constexpr std::array<HeadTissue, kHeadSurfaceCount + 1> kTissues{{
        {"white", "White", 1, &ConductivityModel::white},
        {"gray", "Gray", 2, &ConductivityModel::brain},
        {"csf", "CSF", 3, &ConductivityModel::csf},
        {"skull", "Skull", 4, &ConductivityModel::skull},
        {"scalp", "Skin", 5, &ConductivityModel::scalp},
        {"brain", "Brain", 2, &ConductivityModel::brain},
    }};
    const bool isWholeBrain = count < kHeadSurfaceCount && surface == headSurface(0, count);
    return isWholeBrain ? kTissues.back() : kTissues[static_cast<std::size_t>(surface)];
}

double ConductivityModel::within(HeadSurface surface, std::size_t count) const {
    return this->*tissueWithin(surface, count).conductivity;
}

ConductivityModel standardConductivities(std::size_t count) {
    if (count < kHeadSurfaceCount) return {};
    return {.brain = 0.275, .skull = 0.01, .scalp = 0.465, .csf = 1.654, .white = 0.126};
}

void checkConductivities(const ConductivityModel& model) {
    constexpr double kMost = 10;
    for (const double value : {model.white, model.brain, model.csf, model.skull, model.scalp}) {
        if (std::isfinite(value) && value > 0 && value <= kMost) continue;
        throw InvalidInput("a conductivity of " + headmodel::shortNumber(value) +
                           " S/m, must be above 0 and at most 10");
    }
}

}  // namespace adaptiso
