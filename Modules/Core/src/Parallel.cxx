#include "adaptiso/Core/Parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include "adaptiso/Core/Interruption.h"

namespace adaptiso::detail {

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

}  // namespace adaptiso::detail
