#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptive/mesh/SimplifiedSurface.h"
#include "adaptive/proof/DistanceProof.h"

namespace adaptiso::detail {

/// Takes a simplification back to the full-resolution surface around places that mending did not
/// help, and nowhere else.
///
/// Progressive meshes keep their history as a list of vertex splits [Hoppe1996]. Here each vertex
/// of the full surface only knows its heir, the vertex that it was merged into. Where all that
/// share an heir come apart again the surface is the full one; beside it both surfaces are joined
/// by triangles that have corners of both. More comes apart where that would not leave a 2-manifold
/// with the same borders.
class LocalUndo {
public:
    static constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();

    /// \pre the surface keeps heirs of the full one, and samples of its vertices
    LocalUndo(const TriangleView& fine, SimplifiedSurface& surface)
        : fine_(fine), surface_(surface) {}

    /// \param mended   triangles that were changed besides, before and after: their corners come
    ///                 apart together
    /// \param reachMm  how far around the places vertices come apart; at least the corners of their
    ///                 triangles
    /// \param most     vertices that the surface may gain
    /// \return what it changed; nothing when no vertex would come apart, the surface would not
    ///         stay a manifold, or isTooMuch()
    std::optional<SurfaceChanges> around(const std::vector<SurfaceState::Triangle>& mended,
                                         const std::vector<PlaceBeyond>& places, double reachMm,
                                         std::int64_t most = kAny);

    /// The surface would gain too many vertices, and so would it from farther around.
    bool isTooMuch() const { return isTooMuch_; }

private:
    using Triangle = SurfaceState::Triangle;
    using Number = SurfaceState::Number;
    using Numbers = std::vector<Number>;

    Numbers verticesAround(const std::vector<PlaceBeyond>& places, double reachMm) const;
    void choose(const std::vector<bool>& isChosen, DisjointSets& sets);
    bool hasMerges() const;
    void makeTriangles();
    Numbers faults() const;
    Numbers flatCorners() const;
    SurfaceChanges apply();
    void handOver(const Numbers& removed, const Numbers& numbers);
    std::ptrdiff_t nearestFresh(const Vec3& p, const TriangleTree& tree) const;
    void addVertices();

    bool isTouched(const Triangle& t) const {
        return comesApart_[t[0]] || comesApart_[t[1]] || comesApart_[t[2]];
    }
    Triangle heirsOf(const Triangle& t) const {
        return {surface_.heirs[t[0]], surface_.heirs[t[1]], surface_.heirs[t[2]]};
    }
    bool isOfFine(Number vertex) const { return vertex >= surface_.points.size(); }
    Vec3 pointOf(Number vertex) const {
        return isOfFine(vertex) ? fine_.points[apart_[vertex - surface_.points.size()]]
                                : surface_.points[vertex];
    }

    TriangleView fine_;
    SimplifiedSurface& surface_;
    // of one call
    std::vector<bool> comesApart_;  ///< each vertex of the surface
    /// The full surface's vertices that return, ascending. They get the numbers after the
    /// surface's.
    Numbers apart_;
    Numbers numbers_;              ///< of each vertex of the full surface, in what is made
    std::vector<Triangle> fresh_;  ///< triangles to add
    bool isTooMuch_ = false;
};

}  // namespace adaptiso::detail
