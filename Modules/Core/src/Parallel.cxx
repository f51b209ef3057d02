#include "adaptiso/Core/Parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include "adaptiso/Core/Progress.h"

/// Core's parallel loops by oneTBB. ParallelSerial.cxx takes the place of this file where there is
/// none.
namespace adaptiso {
namespace {

constexpr auto kParallelism = tbb::global_control::max_allowed_parallelism;

}  // namespace

namespace detail {

void runPieces(std::int64_t count, std::int64_t grain, BodyRef<std::int64_t, std::int64_t> body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, pieces, 1),
                      [&](const tbb::blocked_range<std::int64_t>& range) {
                          for (std::int64_t piece = range.begin(); piece != range.end(); ++piece) {
                              InterruptionCheck::ask();
                              body(piece * grain, std::min(count, (piece + 1) * grain));
                          }
                      });
}

void runLargestFirst(std::span<const std::int64_t> sizes, BodyRef<std::int64_t> body) {
    std::vector<std::int64_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::int64_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int64_t a, std::int64_t b) { return sizes[a] > sizes[b]; });
    // ranges are dealt out in any order: each takes what comes next
    std::atomic<std::size_t> next = 0;
    const auto takeNext = [&](std::int64_t, std::int64_t) { body(order[next++]); };
    runPieces(std::ssize(order), 1, BodyRef<std::int64_t, std::int64_t>::to(takeNext));
}

void runBoth(BodyRef<> first, BodyRef<> second) {
    tbb::parallel_invoke([&] { first(); }, [&] { second(); });
}

void runInOrder(std::int64_t count, BodyRef<std::int64_t, std::shared_ptr<void>&> make,
                BodyRef<void*> take) {
    using Result = std::shared_ptr<void>;
    std::int64_t next = 0;
    // results differ in what they take: some wait for the ones before them, so that none waits for
    // work
    const auto most = static_cast<std::size_t>(4 * tbb::this_task_arena::max_concurrency());
    tbb::parallel_pipeline(
        most,
        tbb::make_filter<void, std::int64_t>(tbb::filter_mode::serial_in_order,
                                             [&](tbb::flow_control& control) {
                                                 if (next == count) control.stop();
                                                 return next++;
                                             }) &
            tbb::make_filter<std::int64_t, Result>(tbb::filter_mode::parallel,
                                                   [&](std::int64_t n) {
                                                       Result result;
                                                       make(n, result);
                                                       return result;
                                                   }) &
            tbb::make_filter<Result, void>(tbb::filter_mode::serial_in_order,
                                           [&](const Result& result) { take(result.get()); }));
}

void runIsolated(BodyRef<> body) {
    tbb::this_task_arena::isolate([&] { body(); });
}

}  // namespace detail

int threadLimit() {
    return static_cast<int>(tbb::global_control::active_value(kParallelism));
}

struct ThreadLimitGuard::Impl {
    tbb::global_control control;
};

ThreadLimitGuard::ThreadLimitGuard(int threads)
    : impl_(new Impl{{kParallelism, static_cast<std::size_t>(threads)}}) {}

ThreadLimitGuard::~ThreadLimitGuard() = default;

std::string threadingName() {
    return "oneTBB " + std::to_string(TBB_VERSION_MAJOR) + "." + std::to_string(TBB_VERSION_MINOR) +
           ".0";
}

}  // namespace adaptiso
