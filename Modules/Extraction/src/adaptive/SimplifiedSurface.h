#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "Bricks.h"
#include "MetricFrame.h"
#include "PatchSimplifier.h"

namespace adaptiso::detail {

/// The whole surface between rounds of simplification, in the metric frame, and the vertices of
/// the full-resolution surface with the triangle that stands for each.
struct SimplifiedSurface {
    static constexpr std::uint64_t kGone = ~std::uint64_t{0};
    using Triangle = std::array<std::uint64_t, 3>;
    using Sample = std::array<float, 3>;

    std::vector<Vec3> points;
    std::vector<Quadric> quadrics;     ///< of each point
    std::vector<Patch::State> states;  ///< of each point
    std::vector<Triangle> triangles;

    /// Samples: those within bricks, brick by brick in the mesher's order; then those on bricks'
    /// walls, ordered by their lattice edge.
    std::vector<Sample> samples;
    std::vector<Normal> sampleNormals;
    std::vector<std::uint8_t> sampleIsSingleSheet;
    std::vector<std::uint8_t> sampleTightness;
    std::vector<std::uint64_t> sampleTriangle;
    std::vector<std::uint64_t> firstSample;  ///< of each brick; then the first on a wall
    std::vector<std::uint64_t> wallEdges;    ///< EdgeKey of each wall sample, ascending

    std::int64_t fineTriangles = 0;   ///< of the full-resolution surface
    std::int64_t tableTriangles = 0;  ///< of it, were no loop filled from its middle

    std::int64_t triangleCount() const { return static_cast<std::int64_t>(triangles.size()); }
};

/// Places where the allowed distance was not small enough to keep all points between the samples
/// within the bound: its square is halved around them, and more and more often when they are added
/// again.
class TightPlaces {
public:
    /// \param places  continuous sample indices
    void add(const std::vector<Vec3>& places);
    int tightnessAt(const Vec3& place) const;

private:
    static constexpr double kCube = 1.5;  ///< voxels
    static Index3 cubeAt(const Vec3& place);

    std::map<Index3, std::size_t> tightness_;  ///< of cubes of the lattice: how often added
};

/// The costs of a round's collapses, patch by patch in the order they were made.
using CollapseCosts = std::vector<std::vector<double>>;

/// The largest cost limit with which a round would still have left `collapses` or fewer made, by
/// the costs of the round.
double costLimitFor(const CollapseCosts& costs, std::int64_t collapses);

/// Meshes every brick and simplifies it alone; its walls stay as they are.
SimplifiedSurface simplifyBricks(const LatticeSampler& sampler, const Bricks& bricks,
                                 const MetricFrame& frame, const TightPlaces& tight,
                                 const PatchLimits& limits, CollapseCosts* costs);

/// Cubes that cut the whole surface into patches: their side in cells, and where the first starts.
struct PatchCut {
    std::int64_t side = Brick::kSide;
    std::int64_t shift = 0;
};

/// What a round does in every patch.
struct PatchWork {
    PatchLimits limits;
    bool collapses = true;
    /// Collapses to make in all patches together, or more than there can be.
    std::int64_t mostCollapses = std::numeric_limits<std::int64_t>::max() / 4;
    bool fits = false;
};

/// Works on the surface in the patches of a cut, side by side. Triangles that straddle two cubes
/// stay as they are.
void simplifyPatches(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame,
                     const PatchWork& work, CollapseCosts* costs = nullptr);

}  // namespace adaptiso::detail
