#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <memory>

#include "adaptiso/Core/Memory.h"

namespace adaptiso {
namespace {

constexpr std::size_t kBytes = std::size_t{24} << 20, kPage = 4096;

/// Writes to every page of a list. \return page faults meanwhile
long faultsOfAList() {
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    const auto list = std::make_unique_for_overwrite<char[]>(kBytes);
    volatile char* const bytes = list.get();  // what is written must not be left out
    for (std::size_t at = 0; at < kBytes; at += kPage) bytes[at] = 1;
    getrusage(RUSAGE_SELF, &after);
    return after.ru_minflt - before.ru_minflt;
}

TEST(ReturnMemory, FreedMemoryIsKeptUntilItIsReturned) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
    GTEST_SKIP() << "memory is not the C library's";
#endif
    keepFreedMemory();
    const long first = faultsOfAList(), again = faultsOfAList();
    EXPECT_LT(again, first / 10 + 10);
    returnFreedMemory();
    EXPECT_GT(faultsOfAList(), again + 5);
}

}  // namespace
}  // namespace adaptiso
