#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptive/bricks/Bricks.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/SimplifiedSurface.h"

namespace adaptiso::detail {

/// Cubes that cut the whole surface into patches: their side in cells, and where the first starts.
struct PatchCut {
    std::int64_t side = Brick::kSide;
    Index3 shift{};
};

/// The cubes of a cut in the surface's bounding box, by numbers that grow with x, then y, then z.
/// Where they would be too many they are larger.
class PatchCubes {
public:
    PatchCubes(const SurfaceState& surface, const PatchCut& cut, const MetricFrame& frame);

    std::size_t count() const {
        return static_cast<std::size_t>(count_[0] * count_[1] * count_[2]);
    }
    Index3 cubeAt(const Vec3& index) const;
    /// \param index  of a point in the bounding box
    std::uint32_t numberAt(const Vec3& index) const { return numberOf(cubeAt(index)); }
    /// Calls f(number) for those that a box overlaps.
    template <class F>
    void forEachIn(const BoundingBox& indexBox, const F& f) const;
    void setBounds(std::size_t number, Patch& patch) const;

private:
    std::uint32_t numberOf(const Index3& cube) const {
        return static_cast<std::uint32_t>(
            cube[0] - low_[0] + count_[0] * (cube[1] - low_[1] + count_[1] * (cube[2] - low_[2])));
    }

    PatchCut cut_;
    Index3 low_{0, 0, 0}, count_{1, 1, 1};
};

template <class F>
void PatchCubes::forEachIn(const BoundingBox& indexBox, const F& f) const {
    Index3 first = cubeAt(indexBox.minimum), last = cubeAt(indexBox.maximum);
    for (int a = 0; a < 3; ++a) {
        first[a] = std::max(first[a], low_[a]);
        last[a] = std::min(last[a], low_[a] + count_[a] - 1);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
        for (std::int64_t y = first[1]; y <= last[1]; ++y) {
            for (std::int64_t x = first[0]; x <= last[0]; ++x) f(numberOf({x, y, z}));
        }
    }
}

/// Buffers of a thread that works on patches, one after the other.
struct PatchScratch {
    std::vector<std::uint32_t> outsideNumber;  ///< number + 1 in the patch, of the whole's vertices
    std::vector<std::uint32_t> outsideVertices;  ///< that have one
};

/// The patches of a cut: who belongs to which.
///
/// Where many vertices are final, a triangle between three of them is settled: it is no patch's
/// own, but an obstacle where own triangles are near it.
class PatchGroups {
public:
    PatchGroups(const SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame);

    std::size_t count() const { return cubes_.count(); }
    /// There is one patch, which holds all of the surface.
    bool isOne() const { return count() == 1; }
    /// Nothing of it can change.
    bool isIdle(std::size_t n) const;
    std::size_t triangleCount(std::size_t n) const { return triangles_.of(n).size(); }

    /// `total` dealt out by the patches' numbers of triangles.
    std::vector<std::int64_t> shares(std::int64_t total) const;

    /// A copy of a patch, with the triangles around it as obstacles; where it is the only one, but
    /// for the samples, which the caller can lend it as they are.
    Patch take(std::size_t n, PatchScratch& scratch) const;

    /// Writes what take() copied, and has changed since, back to the surface. Different patches
    /// touch different members, so this may run in parallel.
    /// \param mergedInto  of each vertex of the surface: gets what it was merged into; may be empty
    void putBack(std::size_t n, const Patch& patch, SimplifiedSurface& surface,
                 std::vector<std::uint32_t>& mergedInto) const;

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    static constexpr std::int64_t kPiece = 1 << 14;        ///< vertices or triangles
    using Groups = Buckets<std::uint32_t, std::uint32_t>;  ///< of members' numbers

    std::vector<std::uint32_t> cubesOfVertices() const;
    std::vector<std::uint32_t> cubesOfTriangles() const;
    bool manyAreFinal() const;
    bool isSettled(std::size_t triangle) const;
    void leaveOutSettled();
    void groupVertices();
    void groupTriangles();
    void listObstacles();
    BoundingBox indexBoxOf(const SurfaceState::Triangle& triangle) const;
    void addSamples(std::size_t n, Patch& patch) const;
    void addObstacles(std::size_t n, Patch& patch, PatchScratch& scratch) const;

    const SimplifiedSurface& surface_;
    const MetricFrame& frame_;
    PatchCubes cubes_;
    bool hasSettled_;  ///< triangles
    std::vector<std::uint32_t> cubeOfVertex_, cubeOfTriangle_;
    std::vector<std::uint32_t> placeOfVertex_;    ///< in its cube
    std::vector<std::uint32_t> placeOfTriangle_;  ///< in its cube, or among the obstacles
    std::vector<std::uint32_t> obstacleTriangles_;
    Groups vertices_, triangles_;
    /// Per cube, if some triangles are settled: the index box that its own ones stay in.
    std::vector<BoundingBox> reach_;
    Groups samples_;                                     ///< of the cubes' triangles
    Groups strayedSamples_;                              ///< of each obstacle
    std::vector<std::vector<std::uint32_t>> obstacles_;  ///< of each cube, their places
};

}  // namespace adaptiso::detail
