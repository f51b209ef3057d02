#include "adaptiso/Extraction/Extraction.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptive/AdaptiveMethod.h"
#include "boxes/BoxesMethod.h"
#include "cells/MarchingCubes.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso {

namespace {
constexpr std::array<std::string_view, 5> kMethods{"adaptive", "boxes", "dmc", "asc", "mc"};
}

std::string_view toString(Method method) {
    return kMethods[static_cast<std::size_t>(method)];
}

const Options<ExtractionOptions>& methodOptions() {
    static const Options<ExtractionOptions> kRows{option<&ExtractionOptions::method>(
        {.name = "method",
         .key = "method",
         .label = "Method",
         .help =
             "adaptive: few triangles within a stated distance of the surface, none crossing "
             "another; boxes: cubes of several sizes, merged where the surface is flat; dmc: "
             "discretized marching cubes, coplanar facets between edge midpoints merged; asc: "
             "adaptive skeleton climbing, rectangular boxes, unmerged; mc: marching cubes, every "
             "voxel at full resolution",
         .standard = "adaptive",
         .words = kMethods})};
    return kRows;
}

const Options<DiscretizedOptions>& discretizedOptions() {
    static const Options<DiscretizedOptions> kRows{
        option<&DiscretizedOptions::adjustVertices>(
            {.name = "adjust-vertices",
             .key = "adjustVertices",
             .help = "Move the vertices of the method dmc from the midpoints to where the image "
                     "reaches the isovalue"}),
        option<&DiscretizedOptions::mergeWithinBlocks>(
            {.name = "merge-within-blocks",
             .key = "mergeWithinBlocks",
             .help = "Merge facets of the method dmc within blocks of --block-size voxels only"})};
    return kRows;
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

void requireUsable(const VolumeView& volume, const ExtractionOptions& options) {
    if (!std::isfinite(options.isovalue)) {
        throw InvalidInput("extractSurface: the isovalue is not a finite number");
    }
    requireMethod(options.discretized, "discretized", Method::DiscretizedMarchingCubes,
                  options.method);
    requireMethod(options.adaptive, "adaptive", Method::Adaptive, options.method);
    if (options.method == Method::Adaptive) {
        requireInRange(options.adaptive, "extractSurface");
    }
    const Index3& size = volume.geometry().size;
    if (*std::max_element(size.begin(), size.end()) > detail::EdgeKey::kMaximumExtent) {
        throw InvalidInput("the image has more than " +
                           std::to_string(detail::EdgeKey::kMaximumExtent) +
                           " voxels along an axis; crop or resample it");
    }
    requireNoNeedles(volume.geometry());
}

/// \param query  the grid's blocks that the isovalue touches
Extraction extractFrom(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                       const ExtractionOptions& options) {
    if (options.method == Method::Adaptive) {
        return detail::extractAdaptive(volume, grid, std::move(query), options);
    }
    Extraction result = options.method == Method::MarchingCubes
                            ? detail::extractMarchingCubes(volume, grid, std::move(query), options)
                            : detail::extractBoxes(volume, grid, std::move(query), options);
    if (!options.computeNormals) freeMemory(result.mesh.normals);
    return result;
}

}  // namespace

Extraction extractSurface(const VolumeView& volume, const SpanSpaceIndex& index,
                          const ExtractionOptions& options) {
    requireUsable(volume, options);
    if (index.grid().volumeSize != volume.geometry().size ||
        index.pixelType() != volume.pixelType()) {
        throw InvalidInput("extractSurface: the index was built from another volume");
    }
    return extractFrom(volume, index.grid(), index.blocksAt(options.isovalue), options);
}

Extraction extractSurface(const VolumeView& volume, const ExtractionOptions& options,
                          Border border) {
    requireUsable(volume, options);
    const BlockGrid grid =
        BlockGrid::make(volume.geometry().size, IndexOptions{}.blockSize, border);
    return extractFrom(volume, grid, findBlocksAt(volume, grid, options.isovalue), options);
}

}  // namespace adaptiso
