#include "adaptiso/Files/StageTimer.h"

#include <sys/resource.h>

namespace adaptiso {

double peakMemoryMb() {
#ifdef __EMSCRIPTEN__  // the memory that a page gives to WebAssembly grows and does not shrink
    return static_cast<double>(__builtin_wasm_memory_size(0)) * 65536 / 1e6;
#else
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;  // Linux counts KiB
#endif
}

double StageTimer::seconds(std::string_view stage) const {
    for (const auto& [name, seconds] : stages_) {
        if (name == stage) return seconds;
    }
    return 0;
}

void StageTimer::add(std::string_view stage, double seconds) {
    for (auto& [name, sum] : stages_) {
        if (name == stage) {
            sum += seconds;
            return;
        }
    }
    stages_.emplace_back(stage, seconds);
}

}  // namespace adaptiso
