#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Json/Figures.h"
#include "adaptiso/Preprocessing/Preprocess.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso {

/// Parts of the report adaptiso-mesh/1, as adaptiso-mesh's README.md describes it, for the program
/// and for those who make surfaces without it. A number that is not known, or not finite, is null.

/// `input` from the format on: format, geometryJson(), pixelType, minimum, maximum, warnings.
Json imageJson(const std::string& format, const ImageGeometry& geometry, PixelType pixelType,
               const ValueRange& range, const std::vector<Warning>& warnings);

/// The volume from which surfaces are made, where preprocess() changed it.
struct PreprocessedImage {
    ImageGeometry geometry;
    PixelType pixelType{};
    ValueRange range{};
};

/// How an image of this size is preprocessed: crop, smoothSigmaMm, resampleMm, interpolation; null
/// where not asked for, and null altogether when nothing was.
Json preprocessingJson(const PreprocessOptions& options, const Index3& size);

/// The same, with geometry, pixel type and range of the preprocessed image; null without `image`.
Json preprocessedJson(const PreprocessOptions& options, const Index3& size,
                      const std::optional<PreprocessedImage>& image);

/// `options` as far as they concern the surface.
Json surfaceOptionsJson(const ExtractionOptions& extraction, const IndexOptions& index,
                        const ComponentSelection& selection);

/// Rows of `adaptive` of an entry of `surfaces`.
const Figures<AdaptiveWork>& workFigures();
/// Their object; all null for other methods.
Json workJson(const std::optional<AdaptiveWork>& work);

/// A surface, and what it was made with.
struct MadeSurface {
    const SurfaceRecord& surface;
    Method method;
    int blockSize;
};

/// Rows of an entry of `surfaces`, without its `output`.
const Figures<MadeSurface>& surfaceFigures();

}  // namespace adaptiso
