#pragma once

#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {

/// An entry of `distances` of the report adaptiso-compare/1, in millimetres.
/// \param toFrame  takes points of the report to the frame to tell them in
Json distanceJson(const DistanceStatistics& distances, const AffineTransform& toFrame);

}  // namespace adaptiso
