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
                   const fs::path& folder) {
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const std::string place = folder.string(), log = (folder / "tool.log").string();
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) {
        throw FileError(program + ": can't be started: " + std::strerror(errno));
    }
    if (process == 0) becomeTool(parent, pointers.data(), place.c_str(), log.c_str());
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    ToolResult result;
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    std::ifstream stream(log, std::ios::binary);
    result.output.assign(std::istreambuf_iterator<char>(stream), {});
    return result;
}

ScratchFolder::ScratchFolder() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "adaptiso-XXXXXX").string();
    if (error || mkdtemp(name.data()) == nullptr) {
        throw FileError(name + ": no folder can be made there: " + std::strerror(errno));
    }
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
}

}  // namespace adaptiso
