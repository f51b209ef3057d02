#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Compares the sides that electrodes' names state (sideOfName()) with where they lie: by nasion
/// and ears, without these by the image. Names count where half of them or more are of the 10-05
/// system. \param points  LPS mm \return a warning where some lie more than 10 mm on the wrong side
/// \throws InvalidInput  where most do
std::optional<Warning> doubtfulSides(const std::vector<NamedPoint>& points,
                                     const std::optional<Landmarks>& landmarks,
                                     const TriangleMesh& skin);

/// A warning where nasion and ears have the left ear on the image's right.
std::optional<Warning> doubtfulSides(const Landmarks& landmarks);

}  // namespace adaptiso
