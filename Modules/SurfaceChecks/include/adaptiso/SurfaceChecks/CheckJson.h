#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {

/// Parts of the report adaptiso-check/1, as adaptiso-check's README.md
/// describes it, for the program and for those who ask the same without it. A number that is
/// not known, or not finite, is null.

/// passed, failed, checks
Json verdictJson(const std::vector<Check>& checks);

/// An entry of adaptiso-check's `surfaces`: from vertices to shape.
Json factsJson(const SurfaceFacts& facts);

/// An entry of adaptiso-check's `nesting.pairs`, from passed on.
/// \param toFrame  takes points of the report to the frame of the output
Json nestingJson(const NestingReport& report, const std::vector<Check>& checks,
                 const AffineTransform& toFrame);

/// A length that is reported of distances, by its key without a unit.
struct LengthFigure {
    std::string_view key, label;
    double DistanceStatistics::*lengthMm;
};
std::span<const LengthFigure> lengthFigures();

/// They in another unit of `unitMm`. \param unit  behind each key: "Mm"
Json lengthsJson(const DistanceStatistics& distances, double unitMm, const std::string& unit);

/// `isosurface` of an entry of adaptiso-check's `surfaces`.
/// \param toFrame  takes points of the report to the frame of the output
Json deviationJson(const DistanceStatistics& distances, const AffineTransform& toFrame);

/// An entry of `distances` of the report adaptiso-compare/1, in millimetres.
/// \param toFrame  takes points of the report to the frame of the output
Json distanceJson(const DistanceStatistics& distances, const AffineTransform& toFrame);

/// `hausdorff` of such an entry.
Json hausdorffJson(const HausdorffInterval& hausdorff, const AffineTransform& toFrame);

/// Where distances are rough or of fewer points than were asked for, or the interval is wide.
std::vector<Warning> roughDistanceWarnings(const DistanceStatistics& distances,
                                           const HausdorffInterval& hausdorff);

}  // namespace adaptiso
