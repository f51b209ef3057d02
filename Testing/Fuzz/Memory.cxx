// A machine of little memory: no input here is long enough to be worth a larger piece, whatever it
// claims to hold. Readers turn std::bad_alloc into a FileError or never cause it.

#include <cstdlib>

#include "Support/OperatorNew.h"

namespace adaptiso::testing {

void* memoryForNew(std::size_t byteCount) noexcept {
    // deflate packs 1032 bytes into one: 64 kB of input may become 64 MB
    constexpr std::size_t kLargestPiece = std::size_t{256} << 20;
    return byteCount <= kLargestPiece ? std::malloc(byteCount) : nullptr;
}

}  // namespace adaptiso::testing
