#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Places what model.options.sources asks for within the innermost surface (stage "sources"):
/// vertices of the cortex, thinned to a count, or a grid; none nearer than one edge. Surfaces are
/// put in order, the left one first. Fills the model's sources, notes and warnings.
/// \pre model.hasModel()
/// \throws InvalidInput  most of the sources lie outside (another head or frame); no source is left
void placeSources(BemModel& model, const BemHooks& hooks);

/// Warns of pial surfaces of which more than 1 % of the vertices lie outside the inner skull.
/// \pre model.hasModel()
void checkPial(BemModel& model);

}  // namespace adaptiso
