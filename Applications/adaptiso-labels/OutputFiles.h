#pragma once

#include <string_view>

#include "Common/AtomicOutput.h"
#include "LabelsRun.h"
#include "Regions.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// Whether a name in an output folder is of a file that this program writes there.
bool isOwnFile(std::string_view name);

/// all.surf.gii can hold the regions' surfaces: GIFTI counts in 32 bits.
bool fitsGifti(const LabelsRun& run);

/// Writes all but report.json into the folder, and keeps the names in run.files:
///   walls.vtp             points once, label0 and label1 of each triangle
///   regions/<label>.<x>   the surface of each region
///   all.vtm               the regions as one VTK multiblock, with all/<label>.vtp where
///                         regions/<label>.<x> are no .vtp
///   all.surf.gii          the regions' surfaces as one, vertices on walls once for each region
///   all.label.gii         the label of each of its vertices, and the label table; neither where it
///                         does not fit
///   regions.tsv           a BIDS lookup table with measures
/// \throws FileError, InvalidInput  as writeMesh()
void writeFiles(const LabelComplex& complex, const RegionSurfaces& surfaces, LabelsRun& run,
                AtomicFolder& folder);

/// regions.tsv.
std::string regionsTable(const LabelsRun& run);

}  // namespace adaptiso
