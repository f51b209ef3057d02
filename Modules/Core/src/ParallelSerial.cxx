#include <algorithm>
#include <numeric>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Progress.h"

/// Core's parallel loops in one thread, where there is no oneTBB: the same pieces in the same
/// order.
namespace adaptiso {
namespace detail {

void runPieces(std::int64_t count, std::int64_t grain, BodyRef<std::int64_t, std::int64_t> body) {
    for (std::int64_t begin = 0; begin < count; begin += grain) {
        InterruptionCheck::ask();
        body(begin, std::min(count, begin + grain));
    }
}

void runLargestFirst(std::span<const std::int64_t> sizes, BodyRef<std::int64_t> body) {
    std::vector<std::int64_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::int64_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int64_t a, std::int64_t b) { return sizes[a] > sizes[b]; });
    for (const std::int64_t n : order) {
        InterruptionCheck::ask();
        body(n);
    }
}

void runBoth(BodyRef<> first, BodyRef<> second) {
    first();
    second();
}

void runInOrder(std::int64_t count, BodyRef<std::int64_t, std::shared_ptr<void>&> make,
                BodyRef<void*> take) {
    for (std::int64_t n = 0; n < count; ++n) {
        std::shared_ptr<void> result;
        make(n, result);
        take(result.get());
    }
}

void runIsolated(BodyRef<> body) {
    body();
}

}  // namespace detail

int threadLimit() {
    return 1;
}

struct ThreadLimitGuard::Impl {};
ThreadLimitGuard::ThreadLimitGuard(int) {}
ThreadLimitGuard::~ThreadLimitGuard() = default;

std::string threadingName() {
    return "one thread";
}

}  // namespace adaptiso
