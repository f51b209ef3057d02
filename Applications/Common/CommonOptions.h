#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Common/RunApp.h"

namespace adaptiso {

/// Options of every program.
struct CommonOptions {
    std::optional<int> threads;  ///< none: as many as the machine has
    bool isQuiet = false;
    bool hidesWarnings = false;
    bool isStrict = false;             ///< warnings make the run fail (Common/Warnings.h)
    std::vector<std::string> allowed;  ///< codes of warnings that --strict lets pass
    std::string json;                  ///< a file's name, "-" for stdout, empty for no report

    bool wantsJson() const { return !json.empty(); }
    bool wantsJsonOnStdout() const { return json == "-"; }
};

/// Adds --threads, --quiet, --no-warnings, --strict, --allow, --json and --version.
/// \param strictly  what --strict means for what the program writes: "no surface is written"
void declareCommonOptions(CLI::App& app, CommonOptions& options, const std::string& strictly);

/// Adds -v, --version.
void declareVersion(CLI::App& app);

/// "0.1.0"
std::string programVersion();

/// Name, version and the library of threads, as --version prints them.
std::string versionText(const std::string& programName);

/// While one lives, parallel work takes no more threads than asked for and than can be started.
class ThreadLimit {
public:
    explicit ThreadLimit(const CommonOptions& options);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// How many of `wanted` threads can be started beside this one, right now: a limit of processes
/// (ulimit -u, a container's) or of memory may leave fewer. Starts them and waits for their ends.
int startableThreads(int wanted);

}  // namespace adaptiso
