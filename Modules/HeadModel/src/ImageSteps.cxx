#include "ImageSteps.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {

double stepMm(const ImageGeometry& grid) {
    return norm(grid.indexToPhysical.column[0]);
}

Mask closed(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    Mask result = eroded(dilated(mask, grid, radiusMm), grid, radiusMm);
    // closing only adds; discrete distances may say otherwise at single voxels
    for (std::size_t n = 0; n < mask.size(); ++n) result[n] |= mask[n];
    return result;
}

Mask opened(const Mask& mask, const ImageGeometry& grid, double radiusMm) {
    Mask result = dilated(eroded(mask, grid, radiusMm), grid, radiusMm);
    for (std::size_t n = 0; n < mask.size(); ++n) result[n] &= mask[n];
    return result;
}

Mask above(const std::vector<float>& values, double threshold) {
    // the least float that is not below it: floats are then compared with floats
    auto least = static_cast<float>(threshold);
    if (least < threshold) least = std::nextafter(least, std::numeric_limits<float>::infinity());
    Mask mask(values.size());
    // plain pointers: bytes may be anything's, so the compiler reloads all that it can't see is not
    const float* const from = values.data();
    std::uint8_t* const to = mask.data();
    forVoxels(values, [=](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) to[n] = from[n] >= least ? 1 : 0;
    });
    return mask;
}

std::int64_t voxelsIn(const Mask& mask) {
    return std::count(mask.begin(), mask.end(), std::uint8_t{1});
}

std::vector<float> partByLevel(const Mask& mask, const std::vector<float>& values, double level,
                               double low, const std::vector<std::uint8_t>& isImage,
                               const ImageGeometry& grid) {
    const double step = stepMm(grid), slope = 0.5 / (level - low);
    constexpr float kJustOutside = 0.49f;
    std::vector<float> part = depthMm(mask, grid, DepthBand::within(2 * step));
    forVoxels(part, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
            const auto own =
                static_cast<float>(std::clamp(0.5 + slope * (values[n] - level), 0.0, 1.0));
            if (mask[n] != 0) {
                part[n] = part[n] < step && own >= kFractionIsovalue ? own : 1;
            } else {
                const bool isNear = part[n] > -1.5 * step && isImage[n] != 0;
                part[n] = isNear ? std::min(own, kJustOutside) : 0;
            }
        }
    });
    return part;
}

}  // namespace adaptiso::headmodel
