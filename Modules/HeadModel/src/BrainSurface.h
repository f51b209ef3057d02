#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ImageSteps.h"
#include "SkullBand.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadModel/SourceError.h"

namespace adaptiso::headmodel {

/// The voxels that FreeSurfer's labels call brain, as parts of a voxel: not 0, CSF, or what lies
/// outside.
std::vector<float> asegPart(const VolumeView& aseg, const ImageGeometry& grid);

/// Solid within surfaces of the cortex, of both hemispheres.
/// \throws SourceError  surfaces that enclose nothing
std::vector<float> cortexPart(const std::vector<TriangleMesh>& surfaces, BoundarySource source,
                              const ImageGeometry& grid);

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

/// The raw solid of the white matter, by aseg and white surfaces; the rest is the same.
/// \throws InvalidInput  neither is given, or as whiteSolid()
std::vector<float> whiteMatterPart(const BrainSources& sources, const ImageGeometry& grid,
                                   const std::vector<std::uint8_t>& faces,
                                   const BoundaryOptions& options, std::vector<std::string>& notes,
                                   std::vector<Vec3>& seenMm);

/// One raw solid of white matter: folds narrower than four times sulciMm (2 mm at least), and what
/// is shut off by doors narrower than 6 mm, are filled; then its largest piece. Volumes are noted.
/// \throws InvalidInput  more than a fifth of it is apart from the largest piece
std::vector<float> whiteSolid(std::vector<float> part, const ImageGeometry& grid,
                              const std::vector<std::uint8_t>& faces, double sulciMm,
                              std::vector<std::string>& notes);

}  // namespace adaptiso::headmodel
