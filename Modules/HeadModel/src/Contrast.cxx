#include "Contrast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace adaptiso::headmodel {

void backgroundToAir(FloatImage& image) {
    constexpr double kMost = 0.6;  // a head touches a face or two, and its air is noisy or 0
    std::map<float, std::int64_t> counts;
    std::int64_t all = 0;
    forEachBorderVoxel(image.geometry.size, [&](std::int64_t n) {
        ++all;
        ++counts[image.values[n]];
    });
    const auto most =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (static_cast<double>(most->second) < kMost * static_cast<double>(all)) return;
    const float background = most->first;
    float air = std::numeric_limits<float>::infinity();
    for (const float value : image.values) {
        if (value != background) air = std::min(air, value);
    }
    if (!(air < background)) return;
    std::replace(image.values.begin(), image.values.end(), background, air);
}

bool isFluidBright(const std::vector<float>& t1, const std::vector<float>& belowSkinMm,
                   const ImageGeometry& grid, const HeadLevels& levels) {
    constexpr double kBlockMm = 16, kLeastBelowMm = 15, kTail = 0.03, kLongTail = 0.25;
    const auto side = static_cast<std::int64_t>(std::max(4.0, std::round(kBlockMm / stepMm(grid))));
    const Index3& size = grid.size;
    const std::int64_t row = size[0], slice = size[0] * size[1];
    std::int64_t blocks = 0, bright = 0;
    std::vector<float> values;
    for (std::int64_t z = 0; z + side < size[2]; z += side) {
        for (std::int64_t y = 0; y + side < size[1]; y += side) {
            for (std::int64_t x = 0; x + side < size[0]; x += side) {
                values.clear();
                // means of eight voxels: less noise
                for (std::int64_t k = z; k + 1 < z + side; k += 2) {
                    for (std::int64_t j = y; j + 1 < y + side; j += 2) {
                        for (std::int64_t i = x; i + 1 < x + side; i += 2) {
                            const std::int64_t n = i + row * j + slice * k;
                            if (belowSkinMm[n] < kLeastBelowMm) continue;
                            float sum = 0;
                            for (const std::int64_t m : {n, n + row, n + slice, n + row + slice}) {
                                sum += t1[m] + t1[m + 1];
                            }
                            values.push_back(sum / 8);
                        }
                    }
                }
                if (std::ssize(values) < side * side * side / 16) continue;
                std::sort(values.begin(), values.end());
                const auto at = [&](double share) {
                    return (values[static_cast<std::size_t>(
                                share * static_cast<double>(values.size() - 1))] -
                            levels.air) /
                           (levels.tissue - levels.air);
                };
                const double low = at(kTail), middle = at(0.5), high = at(1 - kTail);
                if (middle < 0.5) continue;  // bone, airways
                ++blocks;
                if (high - middle > std::max(middle - low, kLongTail * middle)) ++bright;
            }
        }
    }
    return 2 * bright > blocks;
}

}  // namespace adaptiso::headmodel
