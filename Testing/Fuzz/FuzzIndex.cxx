// libFuzzer target: bytes that claim to be the index of a small volume. They are refused with an
// InvalidInput or give the index that the volume itself gives.
//
// The first byte chooses the volume and whether the rest gets the right checksum, as a forger would
// give it: else no input would get past that check.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "OneLine.h"
#include "SmallVolume.h"
#include "adaptiso/SpanSpace/IndexFile.h"

namespace {

void seal(std::vector<std::byte>& bytes) {
    constexpr std::size_t kChecksumBytes = 8;
    if (bytes.size() < kChecksumBytes) return;
    const std::size_t content = bytes.size() - kChecksumBytes;
    const std::uint64_t checksum = adaptiso::indexChecksum(std::span(bytes).first(content));
    std::memcpy(bytes.data() + content, &checksum, kChecksumBytes);
}

void requireSameAnswers(const adaptiso::SpanSpaceIndex& index, const adaptiso::VolumeView& volume) {
    const auto truth = adaptiso::SpanSpaceIndex::build(volume, index.options());
    for (const double isovalue : {-1e9, 0.0, 0.5, 20.0, 60.5, 96.0, 1e9}) {
        if (index.blocksAt(isovalue).blocks != truth.blocksAt(isovalue).blocks) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const adaptiso::Volume& volume = adaptiso::fuzz::smallVolume(data[0] & 0x0f);
    const auto given = std::as_bytes(std::span(data + 1, size - 1));
    std::vector<std::byte> bytes(given.begin(), given.end());
    const bool isSealed = (data[0] & 0x80) == 0;
    if (isSealed) seal(bytes);
    try {
        requireSameAnswers(adaptiso::decodeIndex(bytes, volume), volume);
    } catch (const adaptiso::InvalidInput& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
