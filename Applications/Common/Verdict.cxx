#include "Common/Verdict.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Shortage.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {
namespace fs = std::filesystem;

namespace {

constexpr const char* kNoThreads =
    "a thread or process could not be started; the limit of processes (ulimit -u) or of memory is "
    "reached. Raise it, or ask for fewer (--threads, --jobs)";

/// The command line, as far as a report needs it.
struct CommandLine {
    std::string json;                ///< of --json; empty: not given
    std::vector<std::string> words;  ///< that may name files
    bool isReported = false;
};

CommandLine& commandLine() {
    static CommandLine line;
    return line;
}

/// `text` with `path`, where it stands as a word of its own, by its last part. \return was it there
bool leaveOutFolders(std::string& text, const std::string& path) {
    const auto isPart = [&](std::size_t at) {
        const auto c = static_cast<unsigned char>(at < text.size() ? text[at] : ' ');
        return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '-' || c >= 0x80;
    };
    const std::string name = baseName(path);
    bool isThere = false;
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path, at)) {
        const bool isWord =
            (at == 0 || !isPart(at - 1)) &&
            (path.back() == '/' || text[at + path.size()] == '/' || !isPart(at + path.size()));
        if (isWord) text.replace(at, path.size(), name);
        at += isWord ? name.size() : path.size();
        isThere = isThere || isWord;
    }
    return isThere;
}

}  // namespace

std::string withoutFolders(std::string text, std::string* file) {
    std::vector<std::string> words = commandLine().words;
    // a folder after what lies in it
    std::ranges::stable_sort(words, std::ranges::greater{}, &std::string::size);
    for (const std::string& word : words) {
        std::error_code error;
        const bool isFile = word.find_first_of("./") != std::string::npos ||
                            fs::symlink_status(word, error).type() > fs::file_type::not_found;
        const bool isThere = isFile && leaveOutFolders(text, word);
        if (isThere && file != nullptr && file->empty()) *file = baseName(word);
    }
    return text;
}

namespace {

/// {text, file}: without folders.
Json errorJson(const Verdict& verdict) {
    if (verdict.error.empty()) return nullptr;
    std::string file;
    const std::string text = withoutFolders(oneLine(verdict.error), &file);
    Json json{{"text", text}};
    if (!file.empty()) json["file"] = file;
    return json;
}

/// The file begins so, after blanks, or holds nothing else.
bool begins(const fs::path& path, std::string_view text) {
    std::ifstream file(path, std::ios::binary);
    std::string found(text.size(), '\0');
    file >> std::ws;
    if (file.peek() == std::ifstream::traits_type::eof()) return true;
    file.read(found.data(), static_cast<std::streamsize>(found.size()));
    return lowerCase(found) == text;
}

/// A report may go there: no other word names it, and nothing is there, or no file, or a report.
bool mayReplace(const fs::path& path) {
    if (path.string().find('{') != std::string::npos) return false;  // a placeholder
    std::error_code error;
    const auto whole = [&](const fs::path& name) {
        return fs::weakly_canonical(fs::absolute(name, error), error);
    };
    const auto isSame = [&](const std::string& word) { return whole(word) == whole(path); };
    if (std::ranges::any_of(commandLine().words, isSame)) return false;
    return fs::is_regular_file(path, error) ? begins(path, "{") : !fs::is_directory(path, error);
}

std::string internal(const char* what) {
    return std::string("internal error (please report it)") +
           (what == nullptr ? "" : std::string(": ") + what);
}

}  // namespace

void Verdict::failStrict(const CommonOptions& common, std::span<const Warning> warnings,
                         const std::string& consequence) {
    if (!failsStrict(common, warnings)) return;
    exitCode = kExitCheckFailed;
    error = strictFailure(common, warnings, consequence);
    isReportAlone = false;
}

void Verdict::failReport(const std::string& failure) {
    reportFailure = failure;
    if (failure.empty() || exitCode != kExitOk) return;
    exitCode = kExitCheckFailed;
    error = "the report failed: " + failure;
    isReportAlone = true;
}

Json reportHead(const std::string& schema, const std::string& program, const Verdict& verdict,
                std::span<const Warning> warnings) {
    return {{"schema", schema},
            {"program", {{"name", program}, {"version", programVersion()}}},
            {"passed", verdict.exitCode == kExitOk},
            {"exitCode", verdict.exitCode},
            {"error", errorJson(verdict)},
            {"warnings", std::vector<Warning>(warnings.begin(), warnings.end())}};
}

int printVerdict(const std::string& program, const Verdict& verdict, const std::string& written) {
    if (!verdict.error.empty() && !verdict.isReportAlone) printError(program, verdict.error);
    if (!verdict.reportFailure.empty()) {
        printError(program, written + "; the report failed: " + verdict.reportFailure);
    }
    return verdict.exitCode;
}

