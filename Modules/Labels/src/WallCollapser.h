#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "WallMesh.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/SurfaceProof/Quadric.h"

namespace adaptiso::detail {

/// Tells whether a change of walls takes them over a voxel centre.
class SweptCentres {
public:
    explicit SweptCentres(const ImageGeometry& geometry)
        : originMm_(geometry.originMm), toIndex_(inverse(geometry.indexToPhysical)) {}

    /// A voxel centre lies in a tetrahedron (voxel indices), or so near to it that rounding could
    /// tell otherwise. Replacing triangles round an edge by the cone of a new point over their
    /// border sweeps the tetrahedra of these triangles and the point, and no more.
    static bool isCentreIn(const std::array<Vec3, 4>& corners);

    Vec3 toIndex(const Vec3& pointMm) const { return toIndex_ * (pointMm - originMm_); }

private:
    Vec3 originMm_;
    Mat3 toIndex_;
};

/// Edge collapse on walls with quick tests of what is promised; what they let through is proved
/// later.
class WallCollapser {
public:
    using Id = WallMesh::Id;
    using Kind = WallMesh::Kind;
    static constexpr Id kNone = WallMesh::kNone;

    /// \param patch  must live as long
    WallCollapser(const WallPatch& patch, const ImageGeometry& geometry, double leastAngleDeg);

    const WallMesh& mesh() const { return mesh_; }
    double voxelMm() const { return voxelMm_; }
    const Quadric& quadricOf(Id v) const { return quadrics_[v]; }
    /// A vertex of the full walls near one.
    Id originOf(Id v) const { return origin_[v]; }
    /// The vertex lies in the patch's cube.
    bool isOwn(Id v) const { return v >= firstNew_ || patch_.isOwn[v - mesh_.firstPoint()] != 0; }
    bool isFrozen(Id v) const {
        return v < firstNew_ && patch_.isFrozen[v - mesh_.firstPoint()] != 0;
    }
    /// Where a sample is assigned to: samples are the vertices of the full walls.
    WallAssignment assignmentOf(Id sample) const {
        const Sample& s = samples_[sample];
        return {s.assigned, s.tightness, s.slot};
    }

    /// From the full walls: a triangle, those at a vertex, samples that are assigned to one of the
    /// mesh.
    const WallTriangle& fullTriangle(Id full) const { return patch_.fullTriangles[full]; }
    std::span<const Id> fullAround(Id sample) const {
        return std::span(fullAround_)
            .subspan(fullBegin_[sample], fullBegin_[sample + 1] - fullBegin_[sample]);
    }
    template <class F>
    void forEachSample(Id triangle, const F& f) const {
        for (Id s = firstSample_[triangle]; s != kNone; s = samples_[s].next) f(s);
    }

    /// Collapses all edges that it can, up to a cost, until only `enough` triangles are left.
    /// \param limitMm  of the distance of the full walls' vertices
    void round(double maxCost, double limitMm, std::int64_t enough);

    void undo(Id change);

    /// Allows edges that did not collapse so far to try again, with another limit.
    void tryAllAgain();

    /// Samples of a triangle of the full walls, or near one of the mesh, are held tighter.
    void tightenFull(Id full);
    void tightenNear(Id triangle);

    /// A triangle of the mesh, of a wall, near a triangle of the full walls; and the reverse.
    Id meshNear(Id full) const;
    Id fullNear(Id triangle) const;

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    struct Plan {
        double cost = kInfinity;
        Vec3 point;
        Kind kind = Kind::Wall;
    };
    /// A sample, and the triangle that it is assigned to: one of a list.
    struct Sample {
        Vec3 point;
        Id assigned = kNone, next = kNone;
        float tightness = WallAssignment().tightness;  ///< part of the limit that it may use
        std::uint8_t slot =
            WallAssignment::kOnWall;  ///< edge of the triangle that it is assigned to
    };
    struct NewAssignment {
        Id sample, star;
        std::uint8_t slot;
    };
    static constexpr float kTighter = 0.6F;
    static constexpr std::uint8_t kOnWall = WallAssignment::kOnWall;

