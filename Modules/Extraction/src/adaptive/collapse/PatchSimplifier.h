#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "adaptive/collapse/CollapseQueue.h"
#include "adaptive/collapse/CrossingGuard.h"
#include "adaptive/collapse/ErrorTracker.h"
#include "adaptive/collapse/TriedEdges.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/Patch.h"
#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::detail {

struct PatchLimits {
    double maxCost = 0;        ///< of a collapse, mm2 x mm2
    double triedCost = -1;     ///< maxCost when the points that are tried were
    double maxDistanceMm = 0;  ///< of a sample from the triangle that it is assigned to
    /// Largest distance of a sample from a fitted vertex's triangles, unless one was as far before.
    double maxFittedMm = std::numeric_limits<double>::max();
    /// Parts of the surface that are thinner keep nearer to their samples.
    double webMm = 0;
    StarLimits shape;
    bool provesAll = false;    ///< also stars that can cross nothing by what is known of them
    bool leavesNoise = false;  ///< bricks full of it stay at full resolution
    bool keepsHeirs = false;   ///< of the full surface's vertices, see SurfaceState
    std::optional<BoundingBox> box{};  ///< that new vertices stay in, metric frame
};

/// Simplifies a patch in place by quadric edge collapses, cheapest first [Garland1997].
class PatchSimplifier {
public:
    PatchSimplifier(Patch& patch, const MetricFrame& frame, const PatchLimits& limits);

    /// Collapses edges until none is left within the limits, at most `most` of them.
    /// \param costs  gets the cost of each, in order; may be null
    void collapseEdges(std::int64_t most, std::vector<double>* costs);

    /// Moves vertices to where their triangles lie closest to the samples that are theirs
    /// (least squares, held by the vertex's quadric): those that are not fitted yet.
    void fitVertices();

private:
    /// A change that nothing refuses: all that apply() needs. An edge is collapsed into the vertex
    /// it starts from, or a vertex moves.
    struct Change {
        ChangedStar star;
        SampleAssignment samples;
        std::uint32_t vertex = 0;
        std::uint32_t halfEdge = PatchTopology::kNone;  ///< that is collapsed, if one is
    };

    bool mayChange(std::uint32_t v) const {
        return topology_.isMovable(v) && patch_.states[v] != Patch::State::Final;
    }
    QuadricMinimum bestPlace(std::uint32_t a, std::uint32_t b) const;
    /// Cost of collapsing an edge; kNever beyond the limits.
    double costOf(std::uint32_t halfEdge) const;
    void passOn(std::uint32_t halfEdge) {
        tried_.passOn(topology_.from(halfEdge), topology_.to(halfEdge));
    }

    /// Fills change_ with what collapsing the edge would do.
    Refusal evaluateCollapse(std::uint32_t halfEdge);
    /// Fills change_ with what moving the vertex to where its triangles fit the samples would do.
    /// \return whether that may be, and is better
    bool evaluateFit(std::uint32_t vertex);
    /// \pre nothing refused the change
    void apply(const Change& change);

    Refusal shapeOrDistance(Change& change) const;
    bool turnsOver(const Change& change) const;
    bool crossesNothing(const Change& change);
    bool isInBox(const Vec3& p) const;
    Vec3 fittedPlace(const ChangedStar& star, const Quadric& own) const;

    Patch& patch_;
    const MetricFrame& frame_;
    PatchLimits limits_;
    PatchTopology topology_;
    ErrorTracker errors_;
    CrossingGuard guard_;
    TriedEdges tried_;
    Change change_;  ///< the one that is evaluated: 5 kB and the samples
};

}  // namespace adaptiso::detail
