#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "EditMesh.h"
#include "RemeshTarget.h"

namespace adaptiso {

/// The steps of isotropic remeshing [Botsch2004] on one surface. Lengths are judged in units of the
/// wanted length there: scale() times the field of sizes. Every step keeps the mesh a closed
/// manifold of the same genus and turns no triangle away from the surface.
class Remesher {
public:
    /// Starts with the input itself. `target` must outlive the remesher.
    explicit Remesher(const RemeshTarget& target);

    const EditMesh& mesh() const { return mesh_; }
    std::int64_t vertexCount() const { return mesh_.vertexCount(); }

    /// Vertices are put back by a search of the whole surface instead of from where they were:
    /// slow, and the way out where sheets have got entangled.
    void setThorough(bool isThorough) { isThorough_ = isThorough; }

    double scale() const { return scale_; }
    void setScale(double scale) { scale_ = scale; }
    /// How many vertices equilateral triangles of the wanted lengths take to fill the surface.
    std::int64_t verticesWanted() const;
    /// The scale at which they take this many.
    double scaleFor(std::int64_t vertices) const;

    /// Collapses ever longer edges until at most `vertices` are left or nothing can go. Vertices
    /// stay where they are.
    void coarsen(std::int64_t vertices);
    /// Leaves out what collapses have freed: loops over all numbers take time. Results stay as
    /// they would have been.
    void compact();
    /// Up to `mostVertices` in all.
    void splitLongEdges(std::int64_t mostVertices);
    void collapseShortEdges();
    /// Flips edges that brings valences nearer to 6.
    void evenValences();
    /// Flips edges whose opposite angles sum to more than 180 degrees.
    void flipToDelaunay();
    /// Moves every vertex along the surface to the centre of its triangles, `rounds` times.
    void relax(int rounds);
    /// Splits the `count` longest edges, no two near each other. \return how many there were
    std::int64_t splitLongest(std::int64_t count);
    /// Collapses the `count` shortest edges, no two near each other. \return how many could be
    std::int64_t collapseShortest(std::int64_t count);
    /// Takes every vertex to the local fit over three quarters of its edge length, by no more than
    /// `limitMm`.
    void fitVertices(double limitMm);

private:
    using HalfEdge = EditMesh::HalfEdge;
    struct Ranked;

    double trianglesAtScaleOne() const;
    double relativeLength(HalfEdge h) const;
    /// Cosine between a triangle and the surface's normals at its corners; 1 where those cancel.
    double uprightness(HalfEdge h) const;
    /// The triangle of h may become one of this area vector over these normals: it is upright then,
    /// or no less so than now.
    bool staysUpright(HalfEdge h, const Vec3& area, const Vec3& normals) const;
    /// The surface bends more sharply at v than edges can follow: the rim of an ear.
    bool isOnCrest(VertexId v) const;
    /// Without a, and b at the landing, the surface would come to lie away from where a is.
    bool losesCrest(VertexId a, VertexId b, const Landing& landing) const;
    bool tryCollapse(HalfEdge h, const Landing& landing, double longestAllowed);
    bool tryFlip(HalfEdge h);
    bool tryMove(VertexId v, const Landing& landing);
    /// \return empty on a crest: its vertices are not moved
    std::optional<Vec3> relaxed(VertexId v) const;
    Landing midpoint(HalfEdge h) const;
    /// Where v comes to lie that was moved to p.
    Landing moved(VertexId v, const Vec3& p) const;
    void settle(VertexId v, const Landing& landing);
    std::vector<HalfEdge> rankedEdges(bool isLongestFirst) const;

    const RemeshTarget& target_;
    EditMesh mesh_;
    double scale_ = 1;
    bool isThorough_ = false;
    std::vector<double> sizesMm_;
    std::vector<Vec3> normals_;
    std::vector<std::int64_t> triangles_;  ///< of the target, under each vertex
};

}  // namespace adaptiso
