#include "SmallVolume.h"

#include <vector>

namespace adaptiso::fuzz {
namespace {

template <class T>
Volume made() {
    ImageGeometry geometry;
    geometry.size = {7, 6, 5};
    std::vector<T> samples(7 * 6 * 5);
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = static_cast<T>(n * n % 97);
    return Volume::fromSamples(std::move(samples), geometry);
}

}  // namespace

const Volume& smallVolume(unsigned choice) {
    static const Volume volumes[kSmallVolumes] = {
        made<std::uint8_t>(),  made<std::int8_t>(),  made<std::uint16_t>(), made<std::int16_t>(),
        made<std::uint32_t>(), made<std::int32_t>(), made<std::uint64_t>(), made<std::int64_t>(),
        made<float>(),         made<double>()};
    return volumes[choice % kSmallVolumes];
}

}  // namespace adaptiso::fuzz
