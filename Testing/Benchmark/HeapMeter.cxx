#include "HeapMeter.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <limits>

// glibc's own functions under their other names ("Replacing malloc" in its manual).
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t align, std::size_t size);
void __libc_free(void* block);
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

namespace {

std::atomic<bool> isCounting{false};
std::atomic<std::int64_t> liveBytes{0};
std::atomic<std::int64_t> peakBytes{0};

void add(std::int64_t bytes) noexcept {
    const std::int64_t live = liveBytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::int64_t peak = peakBytes.load(std::memory_order_relaxed);
    while (live > peak && !peakBytes.compare_exchange_weak(peak, live, std::memory_order_relaxed)) {
    }
}

std::int64_t usableBytes(void* block) noexcept {
    return static_cast<std::int64_t>(malloc_usable_size(block));
}

void* counted(void* block) noexcept {
    if (isCounting.load(std::memory_order_relaxed)) add(usableBytes(block));
    return block;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) noexcept {
    return counted(__libc_malloc(size));
}

void* calloc(std::size_t count, std::size_t size) noexcept {
    return counted(__libc_calloc(count, size));
}

void* realloc(void* block, std::size_t size) noexcept {
    const std::int64_t before = usableBytes(block);
    void* const moved = __libc_realloc(block, size);
    const bool isOldGone = moved != nullptr || size == 0;
    if (isOldGone && isCounting.load(std::memory_order_relaxed)) add(usableBytes(moved) - before);
    return moved;
}

void free(void* block) noexcept {
    if (isCounting.load(std::memory_order_relaxed)) add(-usableBytes(block));
    __libc_free(block);
}

void* memalign(std::size_t align, std::size_t size) noexcept {
    return counted(__libc_memalign(align, size));
}

void* aligned_alloc(std::size_t align, std::size_t size) noexcept {
    return counted(__libc_memalign(align, size));
}

int posix_memalign(void** result, std::size_t align, std::size_t size) noexcept {
    if (align % sizeof(void*) != 0 || align == 0 || (align & (align - 1)) != 0) return EINVAL;
    void* const block = counted(__libc_memalign(align, size));
    if (block == nullptr) return ENOMEM;
    *result = block;
    return 0;
}

}  // extern "C"

namespace adaptiso::benchmarks {

std::int64_t peakHeapBytes(const std::function<void()>& work) {
    liveBytes = 0;
    peakBytes = 0;
    isCounting = true;
    try {
        work();
    } catch (...) {
        isCounting = false;
        throw;
    }
    isCounting = false;
    return peakBytes;
}

void keepFreedMemory() {
    constexpr int kLargestThreshold = 32 << 20;  // glibc takes no larger one
    mallopt(M_MMAP_THRESHOLD, kLargestThreshold);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

}  // namespace adaptiso::benchmarks
