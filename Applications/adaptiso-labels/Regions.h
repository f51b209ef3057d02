#pragma once

#include <cstdint>
#include <vector>

#include "LabelMap.h"
#include "LabelsRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// Looks up the names in --labels and --merge: those of --names, of tables beside the input or in
/// it. \throws InvalidInput  there is no such name; the nearest are named \throws UsageError labels
/// of two merges overlap
void resolveNames(LabelsOptions& options);

/// The labels to take: all of the map's, or those of --labels.
/// \throws InvalidInput  the map has none of a range that is asked for
std::vector<Label> chooseLabels(const LabelCensus& census, const LabelsOptions& options);

/// Names and colours for the regions of `labels`, in run.regions; warns of what has none.
/// \throws FileError  the table of --names
void nameRegions(const std::vector<Label>& labels, const LabelCensus& census, LabelsRun& run);

/// The surfaces of the regions of a complex, one at a time, without looking at all walls for each.
class RegionSurfaces {
public:
    /// \param complex  must live as long
    RegionSurfaces(const LabelComplex& complex, const std::vector<Region>& regions);

    /// Of the n-th region: closed, outward; its points are the complex's, to the bit, in their
    /// order, and so are its triangles. May be called from several threads.
    TriangleMesh surface(std::size_t n) const;

private:
    const LabelComplex& complex_;
    std::vector<Label> labels_;
    std::vector<std::int64_t> begins_;     ///< of each region's triangles; one more than regions
    std::vector<std::int64_t> triangles_;  ///< numbers, by region
};

}  // namespace adaptiso
