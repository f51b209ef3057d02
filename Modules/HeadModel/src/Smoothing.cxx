#include <algorithm>
#include <cmath>

#include "ImageSteps.h"
#include "WorkingGrid.h"
#include "adaptiso/Preprocessing/Crop.h"
#include "adaptiso/Preprocessing/Smooth.h"

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
    for (std::int64_t k = 0; k < size[2]; ++k) {
        for (std::int64_t j = 0; j < size[1]; ++j) {
            const std::int64_t row =
                box[0].first +
                grid.size[0] * (box[1].first + j + grid.size[1] * (box[2].first + k));
            std::copy_n(&from.at(0, j, k), size[0], values.begin() + row);
        }
    }
    return values;
}

}  // namespace adaptiso::headmodel
