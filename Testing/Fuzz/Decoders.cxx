// Stands in for GDCM, which is not what is fuzzed: every sample it would decode is 0.

#include <cstring>

#include "GdcmDecoder.h"

namespace adaptiso::detail {

void decodeWithGdcm(const std::filesystem::path&, std::string_view, const std::string&,
                    const Codestream&, std::span<std::byte> samples) {
    std::memset(samples.data(), 0, samples.size());
}

}  // namespace adaptiso::detail
