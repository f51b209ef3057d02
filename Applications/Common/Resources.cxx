#include "Common/Resources.h"

#include <sys/resource.h>

#include <ostream>

#include "adaptiso/Core/Numbers.h"

namespace adaptiso {

double peakMemoryMb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;  // Linux counts KiB
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

void printTimes(std::ostream& out, const StageTimer& timer, int decimals) {
    out << formatFixed(timer.total(), decimals) << " s (";
    std::string_view separator;
    for (const auto& [stage, seconds] : timer.stages()) {
        out << separator << stage << ' ' << formatFixed(seconds, decimals);
        separator = ", ";
    }
    out << "), peak memory " << formatRounded(peakMemoryMb()) << " MB\n";
}

}  // namespace adaptiso
