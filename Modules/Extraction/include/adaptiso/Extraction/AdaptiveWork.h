#pragma once

#include <cstdint>

namespace adaptiso {

/// How the adaptive method came to its mesh.
struct AdaptiveWork {
    int runs = 0;                     ///< of the whole simplification; 1 is the rule
    std::int64_t placesMended = 0;    ///< beyond the bound after a run, or where triangles crossed
    std::int64_t verticesUndone = 0;  ///< that came apart again where mending did not help
    /// At full resolution still: noise (AdaptiveOptions::leavesNoise), places that failed
    /// in run after run, and in simplify() what is kept of the input.
    std::int64_t trianglesKept = 0;
};

}  // namespace adaptiso
