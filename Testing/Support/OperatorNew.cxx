// Replaces operator new and delete of the program that this file is a source of (no library's:
// every program that links it would get them). Those for overaligned types stay as they are.

#include "OperatorNew.h"

#include <cstdlib>
#include <new>

using adaptiso::testing::memoryForNew;

void* operator new(std::size_t byteCount) {
    if (void* const memory = memoryForNew(byteCount)) return memory;
    throw std::bad_alloc();
}
void* operator new[](std::size_t byteCount) {
    return operator new(byteCount);
}
void* operator new(std::size_t byteCount, const std::nothrow_t&) noexcept {
    return memoryForNew(byteCount);
}
void* operator new[](std::size_t byteCount, const std::nothrow_t&) noexcept {
    return memoryForNew(byteCount);
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
