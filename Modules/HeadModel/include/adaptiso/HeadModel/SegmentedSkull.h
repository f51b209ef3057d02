#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/FractionField.h"

namespace adaptiso {

/// A segmentation as it is: its skull, and what the surfaces of a head model would enclose in it.
struct SegmentedHead {
    ImageGeometry grid;                    ///< the image's
    std::vector<std::uint8_t> isSkull;     ///< of each voxel
    std::vector<std::uint8_t> isSpongy{};  ///< the same of spongy bone; empty: not told apart
    /// Volumes of inner skull, outer skull and skin by their voxels, mm3.
    std::array<double, 3> enclosedMm3{};
};

/// How a model's skull differs from that of the segmentation that it was made from. Areas are those
/// of the inner skull.
struct SkullComparison {
    double areaMm2 = 0;
    double absentMm2 = 0;        ///< where the segmentation has no skull
    double largestHoleMm2 = 0;   ///< of that, the largest connected part but for an open base: the
                                 ///< lowest one, if it stays below 0.6 of the inner skull's height
    std::optional<Vec3> holeMm;  ///< its middle, LPS
    double medianMm = 0;         ///< thickness of the segmentation's skull, where there is one
    double thinMm = 0;           ///< 5 % of that area have less
    double modelMedianMm = 0;    ///< thickness of the model's skull there
    double thickerMm = 0;        ///< 0.5, or half of the longest side of a voxel
    double thickenedMm2 = 0;  ///< where it is thicker than the segmentation's by thickerMm or more
    double mostThickenedMm = 0;       ///< by how much at most
    std::optional<Vec3> thickenedMm;  ///< where, LPS
    /// Vertices of the inner skull in holes of more than kHoleMm2: connected parts without skull in
    /// the segmentation, but for an open base.
    std::vector<VertexId> holeVertices;

    static constexpr double kHoleMm2 = 500;  ///< orbits and canals have less
};

/// Compares along the shortest way from each vertex of the inner skull to the outer skull, and 3 mm
/// beyond both: the lengths of its parts within voxels of skull, interpolated, add up to the
/// segmentation's thickness there, the mean of a vertex and its neighbours (to a fraction of a
/// voxel).
/// \param innerSkull, outerSkull  of a model, nested; LPS mm
/// \pre they have triangles
SkullComparison compareSkull(const TriangleMesh& innerSkull, const TriangleMesh& outerSkull,
                             const SegmentedHead& head);

/// Returns for each place in the model's skull (LPS mm) whether it lies in a hole: the nearest
/// triangle of the inner skull has a vertex of holeVertices, and the segmentation has no skull at
/// the place.
/// \pre comparison is compareSkull(innerSkull, ..., head)
std::vector<bool> areInHoles(const std::vector<Vec3>& placesMm, const TriangleMesh& innerSkull,
                             const SkullComparison& comparison, const SegmentedHead& head);

}  // namespace adaptiso
