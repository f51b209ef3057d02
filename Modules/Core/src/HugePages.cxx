#include "adaptiso/Core/HugePages.h"

#ifdef __linux__
#include <sys/mman.h>

#include <memory>
#endif

namespace adaptiso {

void preferHugePages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::size_t kPage = std::size_t{1} << 21;
    void* first = begin;
    std::size_t room = bytes;
    if (begin == nullptr || std::align(kPage, kPage, first, room) == nullptr) return;
    // a wish: what it answers changes nothing
    madvise(first, room / kPage * kPage, MADV_HUGEPAGE);
#endif
}

}  // namespace adaptiso
