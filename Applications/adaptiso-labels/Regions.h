#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "LabelLists.h"
#include "Run.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::labels {

/// The labels in a map.
struct LabelCensus {
    std::map<Label, std::int64_t> voxels;  ///< of each label but 0
    /// Half of the labels have no longer runs of voxels along i, on the mean. An image's values
    /// change nearly from voxel to voxel (1.0 to 1.2 in T1 scans), regions of atlases do not (2 to
    /// 12).
    double medianRun = 0;

    bool looksLikeAnImage() const;
};

/// Counts the labels of an image.
/// \param scaling  of the header (ReadVolume), for the message
/// \throws InvalidInput  "voxel (91, 4, 20) holds 0.37, ...": a value that is no whole number, or
///                       that 32 bits don't hold
LabelCensus countLabels(const VolumeView& image, const std::string& scaling);

/// The map with merged labels as one; the same volume when no labels are merged.
Volume mergeLabels(Volume map, const std::vector<LabelMerge>& merges, const LabelIds& ids);

/// The census of that map.
LabelCensus mergeCounts(LabelCensus census, const std::vector<LabelMerge>& merges,
                        const LabelIds& ids);

/// The id of a label's region after merging.
LabelId mergedId(const LabelId& id, const std::vector<LabelMerge>& merges);

/// Looks up the names in --labels and --merge: those of --names, of tables beside the input or in
/// it. \throws InvalidInput  there is no such name; the nearest are named \throws UsageError labels
/// of two merges overlap
void resolveNames(LabelsOptions& options);

/// The labels to take: all of the map's, or those of --labels.
/// \throws InvalidInput  the map has no label of a requested range
std::vector<Label> chooseLabels(const LabelCensus& census, const LabelsRun& run);

/// Names and colours for the regions of `labels`, in run.regions; warns about labels without a
/// name. \throws FileError  the table of --names
void nameRegions(const std::vector<Label>& labels, const LabelCensus& census, LabelsRun& run);

/// As the library takes them, ascending.
std::vector<Label> labelsOf(const std::vector<Region>& regions);

/// \throws InvalidInput  a label is one that the files of --tetrahedra (below 1, beyond 32 bits) or
/// of --layers (beyond 32 bits) have no place for
void requireFittingLabels(const LabelsRun& run);

/// Fills the regions with tetrahedra by the mesher asked for, and checks them: run.tetrahedra and
/// run.checks. \throws FileError  the mesher fails, or writes what can't be read
void makeTetrahedra(const LabelComplex& complex, LabelsRun& run);

/// Checks what adaptiso-labels promises by code that has no part in making it (MeshQuality), and
/// keeps the answers in run.checks:
///   - every region has a surface that is closed, outward, 2-manifold, without degenerate triangle,
///     of the Euler characteristic and the number of pieces that were measured;
///   - every wall lies between two regions, and in the surfaces of both;
///   - no two triangles of the whole complex cross;
///   - every voxel centre lies in the region of its label.
/// \param map  with merged labels
void checkComplex(const LabelComplex& complex, const RegionSurfaces& surfaces,
                  const VolumeView& map, LabelsRun& run);

/// Makes the report that page and pictures show.
/// \param volume  behind the regions; must live as long as the report
Report makeReport(const LabelsRun& run, const RegionSurfaces& surfaces,
                  const std::string& volumeName, const VolumeView& volume);

}  // namespace adaptiso::labels
