// A machine of little memory: no input here is long enough to be worth a larger piece, whatever it
// claims to hold. Readers turn std::bad_alloc into a FileError or never cause it.

#include <cstdlib>
#include <new>

namespace {

// deflate packs 1032 bytes into one: 64 kB of input may become 64 MB
constexpr std::size_t kLargestPiece = std::size_t{256} << 20;

}  // namespace

void* operator new(std::size_t byteCount) {
    if (void* const memory = operator new(byteCount, std::nothrow)) return memory;
    throw std::bad_alloc();
}
void* operator new[](std::size_t byteCount) {
    return operator new(byteCount);
}
void* operator new(std::size_t byteCount, const std::nothrow_t&) noexcept {
    return byteCount <= kLargestPiece ? std::malloc(byteCount) : nullptr;
}
void* operator new[](std::size_t byteCount, const std::nothrow_t&) noexcept {
    return operator new(byteCount, std::nothrow);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
