#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adaptiso/Core/Progress.h"

namespace adaptiso {

/// Takes what ProgressLine shows ("extract 42 %"; empty when it is wiped) in the place of a
/// terminal: for a program that runs inside a page.
void observeProgress(std::function<void(const std::string&)> observer);

/// One line on a terminal's stderr that says what is going on ("extract 42 %, 3 s", the time since
/// the program began), and nothing at all when stderr is a file or a pipe, or with --quiet. The
/// line is wiped at the end.
class ProgressLine {
public:
    explicit ProgressLine(bool isQuiet);
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// `stage` runs, for an unknown time.
    void show(std::string_view stage);
    /// `stage` has done `fraction` (0 to 1) of its work.
    void show(std::string_view stage, double fraction);
    /// Wipes the line, before other text is written.
    void clear();

    /// To be handed to a library call; this object must outlive it. Empty when nothing is shown.
    ProgressCallback callback();

private:
    void write(std::string text);

    bool isShown_;
    std::string written_;
};

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

/// The last line of a program's report: "1.23 s (read 0.50, extract 0.73), peak memory 100 MB".
void printTimes(std::ostream& out, const StageTimer& timer, int decimals = 2);

}  // namespace adaptiso
