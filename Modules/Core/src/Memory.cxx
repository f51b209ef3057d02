#include "adaptiso/Core/Memory.h"

#include <cstdlib>  // says which C library it is

#ifdef __linux__
#include <sys/mman.h>

#include <memory>
#endif
#ifdef __GLIBC__
#include <malloc.h>
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

void returnFreedMemory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void keepFreedMemory() {
#ifdef __GLIBC__
    // bytes of a list, and in all: with a GB of both there were no fewer page faults, and a label
    // map of 256^3 took 18 % more memory instead of 4
    constexpr int kLargestKept = 32 << 20, kMostKept = 128 << 20;
    mallopt(M_MMAP_THRESHOLD, kLargestKept);
    mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

}  // namespace adaptiso
