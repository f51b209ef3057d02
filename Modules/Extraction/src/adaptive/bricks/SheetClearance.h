#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptive/mesh/MetricFrame.h"

namespace adaptiso::detail {

/// How far other sheets of a surface are from each of its points: the distance to the nearest point
/// whose normal differs by more than about 70 degrees, up to the least distance between planes of
/// samples.
///
/// Sheets that follow each other face opposite sides, so this finds them; parts of one sheet that
/// bend sharply count as others. An estimate from points alone: it says where proofs are worth
/// their time, not that nothing crosses.
class SheetClearance {
public:
    /// Parts that clearances are counted in.
    static constexpr int kParts = 128;
    static constexpr std::uint8_t kAlone = 255;  ///< no other sheet within that distance

    /// The clearance beside a sheet at a distance.
    static std::uint8_t of(double distanceMm, const MetricFrame& frame) {
        const double voxels = distanceMm / frame.narrowestMm();
        return voxels < 1 ? static_cast<std::uint8_t>(kParts * voxels) : kAlone;
    }

    /// \param normals  of any length
    /// \param clearance  of each point, in parts of the least distance between planes of samples;
    ///              where it is kAlone, a single sheet for sure, it stays so; the others are
    ///              filled in
    static void fillIn(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                       const MetricFrame& frame, std::vector<std::uint8_t>& clearance);
};

}  // namespace adaptiso::detail
