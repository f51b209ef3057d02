#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace adaptiso {

/// Most memory that this process has had resident so far, MB (10^6 bytes).
double peakMemoryMb();

/// Wall-clock seconds by stage, in the order in which the stages first ran.
class StageTimer {
public:
    using Clock = std::chrono::steady_clock;

    /// Runs `work`, adds the time it takes to `stage` and returns what it returns.
    template <class Work>
    decltype(auto) time(std::string_view stage, Work&& work) {
        const Running running(*this, stage);
        return std::forward<Work>(work)();
    }

    const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

    /// Seconds of `stage`; 0 when it has not run.
    double seconds(std::string_view stage) const;

    /// Seconds since this timer was made.
    double total() const { return secondsSince(start_); }

private:
    struct Running {
        Running(StageTimer& timer, std::string_view stage) : timer_(timer), stage_(stage) {}
        ~Running() { timer_.add(stage_, secondsSince(start_)); }
        Running(const Running&) = delete;
        Running& operator=(const Running&) = delete;

        StageTimer& timer_;
        std::string_view stage_;
        Clock::time_point start_ = Clock::now();
    };

    static double secondsSince(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }
    void add(std::string_view stage, double seconds);

    Clock::time_point start_ = Clock::now();
    std::vector<std::pair<std::string, double>> stages_;
};

}  // namespace adaptiso
