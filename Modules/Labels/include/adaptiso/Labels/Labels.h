#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/SimplifyAims.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {

/// The number of a region of a label map. 0 is what lies outside of all regions.
using Label = std::int32_t;

/// A sample is no whole number that Label holds.
class NotALabelMap : public InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

/// The walls between the regions of a label map, each stored once: V points (LPS mm), T triangles.
///
/// A triangle is counter-clockwise seen from its second label: its normal points from labels[t][0]
/// into labels[t][1]. Of a wall's two labels the smaller comes first, 0 last.
struct LabelComplex {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    std::vector<std::array<Label, 2>> labels;  ///< of each triangle

    friend bool operator==(const LabelComplex&, const LabelComplex&) = default;
};

/// Aims of extractLabels(): distance of each wall to itself at full resolution, 0 for these walls
/// themselves, kDefaultMaxErrorVoxels with neither bound nor count. Where walls at full resolution
/// have an angle below the smallest wanted, none that is smaller still is made. \pre maxErrorMm >=
/// 0
struct LabelOptions : SimplifyAims {
    /// Fraction of the least distance between planes of samples.
    static constexpr double kDefaultMaxErrorVoxels = 0.15;

    /// The regions whose walls are wanted, each label once; empty: all. Only these are made: time
    /// and memory go with them. They keep their neighbours' labels and where these meet; as other
    /// regions neither take part in smoothing nor hold what is simplified, points may lie elsewhere
    /// than in the whole map, within the same rooms and the same bound.
    std::vector<Label> labels;
    /// Move walls off the staircase of the voxels, as far as no voxel centre changes its label.
    bool smooth = true;
    ProgressCallback progress;  ///< called as the work goes on; may be empty
};

struct LabelStatistics {
    std::int64_t fullTriangles = 0;  ///< of the full-resolution walls
    std::int64_t cells = 0;          ///< cubes between eight voxel centres that a wall runs through
    /// Part of these: kept in several parts, as one vertex would pinch a region.
    std::int64_t dividedCells = 0;
    /// Vertices that smoothing left at the limit of what the labels allow.
    std::int64_t heldVertices = 0;
    /// Places where walls crossed after smoothing, and were divided until they did not.
    std::int64_t mendedCrossings = 0;
    /// Distance to the full-resolution walls that is proved, both ways, mm. 0: these themselves.
    double errorBoundMm = 0;
    /// The count that maxTriangles and reduction ask for, where they do.
    std::optional<std::int64_t> wantedTriangles;
};

struct LabelResult {
    LabelComplex complex;
    LabelStatistics statistics;
};

/// The walls between the regions of a label map, in one complex.
///
/// The dual complex of Kuhn's triangulation, its cells contracted where that leaves the topology,
/// smoothed, and simplified by edge collapse within a proved distance [Nielson1997, Gibson1998,
/// Garland1997, Dey1999].
///
/// Every region's surface is closed, outward and 2-manifold, also where voxels touch at an edge or
/// a corner only; no two triangles cross; every voxel centre lies in the region of its label. What
/// lies beyond the border of the volume has the label 0. The method: Documentation/LabelsMethod.md.
///
/// \return  empty when all labels are 0.
/// \pre  samples are whole numbers that Label holds; options as their comments say; options.labels
///       are in the map                                          \throws InvalidInput otherwise,
///       NotALabelMap for a sample
/// Cost: time grows with the voxels (a scan) and with the area of the wanted walls, memory with
/// these and with the voxels of the box round their regions. The same input gives the same bytes,
/// whatever the number of threads.
LabelResult extractLabels(const VolumeView& volume, const LabelOptions& options = {});

/// The labels of a map other than 0, ascending.
/// \pre as of extractLabels \throws InvalidInput otherwise
std::vector<Label> findLabels(const VolumeView& volume);

/// The surface of one region: closed, outward, its points those of the complex, to the bit, in
/// the complex's order. Empty for a label that no triangle has.
TriangleMesh regionSurface(const LabelComplex& complex, Label label);

/// The same of several regions, one at a time, without looking at all walls for each.
class RegionSurfaces {
public:
    /// \param complex  must live as long
    /// \param labels   of the regions, ascending
    RegionSurfaces(const LabelComplex& complex, const std::vector<Label>& labels);

    /// Numbers of the n-th region's triangles in the complex, ascending.
    std::span<const std::int64_t> triangles(std::size_t n) const { return triangles_.of(n); }
    /// The n-th region's surface. May be called from several threads.
    TriangleMesh surface(std::size_t n) const;

private:
    const LabelComplex& complex_;
    std::vector<Label> labels_;
    Buckets<std::int64_t> triangles_;  ///< of each region
};

/// Wall that a region shares with another one.
struct RegionContact {
    Label label = 0;
    std::int64_t triangles = 0;
    double areaMm2 = 0;

    friend bool operator==(const RegionContact&, const RegionContact&) = default;
};

struct RegionMeasure {
    Label label = 0;
    std::int64_t vertices = 0;
    std::int64_t triangles = 0;
    double volumeMm3 = 0;
    double areaMm2 = 0;
    /// Vertices - edges + triangles of its surface: 2 for a ball, 0 for a ring, 4 for a shell.
    std::int64_t eulerCharacteristic = 0;
    std::int64_t components = 0;  ///< pieces of its surface; the wall of a cavity is one of its own
    std::vector<RegionContact> neighbours;  ///< by label, 0 among them

    friend bool operator==(const RegionMeasure&, const RegionMeasure&) = default;
};

/// The measures of every region that has triangles, by label; 0 is no region.
///
/// In a complex of chosen regions the others have but the walls that they share with these: their
/// measures are left out by naming the ones that are whole.
/// \param labels  whose measures are wanted, ascending; empty: all that have triangles
std::vector<RegionMeasure> measureRegions(const LabelComplex& complex,
                                          const std::vector<Label>& labels = {});

/// The spaces between the walls of a complex, as meshers take them: each piece of a region is a
/// volume of its own, with a point in it; regions are numbered from 1 in the order of `labels`.
/// Walls are distinguished by the pieces on their sides. Space that other labels enclose is no
/// volume. \param labels  regions wanted, ascending, each with all its walls in the complex Cost:
/// O(T log T), and for each cavity of a region of several pieces a look at these
MesherInput labelMesherInput(const LabelComplex& complex, const std::vector<Label>& labels);

}  // namespace adaptiso
