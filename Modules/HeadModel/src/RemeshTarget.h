#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Where a point comes to lie on the input surface, and what is asked for there.
struct Landing {
    Vec3 pointMm;
    std::int64_t triangle = -1;  ///< of the input
    Vec3 normal;                 ///< of the input, smoothed: unit length, or zero at a knife's edge
    double sizeMm = 1;           ///< wanted edge length, up to a factor common to the surface
};

/// z = height + slope + (curvature) over the plane through a point across a normal.
struct LocalFit {
    double heightMm = 0;        ///< of the fitted surface over the point, along the normal
    double curvaturePerMm = 0;  ///< the larger principal curvature, without sign
    bool isValid = false;       ///< there were enough points all round
};

/// The input of remeshing: a dense surface to land on, its smoothed normals, the field of sizes.
class RemeshTarget {
public:
    /// Keeps a reference to `surface`. \pre closed, oriented, manifold
    explicit RemeshTarget(const TriangleMesh& surface);

    const TriangleMesh& surface() const { return surface_; }
    const AabbTree& tree() const { return tree_; }

    /// One wanted edge length per vertex of the surface; until then it is 1 everywhere.
    void setSizes(std::vector<double> sizesMm) { sizesMm_ = std::move(sizesMm); }

    /// The nearest point of the surface. \param hint  a triangle thought to be near; -1: none
    Landing project(const Vec3& p, std::int64_t hint) const;
    /// Where a point comes to lie that moved along the surface from a triangle: from the nearest
    /// place of that to a nearer one of its neighbours, until there is none. A sheet that comes
    /// near without hanging together there is not jumped to. Costs a fraction of project() when the
    /// point moved by a few triangles.
    Landing slide(const Vec3& p, std::int64_t from) const;
    /// Landing at the surface's own vertex.
    Landing atVertex(VertexId v) const;

    /// Least squares quadric over the vertices that hang together with the landing within
    /// `radiusMm` of it and face its way, each with the area it stands for, fading with distance.
    LocalFit fit(const Landing& at, double radiusMm) const;

    /// Numbers of the triangles that have v as a corner.
    std::span<const std::int64_t> trianglesAround(VertexId v) const {
        return around_.of(static_cast<std::size_t>(v));
    }

private:
    Landing landingAt(const Vec3& pointMm, std::int64_t triangle) const;
    /// The corners of the side or corner of a triangle that a point of it lies on, and how many.
    std::pair<Triangle, int> cornersBelow(const Vec3& p, std::int64_t triangle) const;
    bool hasCorner(std::int64_t triangle, VertexId v) const {
        const Triangle& t = surface_.triangles[triangle];
        return t[0] == v || t[1] == v || t[2] == v;
    }
    /// Vertices reached along edges from the landing, nearer ones first by and large.
    std::vector<VertexId> facingWithin(const Landing& at, double radiusMm) const;
    double sizeAt(VertexId v) const { return sizesMm_.empty() ? 1 : sizesMm_[v]; }

    const TriangleMesh& surface_;
    AabbTree tree_;
    Buckets<std::int64_t> around_;  ///< the triangles of each vertex
    std::vector<double> areaMm2_;   ///< a third of the triangles of each vertex
    std::vector<Vec3> normals_;
    std::vector<double> sizesMm_;
};

}  // namespace adaptiso
