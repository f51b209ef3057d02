#include "Resources.h"

#include <sys/resource.h>

namespace adaptiso::python {

double peakMemoryMb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;  // Linux counts KiB
}

}  // namespace adaptiso::python
