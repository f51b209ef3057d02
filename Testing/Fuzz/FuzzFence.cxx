// libFuzzer target: bytes that claim to be what a child behind the fence tells its parent. They are
// refused, or are an answer that says the same again when packed and parsed once more.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "Fence.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace adaptiso::detail;
    const auto answer = parseFenceAnswer({reinterpret_cast<const char*>(data), size});
    if (!answer) return 0;
    const std::string packed = packFenceAnswer(*answer);
    const auto again = parseFenceAnswer(packed);
    if (!again || packFenceAnswer(*again) != packed) std::abort();
    return 0;
}
