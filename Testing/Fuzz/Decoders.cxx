// Stands in for ITK and GDCM, which are not what is fuzzed: every sample they would decode is 0.

#include <cstring>

#include "GdcmDecoder.h"
#include "ItkDecoder.h"

namespace adaptiso::detail {

Volume decodeNrrdWithItk(const std::filesystem::path& file, PixelType type,
                         const ImageGeometry& geometry) {
    const std::uint64_t byteCount = requireImageBytes(file, geometry.size, type);
    SampleBuffer samples = allocateSamples(file, byteCount);
    std::memset(samples.get(), 0, byteCount);
    return makeVolume(std::move(samples), type, geometry);
}

void decodeWithGdcm(const std::filesystem::path&, std::string_view, const std::string&,
                    const Codestream&, std::span<std::byte> samples) {
    std::memset(samples.data(), 0, samples.size());
}

}  // namespace adaptiso::detail
