#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {

/// How a child process ended.
struct ChildResult {
    int exitCode = 0;      ///< meaningless when a signal ended it
    int signal = 0;        ///< that ended it; 0 for none
    int process = 0;       ///< its number
    std::string output{};  ///< its stdout
    std::string errors{};  ///< its stderr
    double seconds = 0;    ///< wall-clock time

    bool isGood() const { return exitCode == 0 && signal == 0; }
    /// The signal, or the exit code and the last line printed.
    std::string reason() const;
};

/// Runs this program, or another, `count` times, at most `jobs` at a time, started in order.
///
/// A child that crashes, or is killed for lack of memory, takes nothing down with it. Children end
/// (SIGTERM, so that they remove their temporaries) when this process does, however it ends. Where
/// fewer than `jobs` processes can be had at a time, as many as can run. When a signal has come
/// that a SignalsWait of the caller postpones, children that run are ended without a result, and
/// no further one is started.
/// \param arguments  of the n-th run, without the program's name; empty: skip it
/// \param finished   called with n and the result, in the order in which the runs end
/// \param program    a path, or a name to look up in PATH; empty: this program
/// \pre   no thread of this process runs: it is forked
/// \throws std::system_error  when no process can be started  \throws InternalError
void runChildren(std::size_t count, int jobs,
                 const std::function<std::vector<std::string>(std::size_t)>& arguments,
                 const std::function<void(std::size_t, ChildResult)>& finished,
                 const std::filesystem::path& program = {});

/// Runs a program once. \throws as runChildren()
/// \param folder  to run it in, for a program that writes temporaries there: a signal ends it
/// before
///                they are removed; empty: the current one
ChildResult runChild(const std::filesystem::path& program,
                     const std::vector<std::string>& arguments,
                     const std::filesystem::path& folder = {});

/// Whether a program of this name is in PATH.
bool isInstalled(const std::string& program);

/// The folder for temporary files (TMPDIR or its stand-ins).
/// \throws FileError  there is none that can be written to
std::filesystem::path temporaryFolder();

/// A private folder in temporaryFolder(), removed with the object, also when a signal ends this
/// program.
class ScratchFolder : public AtomicFolder {
public:
    ScratchFolder();  ///< \throws FileError
};

}  // namespace adaptiso
