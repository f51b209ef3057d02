// libFuzzer target: bytes that claim to be the index of a small volume. Whatever they hold, they
// are refused or give the index that the volume itself gives.
//
// The first byte chooses the volume's pixel type, and whether the rest gets the right checksum, as
// a forger would give it, so that the fuzzer gets past that check.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/SpanSpace/IndexFile.h"

namespace adaptiso {
namespace {

constexpr std::size_t kChecksumBytes = 8;

/// 7 x 6 x 5 samples of several values.
template <class T>
Volume smallVolume() {
    ImageGeometry geometry;
    geometry.size = {7, 6, 5};
    std::vector<T> samples(7 * 6 * 5);
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = static_cast<T>(n * n % 97);
    return Volume::fromSamples(std::move(samples), geometry);
}

const Volume& volumeOf(unsigned choice) {
    static const Volume volumes[] = {smallVolume<std::uint8_t>(),  smallVolume<std::int8_t>(),
                                     smallVolume<std::uint16_t>(), smallVolume<std::int16_t>(),
                                     smallVolume<std::uint32_t>(), smallVolume<std::int32_t>(),
                                     smallVolume<std::uint64_t>(), smallVolume<std::int64_t>(),
                                     smallVolume<float>(),         smallVolume<double>()};
    return volumes[choice % 10];
}

void seal(std::vector<std::byte>& bytes) {
    if (bytes.size() < kChecksumBytes) return;
    const std::size_t content = bytes.size() - kChecksumBytes;
    const std::uint64_t checksum = indexChecksum(std::span(bytes).first(content));
    std::memcpy(bytes.data() + content, &checksum, kChecksumBytes);
}

void requireSameAnswers(const SpanSpaceIndex& index, const VolumeView& volume) {
    const SpanSpaceIndex truth = SpanSpaceIndex::build(volume, index.options());
    for (const double isovalue : {-1e9, 0.0, 0.5, 20.0, 60.5, 96.0, 1e9}) {
        if (index.blocksAt(isovalue).blocks != truth.blocksAt(isovalue).blocks) std::abort();
    }
}

}  // namespace
}  // namespace adaptiso

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const adaptiso::Volume& volume = adaptiso::volumeOf(data[0] & 0x0f);
    std::vector<std::byte> bytes(size - 1);
    if (size > 1) std::memcpy(bytes.data(), data + 1, size - 1);
    if ((data[0] & 0x80) == 0) adaptiso::seal(bytes);
    try {
        adaptiso::requireSameAnswers(adaptiso::decodeIndex(bytes, volume), volume);
    } catch (const adaptiso::InvalidInput&) {  // refused, as it should be
    }
    return 0;
}
