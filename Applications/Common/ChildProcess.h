#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace adaptiso {

/// How a run of this program as a process of its own ended.
struct ChildResult {
    int exitCode = 0;    ///< meaningless when a signal ended it
    int signal = 0;      ///< that ended it; 0: none
    int process = 0;     ///< its number
    std::string output;  ///< its stdout
    std::string errors;  ///< its stderr
    double seconds = 0;  ///< wall-clock time
};

/// Runs this very program, or another, `count` times, at most `jobs` at a time, started in order.
///
/// A child that crashes, or is killed for want of memory, takes nothing down with it. Children end
/// (SIGTERM, so that they remove their temporaries) when this process does, however it ends.
/// \param arguments  of the n-th run, without the program's name; none: it is not wanted any more
/// \param program    to run; empty: this one
/// \param finished   called with n and the result, in the order in which the runs end
/// \pre   no thread of this process runs: it is forked
/// Where fewer than `jobs` processes can be had at a time, as many as can.
/// \throws std::system_error  when no process can be started  \throws InternalError
void runChildren(std::size_t count, int jobs,
                 const std::function<std::vector<std::string>(std::size_t)>& arguments,
                 const std::function<void(std::size_t, ChildResult)>& finished,
                 const std::filesystem::path& program = {});

/// Runs a program once. \throws as runChildren()
ChildResult runChild(const std::filesystem::path& program,
                     const std::vector<std::string>& arguments);

}  // namespace adaptiso
