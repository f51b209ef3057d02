#pragma once

#include <chrono>

namespace adaptiso::python {

/// Who made it, in reports.
inline constexpr const char* kProgramName = "adaptiso (Python)";

inline double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Most memory that this process has had resident so far, MB (10^6 bytes).
double peakMemoryMb();

}  // namespace adaptiso::python