Verdict verdictOf(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const UsageError& error) {
        return {kExitUsage, error.what()};
    } catch (const InvalidInput& error) {
        return {kExitBadInput, error.what()};
    } catch (const Shortage& error) {
        return {kExitBadInput, error.what(), true};
    } catch (const FileError& error) {
        return {kExitBadInput, error.what()};
    } catch (const fs::filesystem_error& error) {
        return {kExitBadInput, error.what()};
    } catch (const std::bad_alloc&) {
        return {kExitBadInput,
                "not enough memory (" + formatNumber(std::round(peakMemoryMb())) +
                    " MB were in use); a machine with more of it, or a smaller image, will do",
                true};
    } catch (const std::system_error& error) {
        if (error.code() == std::errc::resource_unavailable_try_again) {
            return {kExitBadInput, kNoThreads, true};
        }
        return {kExitInternalError, internal(error.what())};
    } catch (const std::exception& error) {
        // oneTBB throws a text where it can't start a thread
        if (std::strstr(error.what(), "pthread_create") != nullptr)
            return {kExitBadInput, kNoThreads, true};
        return {kExitInternalError, internal(error.what())};
    } catch (...) {
        return {kExitInternalError, internal(nullptr)};
    }
}

void rememberReport(int argc, const char* const* argv) {
    CommandLine& line = commandLine();
    bool hasOptionsEnded = false;
    for (int n = 1; n < argc; ++n) {
        const std::string_view word = argv[n];
        hasOptionsEnded = hasOptionsEnded || word == "--";
        if (hasOptionsEnded || !word.starts_with("-") || word == "-") {
            line.words.emplace_back(word);
            continue;
        }
        const std::size_t equals = word.find('=');
        const std::string_view value =
            equals == std::string_view::npos ? "" : word.substr(equals + 1);
        if (word.substr(0, equals) != "--json") {
            if (!value.empty()) line.words.emplace_back(value);
        } else if (equals != std::string_view::npos) {
            line.json = value;
        } else if (n + 1 < argc) {
            const std::string_view next = argv[n + 1];
            if (!next.starts_with("--") && !isLetterOption(next)) line.json = argv[++n];
        }
    }
    std::erase_if(line.words, [](const std::string& word) {
        return word.empty() || word == "-" || parseFiniteNumber(word).has_value();
    });
}

void markReported() {
    commandLine().isReported = true;
}

void writeFailureReport(const std::string& program, const Verdict& verdict) {
    const std::string& target = commandLine().json;
    if (target.empty() || std::exchange(commandLine().isReported, true)) return;
    try {
        Json report = reportHead(kFailureSchema, program, verdict, printedWarnings());
        if (verdict.isShortage) report["shortage"] = true;
        const std::string text = jsonText(report, -1) + "\n";
        if (target == "-") {
            std::cout << text << std::flush;
        } else if (mayReplace(target)) {
            AtomicOutput output(target);
            output.writeText(text);
            AtomicOutput::commit({&output, 1});
        }
    } catch (const std::exception&) {
        // the error itself is on stderr
    }
}

void requireKind(const std::string& option, const fs::path& file, TextKind kind) {
    struct Kind {
        const char* name;
        std::string_view beginning;
    };
    constexpr std::array<Kind, 3> kKinds{{{"JSON report", "{"},
                                          {"table of runs", "run,input,state"},
                                          {"HTML page", "<!doctype html"}}};
    const Kind& own = kKinds[static_cast<std::size_t>(kind)];
    std::error_code error;
    if (!fs::is_regular_file(file, error) || begins(file, own.beginning)) return;
    throw FileError(option + " " + file.string() + ": exists and is no " + own.name +
                    "; name a new file");
}

void checkReportFile(const CommonOptions& common, const std::filesystem::path& input) {
    if (!common.wantsJson() || common.wantsJsonOnStdout()) return;
    checkNotInput(common.json, input);
    requireKind("--json", common.json, TextKind::Report);
    checkOutput(common.json);
}

void flushResults() {
    const auto fail = [] {
        throw FileError("standard output: can't be written: " + detail::reason());
    };
    errno = 0;
    if (!std::cout.flush()) {
        if (errno == 0) throw FileError("standard output: can't be written");
        fail();
    }
    // some file systems report a full disk only now; pipes and terminals cannot be synced
    struct stat status {};
    const bool isFile = fstat(STDOUT_FILENO, &status) == 0 && S_ISREG(status.st_mode);
    if (isFile && fsync(STDOUT_FILENO) != 0 && errno != EINVAL && errno != EROFS) fail();
}

void printResults(const CommonOptions& common, const std::string& json,
                  const std::function<void(std::ostream&)>& printText) {
    if (common.wantsJsonOnStdout()) {
        markReported();
        std::cout << json;
    } else if (!common.isQuiet) {
        printText(std::cout);
    }
    flushResults();
}

void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText) {
    std::vector<AtomicOutput> outputs;
    if (common.wantsJson() && !common.wantsJsonOnStdout()) {
        checkReportFile(common, input);
        outputs.emplace_back(common.json).writeText(json);
    }
    printResults(common, json, printText);
    AtomicOutput::commit(outputs);
}

}  // namespace adaptiso
