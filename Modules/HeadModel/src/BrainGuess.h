#pragma once

#include <string>
#include <vector>

#include "T1Head.h"

namespace adaptiso::headmodel {

/// The brain by thresholds and morphology: the first that is plausible, or one not much thinner
/// that muscle has fallen off. Empty where none is.
Mask guessedBrain(const Head& head);

/// Why there is no guess of the brain.
std::string noBrainText(const Head& head);

/// The part of `brain` that lies nearer to the skin than `mm`, or outside of it.
double partAtSkin(const Mask& brain, const std::vector<float>& belowSkin, double mm);

}  // namespace adaptiso::headmodel
