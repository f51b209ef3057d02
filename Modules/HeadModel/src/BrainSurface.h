#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ImageSteps.h"
#include "SkullBand.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"

namespace adaptiso::headmodel {

/// The voxels that FreeSurfer's labels call brain, as parts of a voxel: not 0, CSF, or what lies
/// outside.
std::vector<float> asegPart(const VolumeView& aseg, const ImageGeometry& grid);

/// Solid within the cortex's surfaces, of both hemispheres.
/// \throws SourceError  pial surfaces that enclose nothing
std::vector<float> pialPart(const std::vector<TriangleMesh>& pial, const ImageGeometry& grid);

/// A T1 on its grid, and where the brain is in it.
struct BrainInT1 {
    const ImageGeometry& grid;
    const std::vector<float>& t1;
    const std::vector<std::uint8_t>& faces;  ///< imageFaces()
    const HeadLevels& levels;
    const Mask& mask;  ///< of the brain
};

/// The raw solid of the brain's own surface, as boundariesFromT1() says. Adds how it was found to
/// `notes`. \throws InvalidInput  pial surfaces that enclose nothing
std::vector<float> brainSurfacePart(const BrainSources& sources, const BrainInT1& head,
                                    const BoundaryOptions& options, std::vector<std::string>& notes,
                                    std::vector<Vec3>& seenMm);

}  // namespace adaptiso::headmodel
