#include "adaptiso/Extraction/Extraction.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Numbers.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/mesh/MetricFrame.h"
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

/// \throws InvalidInput when options of a method are set that is not the one chosen
template <class Options>
void requireMethod(const Options& options, const char* name, Method needed, Method method) {
    if (options == Options{} || method == needed) return;
    throw InvalidInput(std::string("extractSurface: options.") + name + " is set for the method " +
                       std::string(toString(method)) + ", must be " +
                       std::string(toString(needed)));
}

/// Voxels that are needles: finding what may cross what, over their length by their width, takes
/// for ever. Scans have 300 at most (0.1 mm in planes 30 mm apart).
void requireNoNeedles(const ImageGeometry& geometry) {
    constexpr double kMost = 10'000;
    const Vec3 spacingMm = geometry.spacingMm();
    const double longestMm = std::max({spacingMm.x, spacingMm.y, spacingMm.z});
    const double planesMm = detail::MetricFrame(geometry).narrowestMm();
    if (longestMm <= kMost * planesMm) return;
    throw InvalidInput("a voxel is " + formatShort(longestMm) + " mm long and " +
                       formatShort(planesMm) +
                       " mm thin; the method adaptive takes voxels up to 10,000 times as "
                       "long as thin, mc takes any");
}

}  // namespace

Extraction extractSurface(const VolumeView& volume, const SpanSpaceIndex& index,
                          const ExtractionOptions& options) {
    if (!std::isfinite(options.isovalue)) {
        throw InvalidInput("extractSurface: the isovalue is not a finite number");
    }
    const Index3& size = volume.geometry().size;
    requireMethod(options.discretized, "discretized", Method::DiscretizedMarchingCubes,
                  options.method);
    requireMethod(options.adaptive, "adaptive", Method::Adaptive, options.method);
    if (index.grid().volumeSize != size || index.pixelType() != volume.pixelType()) {
        throw InvalidInput("extractSurface: the index was built from another volume");
    }
    if (*std::max_element(size.begin(), size.end()) > detail::EdgeKey::kMaximumExtent) {
        throw InvalidInput("the image has more than " +
                           std::to_string(detail::EdgeKey::kMaximumExtent) +
                           " voxels along an axis; crop or resample it");
    }
    if (options.method == Method::Adaptive) {
        requireNoNeedles(volume.geometry());
        return detail::extractAdaptive(volume, index, options);
    }
    Extraction result = options.method == Method::MarchingCubes
                            ? detail::extractMarchingCubes(volume, index, options)
                            : detail::extractBoxes(volume, index, options);
    if (!options.computeNormals) result.mesh.normals = {};
    return result;
}

Extraction extractSurface(const VolumeView& volume, const ExtractionOptions& options,
                          Border border) {
    IndexOptions indexed;
    indexed.border = border;
    return extractSurface(volume, SpanSpaceIndex::build(volume, indexed), options);
}

}  // namespace adaptiso
