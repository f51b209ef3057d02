#pragma once

#include <array>
#include <cstdint>

#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::detail {

/// Why a change is refused, in the order in which it is asked.
enum class Refusal : std::uint8_t {
    None,
    Topology,     ///< no manifold with the same borders would be left, or too large a star
    OutsideBox,   ///< the patch's: another cut may allow it
    Flat,         ///< a triangle has no area
    Turned,       ///< a triangle turns too far from the surface
    SharpCorner,  ///< sharper than asked for, and than before
    InsideOut,    ///< a piece of four triangles
    VertexFar,    ///< the new vertex, from the full-resolution surface
    RidgeFar,     ///< a point of a sharp new edge
    SampleFar,
    Crossing  ///< not proved to cross nothing, or sweeps over a piece
};

/// A star as it would be after a change: its new vertex and the triangles around it.
struct ChangedStar {
    /// A triangle (vertex, ring[i], ring[i + 1]), ready for distances.
    struct Wedge {
        Vec3 e1, e2;           ///< its sides from the vertex
        Vec3 area2;            ///< twice its area vector
        double length;         ///< of that
        double a11, a12, a22;  ///< products of the sides
        double inverse;        ///< 1 / (a11 a22 - a12 a12)
    };

    Star star;
    Vec3 vertex;
    std::array<Wedge, Star::kMost> wedge;
    /// Before and after the change the star is a graph over one plane: all its triangles face the
    /// same side, and go round the new vertex once. Then its triangles can't cross each other, nor
    /// what lies beside the star.
    bool isGraph = false;
    Vec3 normal;  ///< mean of the triangles' before the change, by area
};

/// Conditions that a changed star must meet.
struct StarLimits {
    double leastAngleDeg = 0;  ///< refuse angles below this unless the worst one before was worse
};

/// Fills in the wedges for the star's vertex at star.vertex.
/// \return Flat, Turned, SharpCorner or None. Slivers on the way are allowed: forbidding them costs
///         accuracy.
Refusal shapeStar(const Patch& patch, const StarLimits& limits, ChangedStar& changed);

}  // namespace adaptiso::detail
