#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/full/FullSurface.h"
#include "repair/MeshParts.h"

namespace adaptiso::detail {

/// A mesh as the surface that is simplified. Its frame is the mesh's own, moved to MeshParts'
/// origin; its voxels are about as large as those of a volume whose marching cubes surface has
/// triangles of that size.
class MeshSurface final : public FullSurface {
public:
    /// Keeps references to both.
    /// \param boundMm  distances that the surface is to keep, if any
    MeshSurface(const TriangleMesh& input, const MeshParts& parts, std::optional<double> boundMm);

    /// New vertices are to stay in a box. \param box  as seen from parts.origin
    void stayIn(const BoundingBox& box) { keepIn(box); }

    SimplifiedSurface firstRound(const PatchLimits& limits, CollapseCosts* costs) const override;
    TriangleView fineOf(const SimplifiedSurface&) const override { return parts_.view(); }
    /// Without normals.
    TriangleMesh meshOf(const SimplifiedSurface& surface) const override;
    std::vector<std::int64_t> crossingTriangles(
        const SimplifiedSurface& surface, const std::vector<std::uint8_t>& isFine) const override;
    std::vector<std::int64_t> insideOut(const SimplifiedSurface& surface) const override;
    double largestExtentMm() const override;

private:
    SimplifiedSurface unchanged(bool keepsHeirs) const;
    InsideOutPieces judge(const TriangleView& surface, std::span<const std::uint32_t> marks) const;
    std::vector<std::uint8_t> bentTriangles(const std::vector<Vec3>& areas) const;
    void addSamples(const std::vector<Vec3>& areas, SimplifiedSurface& surface) const;
    const TriangleMesh& input_;
    const MeshParts& parts_;
    std::vector<Corners> crossing_;   ///< triangles of the input that cross others, sorted
    std::int64_t mostInsideOut_ = 0;  ///< pieces of the input that are, or have no volume
};

/// For each point of `mesh` the normal of `input` at its nearest point, interpolated.
/// \pre `input` has normals
std::vector<Normal> normalsFrom(const TriangleMesh& input, const TriangleMesh& mesh);

}  // namespace adaptiso::detail
