#include "Calls.h"

#include <cxxabi.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "adaptiso/Core/Progress.h"

namespace adaptiso::python {

namespace {

/// At least so long between two looks at Python: what looking costs is then nothing.
constexpr double kProgressSeconds = 0.02;

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

std::atomic<int> unlockedThreads{0};
std::atomic<bool> isEnding{false};
std::thread::id lastThread;  ///< may make calls while the interpreter ends

bool mustEnd() {
    return isEnding && std::this_thread::get_id() != lastThread;
}

/// Does what may ask for the interpreter's lock; see Unlocked.
template <class F>
void outlastingTheInterpreter(const F& work) {
    try {
        work();
    } catch (const abi::__forced_unwind&) {
        for (;;) pause();  // to leave this block would be the abort
    }
}

class Locked {
public:
    Locked() {
        outlastingTheInterpreter([this] { lock_.emplace(); });
    }

private:
    std::optional<py::gil_scoped_acquire> lock_;
};

void runInArena(int threads, const std::function<void()>& work) {
    workers();
    const Unlocked unlocked;
    // more than there are only makes oneTBB print a warning
    const auto most = static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    tbb::task_arena arena(hasOneThread ? 1 : threads > 0 ? std::min(threads, most) : most);
    arena.execute(work);
}

}  // namespace

Unlocked::Unlocked() {
    ++unlockedThreads;
    state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
    --unlockedThreads;
    outlastingTheInterpreter([this] { PyEval_RestoreThread(state_); });
}

void runUnlocked(int threads, const std::function<void()>& work) {
    Watcher(py::none()).run(threads, work);
}

/// To be called with the lock, and an exception of Python's.
void Watcher::stop() {
    error_.emplace();
    throw Stopped();
}

/// To be called without the lock. \throws Stopped
void Watcher::lookForSignals() {
    const Locked locked;
    if (mustEnd()) {
        PyErr_SetNone(PyExc_SystemExit);
        stop();
    }
    if (PyErr_CheckSignals() != 0) stop();
}

void Watcher::tell(std::string_view stage, double fraction) {
    const double time = now();
    if (fraction < 1 && time - lastProgress_ < kProgressSeconds) return;
    lastProgress_ = time;
    lookForSignals();
    if (callback_.is_none()) return;
    const Locked locked;
    outlastingTheInterpreter([&] {
        try {
            callback_(py::str(stage.data(), stage.size()), fraction);
        } catch (const py::error_already_set& error) {
            error_.emplace(error);
            throw Stopped();
        }
    });
}

ProgressCallback Watcher::callback() {
    return [this](std::string_view stage, double fraction) { tell(stage, fraction); };
}

void Watcher::run(int threads, const std::function<void()>& work) {
    if (mustEnd()) {
        PyErr_SetNone(PyExc_SystemExit);
        throw py::error_already_set();
    }
    try {
        const std::function<void()> look = [this] { lookForSignals(); };
        runInArena(threads, [&] {
            const InterruptionCheck check(look);
            work();
        });
    } catch (const Stopped&) {
        throw py::error_already_set(*error_);
    }
}

void endCallsOfOtherThreads() {
    constexpr std::chrono::seconds kMost{5};
    constexpr std::chrono::milliseconds kStep{2};
    lastThread = std::this_thread::get_id();
    isEnding = true;
    const Unlocked unlocked;  // so that they can end, and this thread is one of those counted
    const auto end = std::chrono::steady_clock::now() + kMost;
    while (unlockedThreads > 1 && std::chrono::steady_clock::now() < end) {
        std::this_thread::sleep_for(kStep);
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
    unlockedThreads = 0;  // the child has this thread alone
    workers() = new tbb::task_scheduler_handle{tbb::attach{}};
}

}  // namespace adaptiso::python
