#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <optional>
#include <string_view>

#include "adaptiso/Core/Progress.h"

namespace adaptiso::python {

namespace py = pybind11;

/// Runs `work` without the interpreter's lock, in at most `threads` threads (0: all that there
/// are). Every call has an arena of its own, so that calls of several Python threads neither limit
/// nor wait for each other. In a child of fork() that took place during another call there is one
/// thread.
void runUnlocked(int threads, const std::function<void()>& work);

/// Tells Python how far a call has come, and sees to it that Ctrl+C ends it. An exception, of the
/// callback or of a signal's handler, ends the C++ call and comes out of rethrow().
class Watcher {
public:
    /// \param callback  callback(stage, fraction), or None
    explicit Watcher(py::object callback) : callback_(std::move(callback)) {}

    /// To be called without the lock. \throws Stopped
    ProgressCallback callback();

    /// Asks for signals, and tells `callback` a stage; with the lock or without. \throws Stopped
    void tell(std::string_view stage, double fraction);

    /// Runs `work` as runUnlocked(); raises in Python what stopped it.
    void run(int threads, const std::function<void()>& work);

private:
    struct Stopped : std::exception {};

    void lookForSignals();

    py::object callback_;
    std::optional<py::error_already_set> error_;
    double lastTold_ = -1;  ///< seconds of a steady clock
};

/// What has to be done around fork(), for os.register_at_fork: workers end before it and come back
/// when they are needed, in the parent and in the child.
void beforeFork();
void afterForkInParent();
void afterForkInChild();

}  // namespace adaptiso::python
