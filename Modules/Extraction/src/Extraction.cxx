#include "adaptiso/Extraction/Extraction.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptive/AdaptiveMethod.h"
#include "boxes/BoxesMethod.h"
#include "cells/MarchingCubes.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso {

std::string_view toString(Method method) {
    switch (method) {
        case Method::Adaptive:
            return "adaptive";
        case Method::Boxes:
            return "boxes";
        case Method::DiscretizedMarchingCubes:
            return "dmc";
        case Method::SkeletonClimbing:
            return "asc";
        case Method::MarchingCubes:
            return "mc";
    }
    return "unknown";
}

namespace {

/// \throws InvalidInput when `isSet`, an option of discretized marching cubes, meets another method
void requireDmc(bool isSet, const char* option, Method method) {
    if (isSet && method != Method::DiscretizedMarchingCubes) {
        throw InvalidInput(std::string("extractSurface: ") + option + " is set for the method " +
                           std::string(toString(method)) + ", must be dmc");
    }
}

}  // namespace

Extraction extractSurface(const VolumeView& volume, const SpanSpaceIndex& index,
                          const ExtractionOptions& options) {
    if (!std::isfinite(options.isovalue)) {
        throw InvalidInput("extractSurface: the isovalue is not a finite number");
    }
    const Index3& size = volume.geometry().size;
    requireDmc(options.adjustVertices, "adjustVertices", options.method);
    requireDmc(options.mergeWithinBlocks, "mergeWithinBlocks", options.method);
    if (index.grid().volumeSize != size || index.pixelType() != volume.pixelType()) {
        throw InvalidInput("extractSurface: the index was built from another volume");
    }
    if (*std::max_element(size.begin(), size.end()) > detail::EdgeKey::kMaximumExtent) {
        throw InvalidInput("the image has more than " +
                           std::to_string(detail::EdgeKey::kMaximumExtent) +
                           " voxels along an axis; crop or resample it");
    }
    if (options.method == Method::Adaptive) return detail::extractAdaptive(volume, index, options);
    Extraction result = options.method == Method::MarchingCubes
                            ? detail::extractMarchingCubes(volume, index, options)
                            : detail::extractBoxes(volume, index, options);
    if (!options.computeNormals) result.mesh.normals = {};
    return result;
}

}  // namespace adaptiso
