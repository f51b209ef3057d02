#pragma once

#include <functional>
#include <string_view>

namespace adaptiso {

/// Reports the progress of a long call: the stage's name and the part of it done, 0 to 1. Called
/// from the calling thread only. May be empty (no progress reporting).
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

/// Lets long work be ended from outside, also where it reports no progress: as long as one of these
/// lives, parallel loops call its function now and then on the thread that made it. What the
/// function throws ends the loop and comes out of the work, as a lack of memory does.
class InterruptionCheck {
public:
    /// Keeps a reference to `check`, which is called every tenth of a second at most.
    explicit InterruptionCheck(const std::function<void()>& check);
    InterruptionCheck(const InterruptionCheck&) = delete;
    InterruptionCheck& operator=(const InterruptionCheck&) = delete;
    ~InterruptionCheck();

    /// Calls this thread's check where there is one and it is time. For loops of other kinds.
    static void ask();

private:
    const std::function<void()>& check_;
    InterruptionCheck* outer_;
    double lastSeconds_;
};

}  // namespace adaptiso
