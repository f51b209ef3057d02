#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

namespace adaptiso {

/// Calls body(begin, end) over [0, count) cut into pieces of `grain` (the last may be shorter),
/// in parallel. The cuts depend on count and grain alone, never on the number of threads, so a
/// result kept per piece (number begin / grain) is the same on every machine.
template <class Body>
void parallelForPieces(std::int64_t count, std::int64_t grain, const Body& body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, pieces, 1),
                      [&](const tbb::blocked_range<std::int64_t>& range) {
                          for (std::int64_t piece = range.begin(); piece != range.end(); ++piece) {
                              body(piece * grain, std::min(count, (piece + 1) * grain));
                          }
                      });
}

}  // namespace adaptiso
