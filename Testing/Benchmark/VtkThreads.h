#pragma once

// C++17, as VtkThreads.cxx is.
#include <string>

namespace adaptiso::benchmarks {

/// What VTK runs its parallel loops on.
struct VtkThreads {
    std::string backend;  ///< "TBB", "STDThread", "OpenMP", "Sequential"
    int threads;          ///< that it will use
};

/// Asks VTK for `threads` threads (it takes no more than the machine has); a Sequential backend
/// stays at one. \pre threads >= 1
VtkThreads setVtkThreads(int threads);

/// "9.1.0"
std::string vtkVersionText();

}  // namespace adaptiso::benchmarks
