#include "Common/ChildProcess.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <list>
#include <sstream>
#include <system_error>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

[[noreturn]] void failed(const char* call) {
    throw InternalError(std::string("runChildren: ") + call + ": " + detail::reason());
}

/// One end of a pipe: closed when it goes.
class Descriptor {
public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor() { close(); }
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    int get() const { return number_; }
    bool isOpen() const { return number_ >= 0; }
    void close() {
        if (number_ >= 0) ::close(std::exchange(number_, -1));
    }

private:
    int number_;
};

struct Child {
    std::size_t number;
    pid_t process;
    Descriptor out, err;
    Clock::time_point began = Clock::now();
    ChildResult result{};
};

/// Runs in the child between fork and exec, where few calls are safe.
[[noreturn]] void becomeProgram(pid_t parent, const char* program, char* const* arguments,
                                const char* folder, int out, int err) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);  // it has ended already
    const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (in < 0 || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(err, STDERR_FILENO) < 0 || (*folder != '\0' && chdir(folder) != 0)) {
        _exit(127);
    }
    execvp(program, arguments);
    _exit(127);
}

std::array<Descriptor, 2> makePipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) failed("pipe2");
    if (fcntl(ends[0], F_SETFL, O_NONBLOCK) != 0) failed("fcntl");
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

Child start(const std::string& program, std::size_t number, std::vector<std::string> arguments,
            const std::string& folder = {}) {
    std::vector<char*> pointers;
    std::string name = fs::path(program).filename().string();
    pointers.push_back(name.data());
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);

    std::array<Descriptor, 2> out = makePipe(), err = makePipe();
    const detail::SignalsWait untilItIsKnown;
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0 && errno == ENOSYS) {  // WebAssembly
        throw InvalidInput("this build starts no other programs; use the native ones");
    }
    if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (process == 0) {
        becomeProgram(parent, program.c_str(), pointers.data(), folder.c_str(), out[1].get(),
                      err[1].get());
    }
    if (!folder.empty()) detail::endFirst(process);
    return {number, process, std::move(out[0]), std::move(err[0])};
}

/// Reads all that is available; closes the pipe at its end.
void drain(Descriptor& from, std::string& to) {
    std::array<char, 65536> buffer;
    while (from.isOpen()) {
        const ssize_t count = read(from.get(), buffer.data(), buffer.size());
        if (count > 0) {
            to.append(buffer.data(), static_cast<std::size_t>(count));
        } else if (count < 0 && errno == EINTR) {
            continue;
        } else if (count < 0 && errno == EAGAIN) {
            return;
        } else {
            from.close();
        }
    }
}

/// Waits a moment for output or an end. A child of the child may outlive it and keep the pipes
/// open, so the wait is short.
void waitForAny(const std::list<Child>& children) {
    constexpr int kLongestMs = 100;
    std::vector<pollfd> waited;
    for (const Child& child : children) {
        for (const Descriptor* end : {&child.out, &child.err}) {
            if (end->isOpen()) waited.push_back({end->get(), POLLIN, 0});
        }
    }
    poll(waited.data(), waited.size(), waited.empty() ? 1 : kLongestMs);
}

/// \return whether the child has ended, so that its result is complete
bool hasEnded(Child& child) {
    drain(child.out, child.result.output);
    drain(child.err, child.result.errors);
    int status = 0;
    const pid_t ended = waitpid(child.process, &status, WNOHANG);
    if (ended < 0 && errno != EINTR) failed("waitpid");
    if (ended != child.process) return false;
    drain(child.out, child.result.output);
    drain(child.err, child.result.errors);
    child.result.process = child.process;
    child.result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    child.result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    child.result.seconds = std::chrono::duration<double>(Clock::now() - child.began).count();
    return true;
}

void endAll(std::list<Child>& children) {
    constexpr std::chrono::seconds kLongest(5);  // to remove temporaries
    const auto begin = Clock::now();
    for (const Child& child : children) kill(child.process, SIGTERM);
    bool isKilled = false;
    while (!children.empty()) {
        if (!isKilled && Clock::now() - begin > kLongest) {
            for (const Child& child : children) kill(child.process, SIGKILL);
            isKilled = true;
        }
        waitForAny(children);
        std::erase_if(children, hasEnded);
    }
}

}  // namespace

void runChildren(std::size_t count, int jobs,
                 const std::function<std::vector<std::string>(std::size_t)>& arguments,
                 const std::function<void(std::size_t, ChildResult)>& finished,
                 const fs::path& program) {
    const std::string path = program.empty() ? "/proc/self/exe" : program.string();
    // an ignored SIGCHLD, inherited from the caller, would hide how children end
    signal(SIGCHLD, SIG_DFL);
    std::list<Child> children;
    std::size_t next = 0;
    std::vector<std::string> waiting;  // arguments of the next; empty: not fetched yet
    while (next < count || !children.empty()) {
        if (detail::SignalsWait::hasCome()) return endAll(children);
        while (next < count && children.size() < static_cast<std::size_t>(jobs) &&
               !detail::SignalsWait::hasCome()) {
            if (waiting.empty()) waiting = arguments(next);
            if (waiting.empty()) {
                ++next;
                continue;
            }
            try {
                children.push_back(start(path, next, waiting));
            } catch (const std::system_error&) {
                // the limit of processes is reached: the end of one of ours makes room
                if (children.empty()) throw;
                break;
            }
            waiting.clear();
            ++next;
        }
        if (children.empty()) break;
        waitForAny(children);
        for (auto child = children.begin(); child != children.end();) {
            if (!hasEnded(*child)) {
                ++child;
                continue;
            }
            const std::size_t number = child->number;
            ChildResult result = std::move(child->result);
            child = children.erase(child);
            if (detail::SignalsWait::hasCome()) return endAll(children);  // it may have ended by it
            finished(number, std::move(result));
        }
    }
}

ChildResult runChild(const fs::path& program, const std::vector<std::string>& arguments,
                     const fs::path& folder) {
    std::list<Child> children;
    children.push_back(start(program.string(), 0, arguments, folder.string()));
    while (!hasEnded(children.front())) waitForAny(children);
    detail::endFirst(0);
    return std::move(children.front().result);
}

std::string ChildResult::reason() const {
    if (signal != 0) return "ended by signal " + std::to_string(signal);
    constexpr std::size_t kLongest = 200;
    std::string last;
    std::istringstream lines(errors.empty() ? output : errors);
    for (std::string line; std::getline(lines, line);) {
        for (char& c : line) {
            if (c < ' ' || c > '~') c = ' ';
        }
        if (line.find_first_not_of(' ') != std::string::npos) last = line.substr(0, kLongest);
    }
    return "exit code " + std::to_string(exitCode) + (last.empty() ? "" : ", '" + last + "'");
}

bool isInstalled(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path file = fs::path(folder.empty() ? "." : folder) / program;
        if (access(file.c_str(), X_OK) == 0) return true;
    }
    return false;
}

fs::path temporaryFolder() {
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (!error && access(folder.c_str(), W_OK | X_OK) == 0) return folder;
    for (const char* const name : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {  // the library's order
        const char* const value = std::getenv(name);
        if (value == nullptr) continue;
        throw FileError(std::string(name) + " (" + value +
                        "): is no folder that can be written to; set it to one that can");
    }
    throw FileError("/tmp: can't be written to; set TMPDIR to a folder that can");
}

ScratchFolder::ScratchFolder()
    : AtomicFolder(temporaryFolder() / ("adaptiso-scratch-" + std::to_string(getpid())), {}) {
    fs::permissions(path(), fs::perms::owner_all);
}

}  // namespace adaptiso
