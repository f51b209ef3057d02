#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <ostream>
#include <span>
#include <string>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// How a run ends.
struct Verdict {
    int exitCode = kExitOk;
    /// Why it failed, in one line, which is the last on stderr; empty: it passed, or checks alone
    /// failed, which are in the report.
    std::string error{};
    bool isShortage = false;      ///< of memory, disk or processes: another try may pass
    std::string reportFailure{};  ///< why there is no page; empty: nothing failed
    bool isReportAlone = false;   ///< nothing but the page failed: `error` says so

    /// --strict makes warnings failures, unless --allow lets them pass.
    /// \param consequence  as strictFailure() takes it
    void failStrict(const CommonOptions& common, std::span<const Warning> warnings,
                    const std::string& consequence);
    /// A page that is missing makes a run fail, and takes nothing back. \param failure  may be
    /// empty
    void failReport(const std::string& failure);
};

/// The first keys of a report: schema, program, passed, exitCode, error, warnings.
Json reportHead(const std::string& schema, const std::string& program, const Verdict& verdict,
                std::span<const Warning> warnings);

/// Prints `error` and `reportFailure` on stderr.
/// \param written  "brain.ply is written": what is there although the page is not
/// \return the exit code
int printVerdict(const std::string& program, const Verdict& verdict, const std::string& written);

/// Exit code and error text of an exception.
Verdict verdictOf(const std::exception_ptr& thrown);

/// Reads --json from the command line, for a run that fails before its options are known.
void rememberReport(int argc, const char* const* argv);

/// A report is printed on stdout, or holds the error already: no other follows.
void markReported();

inline constexpr const char* kFailureSchema = "adaptiso-failure/1";

/// Writes what --json asks for, on one line, where a run ends before its own report is written:
/// the head alone, of kFailureSchema, with the warnings printed so far. Folders are left
/// out of the error. Never replaces a file that is no JSON; throws nothing.
void writeFailureReport(const std::string& program, const Verdict& verdict);

/// Makes sure that what was printed on stdout has arrived, on its disk too if it is a file.
/// \throws FileError  it has not: no room, or closed
void flushResults();

/// Prints a run's results on stdout (as text by `printText`, as `json` with --json -, not at all
/// with --quiet). To be called when all files are whole under their temporary names and before
/// they get their own: when it throws, or a closed pipe ends the program, there are none.
/// \throws FileError  as flushResults()
void printResults(const CommonOptions& common, const std::string& json,
                  const std::function<void(std::ostream&)>& printText);

/// Text files that programs write: the report of --json, the table of --csv, the page of --report.
enum class TextKind { Report, Table, Page };
/// Refuses to replace a file of another kind: someone's data, as when a shell puts the names of
/// meshes behind --json. Kinds are known by how a file begins.
/// \throws FileError  such a file is there
void requireKind(const std::string& option, const std::filesystem::path& file, TextKind kind);

/// For programs whose only output is a report.
/// \throws FileError when the file of --json would overwrite `input` or other data, or can't be
///         written
void checkReportFile(const CommonOptions& common, const std::filesystem::path& input);

/// printResults(), and writes `json` to the file of --json: both or neither.
/// \throws FileError as checkReportFile() and flushResults()
void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText);

/// `text` with the files of the command line by their names, as records and logs have them.
/// \param file  becomes the first of them; may be null
std::string withoutFolders(std::string text, std::string* file = nullptr);

}  // namespace adaptiso
