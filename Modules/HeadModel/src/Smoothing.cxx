#include <algorithm>
#include <cmath>

#include "ImageSteps.h"
#include "WorkingGrid.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::headmodel {

std::vector<float> smoothed(std::vector<float> values, const ImageGeometry& grid, double sigmaMm) {
    if (sigmaMm < stepMm(grid) / 3) return values;
    Index3 first, last;
    if (!boundingIndices(values, grid.size, std::numeric_limits<float>::min(), first, last)) {
        return values;
    }
    const auto room = static_cast<std::int64_t>(std::ceil(4.5 * sigmaMm / stepMm(grid)));
    CropRanges box;
    for (int a = 0; a < 3; ++a) {
        box[a].first = std::max<std::int64_t>(first[a] - room, 0);
        box[a].end = std::min(last[a] + room + 1, grid.size[a]);
    }
    const Volume part =
        smoothVolumeRecursively(cropVolume(VolumeView(values.data(), grid), box), sigmaMm);
    const TypedVolumeView<float> from = part.view().as<float>();
    const Index3& size = from.geometry.size;
    forEachRow({box[0].first, box[1].first, box[2].first}, size, grid.size,
               [&](std::int64_t row, std::int64_t inBox) {
                   std::copy_n(from.samples + inBox, size[0], values.begin() + row);
               });
    return values;
}

}  // namespace adaptiso::headmodel