    void findFans();
    void beginFull();
    void beginAsIs();
    void linkVertex(Id v);
    void addQuadrics();
    Plan planFor(Id u, Id v) const;
    template <class F>
    void forEachNeighbour(Id u, const F& f);
    bool tryCollapse(Id u, Id v, Plan plan, double limitMm);
    void collectStar(Id u, Id v);
    bool keepsTopology(Id u, Id v);
    void keepVolume(Id u, Id v, Plan& plan) const;
    bool keepsShape(Id u, Id v, const Vec3& point) const;
    bool sweepsCentre(Id u, Id v, const Vec3& point) const;
    bool isInRoom(const Vec3& point) const;
    void findParts(Id u, Id v, const Plan& plan);
    bool assignSamples(Id u, Id v, const Plan& plan, double limitMm);
    double assignOnWall(const Vec3& p, Id wall, std::size_t first, double limit2,
                        NewAssignment& assigned);
    double assignOnCurve(const Vec3& p, Id u, Id v, const Plan& plan, std::size_t i,
                         NewAssignment& assigned);
    bool isNearFull(const Vec3& point, Id sample, double limitMm) const;
    void link(Id sample, Id triangle, std::uint8_t slot);
    bool spokesAreNear(const Plan& plan, double limitMm);

    const WallPatch& patch_;
    WallMesh mesh_;
    SweptCentres centres_;
    Id firstNew_;  ///< vertex that a collapse made
    double voxelMm_;
    double largestCosine_;  ///< of an angle that may be made
    std::vector<Quadric> quadrics_;
    std::vector<Id> origin_;         ///< of each vertex, one of the full walls near it
    std::vector<double> tried_;      ///< of each vertex: its edges up to this cost did not collapse
    std::vector<double> leastCost_;  ///< of each vertex's edges, when last looked at
    std::vector<std::uint64_t> fullBegin_;
    std::vector<Id> fullAround_;   ///< triangles of the full walls at their vertices
    std::vector<Sample> samples_;  ///< of the full walls
    std::vector<Id> firstSample_;  ///< of each triangle
    /// A triangle, ready to tell what lies over it.
    struct Plane {
        Vec3 corner, toFirst, toSecond;  ///< slopes of the barycentric coordinates of corners 1, 2
        Vec3 normal;                     ///< of length 1; 0 where the triangle is flat, as slopes

        Plane() = default;
        explicit Plane(const std::array<Vec3, 3>& corners);
        bool isFlat() const { return normal == Vec3{}; }
        /// \pre not flat
        bool isUnder(const Vec3& p) const {
            const Vec3 q = p - corner;
            const double a = dot(toFirst, q), b = dot(toSecond, q);
            return a >= 0 && b >= 0 && a + b <= 1;
        }
        double heightOf(const Vec3& p) const { return dot(normal, p - corner); }
    };
    // of one collapse
    struct Part {
        std::array<Vec3, 3> corners;
        Id wall;
        Plane plane;
    };
    struct CurvePart {
        Vec3 end;
        Id star;
        std::uint8_t slot;
    };
    /// Points that are asked for the nearest to others.
    class SamplePoints {
    public:
        void clear() { x_.clear(), y_.clear(), z_.clear(); }
        void add(const Vec3& p) { x_.push_back(p.x), y_.push_back(p.y), z_.push_back(p.z); }
        bool isEmpty() const { return x_.empty(); }
        /// The first of the nearest ones. \pre not empty
        std::size_t nearestTo(const Vec3& p);

    private:
        std::vector<double> x_, y_, z_, squared_;
    };
    std::vector<Part> parts_;
    std::vector<CurvePart> curveParts_;
    /// A triangle of the full walls as seen from a sample that is its corner: single precision is
    /// ample for a quick test.
    struct FanPlane {
        std::array<float, 3> toFirst, toSecond, normal;  ///< as Plane has them

        static float product(const std::array<float, 3>& a, const std::array<float, 3>& b) {
            return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        float heightOf(const std::array<float, 3>& way) const { return product(normal, way); }
        bool isUnder(const std::array<float, 3>& way) const {
            const float a = product(toFirst, way), b = product(toSecond, way);
            return a >= 0 && b >= 0 && a + b <= 1;
        }
    };
    std::vector<FanPlane> fans_;  ///< of each sample's triangles, as fullAround_
    std::vector<Id> star_;
    std::size_t kept_ = 0;
    std::vector<std::uint32_t> mark_;
    std::uint32_t stamp_ = 0;
    std::vector<Id> common_;
    std::vector<NewAssignment> newAssignments_;
    struct OnSpoke {
        Vec3 point;
        Id nearest;  ///< sample
    };
    std::vector<OnSpoke> onSpokes_;
    SamplePoints samplePoints_;  ///< of the new assignments, in their order
    Id nearestSample_ = kNone;
};

}  // namespace adaptiso::detail
