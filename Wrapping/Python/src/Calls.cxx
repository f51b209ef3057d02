#include "Calls.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>

#include "adaptiso/Core/Interruption.h"

namespace adaptiso::python {
namespace {

/// At least so long between two looks at Python: what looking costs is then nothing.
constexpr double kToldEverySeconds = 0.02;

double now() {
    using Clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// oneTBB's workers, as long as they can be ended before a fork. Never freed: the end of a process
/// is too late to wait for workers.
tbb::task_scheduler_handle*& workers() {
    static auto* handle = new tbb::task_scheduler_handle{tbb::attach{}};
    return handle;
}

std::atomic<bool> forkedDuringCall{false};  ///< the workers could not be ended before the fork
std::atomic<bool> hasOneThread{false};      ///< this is a child of such a fork

}  // namespace

void runUnlocked(int threads, const std::function<void()>& work) {
    workers();
    const py::gil_scoped_release unlocked;
    // more than there are only makes oneTBB print a warning
    const auto most = static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    tbb::task_arena arena(hasOneThread ? 1 : threads > 0 ? std::min(threads, most) : most);
    arena.execute(work);
}

/// To be called without the lock. \throws Stopped
void Watcher::lookForSignals() {
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() == 0) return;
    error_.emplace();
    throw Stopped();
}

void Watcher::tell(std::string_view stage, double fraction) {
    const double time = now();
    if (fraction < 1 && time - lastTold_ < kToldEverySeconds) return;
    lastTold_ = time;
    const py::gil_scoped_acquire locked;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!callback_.is_none()) callback_(py::str(stage.data(), stage.size()), fraction);
    } catch (const py::error_already_set& error) {
        error_.emplace(error);
        throw Stopped();
    }
}

ProgressCallback Watcher::callback() {
    return [this](std::string_view stage, double fraction) { tell(stage, fraction); };
}

void Watcher::run(int threads, const std::function<void()>& work) {
    try {
        const std::function<void()> look = [this] { lookForSignals(); };
        runUnlocked(threads, [&] {
            const InterruptionCheck check(look);
            work();
        });
    } catch (const Stopped&) {
        throw py::error_already_set(*error_);
    }
}

void beforeFork() {
    // fails while another thread works
    forkedDuringCall = !tbb::finalize(*workers(), std::nothrow);
    delete workers();
    workers() = nullptr;
}

void afterForkInParent() {
    workers() = new tbb::task_scheduler_handle{tbb::attach{}};
}

void afterForkInChild() {
    if (forkedDuringCall) hasOneThread = true;
    workers() = new tbb::task_scheduler_handle{tbb::attach{}};
}

}  // namespace adaptiso::python
