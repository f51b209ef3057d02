#include "adaptiso/Report/ColorMap.h"

#include <algorithm>
#include <cmath>

namespace adaptiso {
namespace {

constexpr std::array<ReportColor, 10> kViridis{{{68, 1, 84},
                                                {72, 40, 120},
                                                {62, 73, 137},
                                                {49, 104, 142},
                                                {38, 130, 142},
                                                {31, 158, 137},
                                                {53, 183, 121},
                                                {110, 206, 88},
                                                {181, 222, 43},
                                                {253, 231, 37}}};

constexpr std::array<ReportColor, 6> kSurfaces{{{240, 228, 66},
                                                {86, 180, 233},
                                                {230, 159, 0},
                                                {0, 178, 130},
                                                {230, 140, 190},
                                                {255, 110, 30}}};

}  // namespace

ReportColor viridis(double part) {
    const double place = (part > 0 ? std::min(part, 1.0) : 0.0) * (kViridis.size() - 1);
    const std::size_t below =
        std::min<std::size_t>(static_cast<std::size_t>(place), kViridis.size() - 2);
    const double rest = place - static_cast<double>(below);
    ReportColor color;
    for (std::size_t channel = 0; channel < color.size(); ++channel) {
        const double from = kViridis[below][channel], to = kViridis[below + 1][channel];
        color[channel] = static_cast<std::uint8_t>(std::lround(from + rest * (to - from)));
    }
    return color;
}

ReportColor surfaceColor(std::size_t n) {
    return kSurfaces[n % kSurfaces.size()];
}

}  // namespace adaptiso
