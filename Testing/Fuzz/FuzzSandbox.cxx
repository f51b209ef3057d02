// libFuzzer target: bytes that claim to be what a child in the sandbox process tells its parent.
// They are refused, or are an answer that says the same again when packed and parsed once more.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "Sandbox.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace adaptiso::detail;
    const auto answer = parseSandboxAnswer({reinterpret_cast<const char*>(data), size});
    if (!answer) return 0;
    const std::string packed = packSandboxAnswer(*answer);
    const auto again = parseSandboxAnswer(packed);
    if (!again || packSandboxAnswer(*again) != packed) std::abort();
    return 0;
}
