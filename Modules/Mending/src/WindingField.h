#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// The generalized winding number [Jacobson2013] of any triangles: 1 in a closed surface whose
/// triangles face outward, 0 outside of it.
///
/// Triangles far from the point count together, as the first term of their multipole expansion
/// [Barill2018]; near ones each for itself [vanOosterom1983]. The error is a few thousandths.
class WindingField {
public:
    /// Keeps a reference to `mesh`. \param tree  of it
    WindingField(const TriangleMesh& mesh, const AabbTree& tree);

    /// \param without  a triangle that does not count; -1: all do
    /// \param far  triangles count together where they are as many radii of their box away
    double at(const Vec3& p, std::int64_t without = -1, double far = 2.5) const;

private:
    static constexpr std::int64_t kLeafTriangles = 4;  ///< as the tree has them
    struct Node {
        Vec3 middle;                      ///< mean, by area
        Vec3 dipole;                      ///< sum of area vectors
        double radius = 0;                ///< no corner is farther from the middle
        std::int64_t behind = 0;          ///< number of the first node that is not below this one
        std::int64_t begin = 0, end = 0;  ///< its triangles
    };
    void build(const HalvedLeaves& subtree);

    const TriangleMesh& mesh_;
    std::vector<std::int64_t> order_;
    std::vector<Node> nodes_;  ///< numbered by HalvedLeaves
};

}  // namespace adaptiso::detail
