#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "SweptCentres.h"
#include "WallMesh.h"
#include "adaptive/collapse/Quadric.h"

namespace adaptiso::detail {

/// Edge collapse on walls with quick tests of what is promised; what they let through is proved
/// later.
class WallCollapser {
public:
    using Id = WallMesh::Id;
    using Kind = WallMesh::Kind;
    static constexpr Id kNone = WallMesh::kNone;

    WallCollapser(const LabelComplex& full, const ImageGeometry& geometry);

    const WallMesh& mesh() const { return mesh_; }
    double voxelMm() const { return voxelMm_; }

    /// Collapses all edges that it can, up to a cost, until only `enough` triangles are left.
    /// \param limitMm  of the distance of the full walls' vertices
    void round(double maxCost, double limitMm, std::int64_t enough);

    void undo(Id change);

    /// What did not collapse so far may, with another limit.
    void tryAllAgain() { std::fill(leastCost_.begin(), leastCost_.end(), 0); }

    /// Samples of a triangle of the full walls, or near one of the mesh, are held tighter.
    void tightenFull(Id full);
    void tightenNear(Id triangle);

    /// A triangle of the mesh, of a wall, near a triangle of the full walls; and the reverse.
    Id standInOf(Id full) const;
    Id fullNear(Id triangle) const;

private:
    struct Plan {
        double cost = std::numeric_limits<double>::infinity();
        Vec3 point;
        Kind kind = Kind::Wall;
    };
    /// Between samples the distance may be larger.
    static constexpr float kTrust = 0.8F, kTighter = 0.6F;
    static constexpr std::uint8_t kOnWall = 3;  ///< a sample's slot

    void addQuadrics();
    Plan planFor(Id u, Id v) const;
    bool tryCollapse(Id u, Id v, Plan plan, double limitMm);
    void collectStar(Id u, Id v);
    bool keepsTopology(Id u, Id v);
    void keepVolume(Id u, Id v, Plan& plan) const;
    bool keepsShape(Id u, Id v, const Vec3& point) const;
    bool sweepsCentre(const Vec3& point) const;
    bool findHomes(Id u, Id v, const Plan& plan, double limitMm);
    bool isNearFull(const Vec3& point, double limitMm);
    void link(Id sample, Id triangle, std::uint8_t slot);
    /// Samples are the vertices of the full walls and, after them, the middles of their triangles.
    Vec3 samplePoint(Id sample) const;
    /// A vertex of the full walls at a sample.
    Id vertexAt(Id sample) const;
    bool spokesAreNear(const Plan& plan, double limitMm);

    WallMesh mesh_;
    SweptCentres centres_;
    double voxelMm_;
    std::vector<Quadric> quadrics_;
    std::vector<Id> origin_;         ///< of each vertex, one of the full walls near it
    std::vector<double> tried_;      ///< of each vertex: its edges up to this cost did not collapse
    std::vector<double> leastCost_;  ///< of each vertex's edges, when last looked at
    std::vector<std::uint64_t> fullBegin_;
    std::vector<Id> fullAround_;  ///< triangles of the full walls at their vertices
    // samples, and the triangles that they are assigned to: lists
    std::vector<Id> home_, nextSample_, firstSample_;
    std::vector<float> tightness_;    ///< part of the limit that a sample may use
    std::vector<std::uint8_t> slot_;  ///< edge of the home that it is assigned to
    // of one collapse
    std::vector<Id> star_;
    std::size_t kept_ = 0;
    std::vector<std::uint32_t> mark_;
    std::uint32_t stamp_ = 0;
    std::vector<Id> common_;
    struct NewHome {
        Id sample, star;
        std::uint8_t slot;
        Vec3 point;
    };
    std::vector<NewHome> newHomes_;
    Id nearestSample_ = kNone;
};

}  // namespace adaptiso::detail
