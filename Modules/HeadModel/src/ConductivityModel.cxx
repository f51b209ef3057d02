#include "adaptiso/HeadModel/ConductivityModel.h"

#include <cmath>
#include <string>

#include "FinishBoundaries.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

double ConductivityModel::within(HeadSurface surface, std::size_t count) const {
    switch (surface) {
        case HeadSurface::Brain:
            return brain;
        case HeadSurface::InnerSkull:
            return count == kHeadSurfaceCount ? csf : brain;
        case HeadSurface::OuterSkull:
            return skull;
        case HeadSurface::OuterSkin:
            return scalp;
    }
    throw InternalError("ConductivityModel: unknown head surface");
}

void checkConductivities(const ConductivityModel& model) {
    constexpr double kMost = 10;
    for (const double value : {model.brain, model.csf, model.skull, model.scalp}) {
        if (std::isfinite(value) && value > 0 && value <= kMost) continue;
        throw InvalidInput("a conductivity of " + headmodel::shortNumber(value) +
                           " S/m, must be above 0 and at most 10");
    }
}

}  // namespace adaptiso
