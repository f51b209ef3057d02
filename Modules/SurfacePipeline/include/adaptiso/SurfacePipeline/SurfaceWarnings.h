#pragma once

#include <optional>
#include <string>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Preprocessing/LabelValues.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso {

/// "looks-like-labels": the isovalue lies at or above the first of several labels, so that the
/// surface is around some of them together. Below the first it is around all, as of a mask.
/// \param forRegions  what makes a surface of each: "adaptiso-labels"
std::optional<Warning> labelsWarning(const std::optional<LabelValues>& labels, double isovalue,
                                     const std::string& forRegions);

/// "noise-kept": the default bound left a tenth of the surface or more at full resolution. Names
/// the bound of half a voxel, within which noise of many kinds loses half of its triangles or more.
/// \param option     that states a bound: "--max-error "
/// \param smoothing  that smooths the image: "--smooth "; empty: it is smoothed already
std::optional<Warning> noiseWarning(const SurfaceRecord& surface, const ExtractionOptions& options,
                                    const ImageGeometry& volume, const std::string& option,
                                    const std::string& smoothing);

}  // namespace adaptiso
