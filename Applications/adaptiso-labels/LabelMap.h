#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "LabelLists.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// What a label map holds.
struct LabelCensus {
    std::map<Label, std::int64_t> voxels;  ///< of each label but 0
    /// Half of the labels have no longer runs of voxels along i, on the mean. An image's values
    /// change nearly from voxel to voxel (1.0 to 1.2 in T1 scans), regions of atlases do not (2 to
    /// 12).
    double medianRun = 0;

    bool looksLikeAnImage() const;
};

/// Counts the labels of an image.
/// \throws InvalidInput  "voxel (91, 4, 20) holds 0.37, ...": a value that is no whole number, or
///                       that 32 bits don't hold
LabelCensus countLabels(const VolumeView& image);

/// The map with merged labels as one; the very volume when there are none.
Volume mergeLabels(Volume map, const std::vector<LabelMerge>& merges);

/// The census of that map.
LabelCensus mergeCounts(LabelCensus census, const std::vector<LabelMerge>& merges);

/// The number that a label goes by when those of `merges` are merged.
Label mergedNumber(Label label, const std::vector<LabelMerge>& merges);

}  // namespace adaptiso
