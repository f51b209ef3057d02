#include "Common/CommonOptions.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <latch>
#include <system_error>
#include <thread>
#include <vector>

#include "Common/Log.h"
#include "Common/OptionValues.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

void declareCommonOptions(CLI::App& app, CommonOptions& options, const std::string& strictly) {
    const OptionGroup running(app, "Running");
    running.count("--threads", options.threads, 1, 1024,
                  "Use N threads (default: all of the machine's)");
    running.flag("-q,--quiet", options.isQuiet,
                 "Print neither progress nor results; warnings and errors still go to stderr");
    running.flag("--no-warnings", options.hidesWarnings,
                 "Print no warnings; --json and --report hold them all the same");
    CLI::Option* const strict = running.flag(
        "--strict", options.isStrict,
        "Fail (exit code 1) when there is any warning, with a line that says which; " + strictly);
    running
        .value(
            "--allow", "CODE[,CODE...]",
            [&options](const std::string& text) {
                for (const std::string& code : CLI::detail::split(text, ',')) {
                    options.allowed.push_back(warningCode("--allow", code));
                }
            },
            "Let warnings of these codes pass --strict (Documentation/Warnings.md lists them)")
        ->needs(strict)
        ->join(',');
    running.text("--json", "FILE", options.json,
                 "Write a report to FILE, or to stdout in place of the text when FILE is -");
    running.value(
        "--log", "FILE",
        [&app](const std::string& text) {
            openLog(text);
            addToLog(app.get_name() + " " + programVersion());
        },
        "Add steps, warnings and errors to FILE as they come, each with its time");
    declareVersion(app);
}

void declareVersion(CLI::App& app) {
    app.set_version_flag(
        "-v,--version", [&app] { return versionText(app.get_name()); },
        "Print the version and exit");
}

std::string programVersion() {
    return ADAPTISO_VERSION;
}

std::string versionText(const std::string& programName) {
    return programName + " " + programVersion() + "\n" + threadingName();
}

struct ThreadLimit::Impl {
    ThreadLimitGuard guard;
    bool isForWant;  ///< there are no more
};

ThreadLimit::ThreadLimit(const CommonOptions& options) {
    const int machine = threadLimit();
    const int asked = options.threads.value_or(machine);
    // oneTBB and ITK start all of the machine's where they can, so that --threads 1 may fail, too
    const int wanted = std::max({asked, machine, 2}) - 1;
    const int startable = startableThreads(wanted);
    const int threads = std::min(asked, 1 + startable);
    const bool isForWant = startable < wanted;
    if (isForWant) {
        // ITK's pool of threads, which it makes in any case, can't go without one; its other way
        // of running in parallel starts threads when there is work for several
        setenv("ITK_GLOBAL_DEFAULT_THREADER", "Platform", 1);
        setenv("ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS", std::to_string(threads).c_str(), 1);
    } else if (!options.threads) {
        return;
    }
    impl_.reset(new Impl{ThreadLimitGuard(threads), isForWant});
}

ThreadLimit::~ThreadLimit() {
    // at the end of a limit oneTBB starts the threads that it was kept from
    if (impl_ && impl_->isForWant) (void)impl_.release();
}

int startableThreads(int wanted) {
    std::latch end(1);  // they live at the same time
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(wanted));
    try {
        while (std::ssize(threads) < wanted) threads.emplace_back([&end] { end.wait(); });
    } catch (const std::system_error&) {
        // as many as there are
    }
    end.count_down();
    for (std::thread& thread : threads) thread.join();
    return static_cast<int>(threads.size());
}

}  // namespace adaptiso
