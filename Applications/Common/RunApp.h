#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "adaptiso/Core/Errors.h"

/// The names of CLI11 that our headers need. CLI11's own header takes the compiler 5 s a file.
namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI

namespace adaptiso {

/// Exit codes of all programs.
enum ExitCode : int {
    kExitOk = 0,
    kExitCheckFailed = 1,   ///< the program worked; a check that it was asked for did not pass
    kExitUsage = 2,         ///< options that make no sense
    kExitBadInput = 3,      ///< a file or value that can't be used, or too little memory or disk
    kExitInternalError = 4  ///< a bug
};

/// The command line asks for something that makes no sense (exit code 2).
class UsageError : public Error {
public:
    using Error::Error;
};

/// How a program presents itself.
struct Program {
    std::string name;         ///< "adaptiso-mesh"
    std::string description;  ///< first lines of --help
    std::string footer;       ///< last lines of --help: examples, exit codes
};

/// `text` as one line: line breaks and control characters in it, which may be from a file's name or
/// a header, become spaces, so that it can neither break the line nor talk to the terminal.
std::string oneLine(std::string_view text);

/// One line on stderr: "name: message", the message by oneLine().
void printError(std::string_view programName, std::string_view message);

namespace detail {
int runApp(int argc, const char* const* argv, const Program& program,
           const std::function<void(CLI::App&)>& declare, const std::function<int()>& run);
}  // namespace detail

/// The whole of a main(): reads the command line, runs the program, and turns whatever is thrown
/// into one line on stderr ("name: what is wrong") and an exit code. Nothing is thrown.
///
/// UsageError and what CLI11 refuses (in our words: UsageWords.h): 2, with a hint at --help.
/// InvalidInput, FileError: 3. Too little memory, too few threads or processes: 3, since a smaller
/// input or a larger machine mends it. All else: 4.
///
/// A run that fails writes what --json asks for, too (Verdict.h).
///
/// --help-json alone prints the options as JSON (optionsJson()), from which manual pages are made.
///
/// Signals that end the program (Ctrl-C among them) first remove temporary files (AtomicOutput);
/// reaching the limit of a file's size is an error of writing (3), not a signal, and so is (as an
/// error of reading) a disk that fails under a mapped image.
///
/// \param declare  adds the program's options to the parser, bound to the Options given
/// \param run      does the work and returns the exit code
template <class Options>
int runApp(int argc, const char* const* argv, const Program& program,
           void (*declare)(CLI::App&, Options&), int (*run)(const Options&)) {
    Options options;
    return detail::runApp(
        argc, argv, program, [&](CLI::App& app) { declare(app, options); },
        [&] { return run(options); });
}

}  // namespace adaptiso
