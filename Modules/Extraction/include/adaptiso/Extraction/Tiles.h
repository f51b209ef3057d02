#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// A box of the lattice: from `first` up to, and without, `end`.
struct IndexBox {
    Index3 first{0, 0, 0}, end{0, 0, 0};

    Index3 size() const { return {end[0] - first[0], end[1] - first[1], end[2] - first[2]}; }
};

/// How a volume that is too large to be worked on as a whole is cut, twice: into tiles, whose
/// surfaces are made one by one, and into seam boxes, which hold the middles of the tiles' walls.
///
/// Tiles are cubes of `side` cells; the walls between them lie on samples. The border of the volume
/// is closed: the outermost tiles reach half a cell beyond it. A seam box reaches from the middle
/// of a tile to the middle of the next one, the outermost to the volume's border; so each lies in
/// at most eight tiles, and each wall between tiles in the inside of seam boxes.
class TileCut {
public:
    static constexpr std::int64_t kStep = 32;  ///< sides are multiples of it
    static constexpr std::int64_t kLargestSide = 4096;

    /// \throws InvalidInput  the side is no multiple of kStep from kStep to kLargestSide, or the
    ///         image is too large (26,000 samples a side)
    TileCut(const Index3& imageSize, std::int64_t side);

    const Index3& imageSize() const { return imageSize_; }
    std::int64_t side() const { return side_; }

    Index3 tiles() const;  ///< along each axis
    /// Cells, by their sample of lowest index; -1 and the last sample's are the outermost.
    IndexBox cellsOf(const Index3& tile) const;
    /// Samples of the volume needed to make a tile: its own, and one more for normals.
    IndexBox samplesOf(const Index3& tile) const;
    /// The place that vertices of a tile have, in continuous indices.
    BoundingBox boxOf(const Index3& tile) const;

    Index3 seams() const;                           ///< seam boxes along each axis
    BoundingBox seamBox(const Index3& seam) const;  ///< in continuous indices
    /// The tiles that a seam box lies in.
    IndexBox tilesOfSeam(const Index3& seam) const;
    /// The seam box that a place lies in; those on a wall belong to the higher one.
    Index3 seamAt(const Vec3& index) const;

private:
    std::int64_t wall(std::int64_t tile) const;
    double seamWall(std::int64_t seam, int axis) const;

    Index3 imageSize_;
    std::int64_t side_;
};

/// The marching cubes surface in one tile. Its points are continuous sample indices of the whole
/// volume (physicalMesh() takes them to LPS mm), its triangles outward in index space.
///
/// All tiles' triangles are those of Method::MarchingCubes of the whole volume with a closed
/// border. What two tiles share, vertices on the wall between them, has the same bits in both, and
/// as no two vertices of a surface coincide, equal bits mean the same vertex.
/// \param window    samples of the volume, cut.samplesOf(tile) at least; its size alone counts of
///                  its geometry
/// \param first     index of its first sample
/// \param geometry  of the whole volume
/// The same input gives the same bytes, whatever the number of threads. Empty where no surface is.
TriangleMesh extractTile(const VolumeView& window, const Index3& first,
                         const ImageGeometry& geometry, double isovalue, const TileCut& cut,
                         const Index3& tile);

/// A mesh of continuous indices in LPS mm, its triangles outward there.
TriangleMesh physicalMesh(const TriangleMesh& mesh, const ImageGeometry& geometry);

/// The open border of a mesh.
struct BorderEdges {
    std::vector<std::array<VertexId, 2>> edges;  ///< with one triangle, which runs from [0] to [1]
    std::vector<VertexId> vertices;              ///< ends of them, ascending
};
BorderEdges borderOf(const TriangleMesh& mesh);

/// A mesh after simplifyInBox().
struct SimplifiedPart {
    TriangleMesh mesh;
    std::vector<std::uint8_t> isKept;  ///< of each triangle: it was to be kept (simplifyInBox)
    double errorBoundMm = 0;           ///< proved, both ways, as of simplify()
    bool isUnchanged = false;          ///< nothing could be proved, so that the mesh is as it was
};

/// extractTile(), simplified as Method::Adaptive simplifies a volume's surface: the samples are
/// known, so it costs less than simplifyInBox() of the same. Within a cell of the tile's walls all
/// stays at full resolution, and vertices on them keep the bits that extractTile() gives them.
/// \param leavesNoise  as AdaptiveOptions::leavesNoise
/// \throws InvalidInput  axes are not at right angles (canSimplifyInBoxes)
SimplifiedPart extractSimplifiedTile(const VolumeView& window, const Index3& first,
                                     const ImageGeometry& geometry, double isovalue,
                                     const TileCut& cut, const Index3& tile, double maxErrorMm,
                                     bool leavesNoise);

/// Simplifies a part of a surface as simplify() does, without moving what its neighbours know.
///
/// \param mesh     points in continuous indices of the volume of `geometry`, each used
/// \param isKept   of each triangle: it stays as it is. Empty: those that touch the mesh's border
/// \param box      in continuous indices: no new vertex lies outside it, or on it. The others that
///                 may move lie in it
/// \return  points that stay keep their bits and normals; the others' normals are interpolated.
///          Nothing crosses anything, also not what was kept
/// \pre  mesh crosses nothing   \throws InvalidInput  axes are not at right angles
/// (canTileAdaptive) The same input gives the same bytes, whatever the number of threads.
SimplifiedPart simplifyInBox(const TriangleMesh& mesh, std::vector<std::uint8_t> isKept,
                             const ImageGeometry& geometry, const BoundingBox& box,
                             double maxErrorMm);

/// The triangles that a seam box's run may change, and those that it must not touch: of a mesh of
/// continuous indices all that reach into the box.
struct SeamPart {
    TriangleMesh mesh;
    /// Per triangle: 1 if it does not lie in the box as a whole, or comes near no wall of tiles.
    std::vector<std::uint8_t> isFixed;
};

/// \param tiles  the surfaces of all tiles that the seam box lies in, at least, after
///               simplifyInBox(); joined, so that points are there once
SeamPart seamPartOf(const TriangleMesh& tiles, const TileCut& cut, const Index3& seam);

/// Returns a seam box's own triangles after simplifyInBox(): those that lie in the box, and fixed
/// ones whose middle does. All seam boxes' own triangles together are the whole surface.
TriangleMesh ownTriangles(const SimplifiedPart& part, const TileCut& cut, const Index3& seam);

/// A mesh without the points that no triangle uses.
TriangleMesh withoutUnusedPoints(TriangleMesh mesh);

/// The volume's axes are at right angles as nearly as simplifyInBox() needs it.
bool canSimplifyInBoxes(const ImageGeometry& geometry);

/// The least distance between neighbouring planes of samples, mm: what a default bound is a part
/// of.
double narrowestSpacingMm(const ImageGeometry& geometry);

}  // namespace adaptiso
