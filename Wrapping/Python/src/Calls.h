#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <functional>
#include <optional>
#include <string_view>

#include "adaptiso/Core/Progress.h"

namespace adaptiso::python {

namespace py = pybind11;

/// The interpreter's lock is given up as long as this lives.
///
/// A thread that asks for the lock while the interpreter ends is ended by it, by unwinding its
/// stack, which would abort the process here. It waits for the process to end instead, as all
/// threads do from Python 3.14 on.
class Unlocked {
public:
    Unlocked();
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;
    ~Unlocked();

private:
    PyThreadState* state_;
};

/// Runs `work` without the interpreter's lock, in at most `threads` threads (0: all that there
/// are). Every call has an arena of its own, so that calls of several Python threads neither limit
/// nor wait for each other. In a child of fork() that took place during another call there is one
/// thread. Ctrl+C ends the call, as of a Watcher.
void runUnlocked(int threads, const std::function<void()>& work);

/// Reports progress to Python, and lets Ctrl+C end a call. An exception, of the
/// callback or of a signal's handler, ends the C++ call and comes out of rethrow().
class Watcher {
public:
    /// \param callback  callback(stage, fraction), or None
    explicit Watcher(py::object callback) : callback_(std::move(callback)) {}

    /// To be called without the lock. \throws Stopped
    ProgressCallback callback();

    /// Checks for signals, and reports a stage to `callback`; with the lock or without. \throws
    /// Stopped
    void tell(std::string_view stage, double fraction);

    /// Runs `work` without the lock; raises in Python what stopped it.
    void run(int threads, const std::function<void()>& work);

private:
    struct Stopped : std::exception {};

    void lookForSignals();
    [[noreturn]] void stop();

    py::object callback_;
    std::optional<py::error_already_set> error_;
    double lastProgress_ = -1;  ///< seconds of a steady clock
};

/// For atexit: ends the calls of all other threads, which the end of the process would take away
/// what they work with, and waits for them, some seconds at most. Calls that those threads begin
/// later raise SystemExit, which ends a thread without a word.
void endCallsOfOtherThreads();

/// Hooks around fork(), for os.register_at_fork: workers end before it and come back
/// when they are needed, in the parent and in the child.
void beforeFork();
void afterForkInParent();
void afterForkInChild();

namespace py = pybind11;

/// Declarations of `_adaptiso`, by subject; Module.cxx calls them. Classes come before the
/// functions that take them.

void declareMeshes(py::module_& module);    ///< MeshData, read_mesh
void declareSurfaces(py::module_& module);  ///< ArrayVolume, ArrayIndex, build_index, make_surface
void declareReaders(py::module_& module);   ///< read_image
void declareChecks(py::module_& module);    ///< check, check_nested, compare
void declareSimplify(py::module_& module);  ///< simplify_mesh
void declareMend(py::module_& module);      ///< mend_mesh
void declareHeadModels(py::module_& module);  ///< HeadModelData, make_bem
void declareLabels(py::module_& module);      ///< LabelData, make_labels

/// The program's name in reports.
inline constexpr const char* kProgramName = "adaptiso (Python)";

inline double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace adaptiso::python
