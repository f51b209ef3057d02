#include "adaptiso/Core/Parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>

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

void runBoth(BodyRef<> first, BodyRef<> second) {
    tbb::parallel_invoke([&] { first(); }, [&] { second(); });
}

}  // namespace adaptiso::detail
