#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// A closed, oriented 2-manifold of triangles that can be edited edge by edge; every edit keeps it
/// one, of the same genus.
///
/// Half-edge h = 3 t + s runs along triangle t from its corner s to the next. Numbers of triangles
/// and vertices that a collapse frees are used again by the next split, the last freed first, so
/// that the same edits give the same mesh.
class EditMesh {
public:
    using HalfEdge = std::int64_t;

    /// Takes points and triangles as they are; vertex numbers stay, unused vertices are dead.
    /// \pre closed, oriented, manifold; no triangle names a vertex twice; half-edges, also of what
    /// splits add, are fewer than 2^31
    explicit EditMesh(const TriangleMesh& mesh);

    /// Without dead vertices and triangles, in the order of their numbers; no normals.
    TriangleMesh toMesh() const;

    std::int64_t vertexCount() const { return vertexCount_; }      ///< alive
    std::int64_t vertexSlots() const { return std::ssize(out_); }  ///< alive and dead
    std::int64_t halfEdgeSlots() const { return std::ssize(from_); }
    /// Renumbers in the same order without dead vertices and triangles, but for those that as many
    /// splits as there are vertices alive would use next: edits go on as they would have.
    /// \return  the former number of every vertex slot
    std::vector<VertexId> compact();
    bool isVertexAlive(VertexId v) const { return out_[v] >= 0; }
    bool isAlive(HalfEdge h) const { return from_[h] >= 0; }
    /// One of the two half-edges of an edge: for loops over edges.
    bool isFirst(HalfEdge h) const { return isAlive(h) && h < twin_[h]; }

    static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static HalfEdge prev(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
    HalfEdge twin(HalfEdge h) const { return twin_[h]; }
    VertexId from(HalfEdge h) const { return from_[h]; }
    VertexId to(HalfEdge h) const { return from_[next(h)]; }
    /// The corner across from the half-edge, in its own triangle.
    VertexId opposite(HalfEdge h) const { return from_[prev(h)]; }

    const Vec3& point(VertexId v) const { return points_[v]; }
    void setPoint(VertexId v, const Vec3& p) { points_[v] = p; }
    const std::vector<Vec3>& points() const { return points_; }

    /// Twice the area vector of the triangle of h.
    Vec3 areaVector(HalfEdge h) const {
        return areaVector2(points_[from(h)], points_[to(h)], points_[opposite(h)]);
    }
    double squaredLength(HalfEdge h) const {
        return squaredNorm(points_[to(h)] - points_[from(h)]);
    }
    std::int64_t valence(VertexId v) const;

    /// Calls visit(h) for the half-edges that leave v, each triangle of v once.
    template <class Visit>
    void forEachOut(VertexId v, const Visit& visit) const {
        const HalfEdge first = out_[v];
        HalfEdge h = first;
        do {
            visit(h);
            h = twin_[prev(h)];
        } while (h != first);
    }

    /// The two corners across from h are not yet joined, and no vertex falls below valence 3.
    bool canFlip(HalfEdge h) const;
    /// Turns the edge within its two triangles. \pre canFlip(h)
    void flip(HalfEdge h);
    /// Puts a vertex at p on the edge. \return its number
    VertexId split(HalfEdge h, const Vec3& p);
    /// The link condition [Dey1999]: the ends of h have no neighbours in common but the two
    /// corners across from it, and both of those keep valence 3.
    bool canCollapse(HalfEdge h) const;
    /// from(h) goes, its triangles hang on to(h), which stays where it is. \pre canCollapse(h)
    void collapse(HalfEdge h);

private:
    EditMesh() = default;
    void join(HalfEdge a, HalfEdge b) {
        twin_[a] = static_cast<Number>(b);
        twin_[b] = static_cast<Number>(a);
    }
    void setTriangle(HalfEdge first, VertexId a, VertexId b, VertexId c);
    HalfEdge newTriangle();

    /// As stored: half the memory that walks go through.
    using Number = std::int32_t;
    std::vector<Number> from_;  ///< -1: dead
    std::vector<Number> twin_;
    std::vector<Number> out_;  ///< a half-edge that leaves the vertex; -1: dead
    std::vector<Vec3> points_;
    std::vector<HalfEdge> freeTriangles_;  ///< their first half-edges
    std::vector<VertexId> freeVertices_;
    std::int64_t vertexCount_ = 0;
};

}  // namespace adaptiso
