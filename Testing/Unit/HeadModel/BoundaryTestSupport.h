#pragma once

#include <functional>
#include <string>
#include <vector>

#include "HeadPhantoms.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso::testing {

inline constexpr Vec3 kCentre{2.3, -1.4, 0.7};

/// A head of a third of the usual size, so that tests are quick: what is tested scales.
HeadShapes smallHead();

BoundaryOptions quick();

/// Of all three surfaces, mm.
double largestError(const HeadBoundaries& head, const HeadShapes& truth);

/// Least distance from the surface of each solid to that of the next, mm. Expects them nested.
std::vector<double> gapsOf(const HeadBoundaries& head);

/// Expects an InvalidInput that says `message`.
void expectRefused(const std::function<void()>& call, const std::string& message);

}  // namespace adaptiso::testing
