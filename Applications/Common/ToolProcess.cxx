#include "Common/ToolProcess.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include "Common/Temporaries.h"
#include "Common/TemporaryNames.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void becomeTool(pid_t parent, char* const* arguments, const char* folder,
                             const char* log) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
    const int out = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (in < 0 || out < 0 || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(out, STDERR_FILENO) < 0 || chdir(folder) != 0) {
        _exit(127);
    }
    execvp(arguments[0], arguments);
    _exit(127);
}

constexpr const char* kLog = "tool.log";

/// \return its number, or -1 and errno
pid_t start(const std::vector<char*>& arguments, const std::string& folder,
            const std::string& log) {
    const detail::SignalsWait untilItIsRemembered;
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process == 0) becomeTool(parent, arguments.data(), folder.c_str(), log.c_str());
    if (process > 0) detail::endFirst(process);
    return process;
}

}  // namespace

bool isInstalled(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path file = fs::path(folder.empty() ? "." : folder) / program;
        if (access(file.c_str(), X_OK) == 0) return true;
    }
    return false;
}

std::string ToolResult::reason() const {
    if (signal != 0) return "it was ended by signal " + std::to_string(signal);
    std::string last;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        for (char& c : line) {
            if (c < ' ' || c > '~') c = ' ';
        }
        if (line.find_first_not_of(' ') != std::string::npos) last = line.substr(0, 200);
    }
    return "exit code " + std::to_string(exitCode) + (last.empty() ? "" : ", '" + last + "'");
}

ToolResult runTool(const std::string& program, const std::vector<std::string>& arguments,
                   const ScratchFolder& folder) {
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const std::string place = folder.path().string(), log = (folder.path() / kLog).string();
    const pid_t process = start(pointers, place, log);
    if (process < 0) {
        throw FileError(program + ": can't be started: " + std::strerror(errno));
    }
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    detail::endFirst(0);
    ToolResult result;
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    std::ifstream stream(log, std::ios::binary);
    result.output.assign(std::istreambuf_iterator<char>(stream), {});
    return result;
}

fs::path temporaryFolder() {
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (!error && access(folder.c_str(), W_OK | X_OK) == 0) return folder;
    for (const char* const name : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {  // as the library looks
        const char* const value = std::getenv(name);
        if (value == nullptr) continue;
        throw FileError(std::string(name) + " (" + value +
                        "): is no folder that can be written to; set it to one that can");
    }
    throw FileError("/tmp: can't be written to; set TMPDIR to a folder that can");
}

ScratchFolder::ScratchFolder() {
    const fs::path parent = temporaryFolder();
    constexpr unsigned kOwnersAlone = 0700;
    const detail::SignalsWait untilItIsRemembered;
    const detail::NewTemporary made =
        detail::makeTemporaryFolder(parent / "scratch", kOwnersAlone, parent);
    path_ = made.path;
    registrations_.push_back(
        std::make_unique<detail::Registration>(detail::rememberTemporary(path_, true), made.lock));
    place(kLog);
}

ScratchFolder::~ScratchFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
    while (!registrations_.empty()) registrations_.pop_back();
}

fs::path ScratchFolder::place(const std::string& name) {
    fs::path path = path_ / name;
    registrations_.push_back(
        std::make_unique<detail::Registration>(detail::rememberTemporary(path, false)));
    return path;
}

}  // namespace adaptiso
