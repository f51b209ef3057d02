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
#include <list>
#include <system_error>
#include <utility>

#include "Common/Temporaries.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

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

/// What the child does between fork and exec: only calls that are safe there.
[[noreturn]] void becomeProgram(pid_t parent, const char* program, char* const* arguments, int out,
                                int err) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);  // it ended before it could be told
    const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (in < 0 || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(err, STDERR_FILENO) < 0) {
        _exit(127);
    }
    execv(program, arguments);
    _exit(127);
}

std::array<Descriptor, 2> makePipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) failed("pipe2");
    if (fcntl(ends[0], F_SETFL, O_NONBLOCK) != 0) failed("fcntl");
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

Child start(const std::string& program, std::size_t number, std::vector<std::string> arguments) {
    std::vector<char*> pointers;
    std::string name = "adaptiso";
    pointers.push_back(name.data());
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);

    std::array<Descriptor, 2> out = makePipe(), err = makePipe();
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (process == 0) {
        becomeProgram(parent, program.c_str(), pointers.data(), out[1].get(), err[1].get());
    }
    return {number, process, std::move(out[0]), std::move(err[0])};
}

/// What is there to read; closes the pipe at its end.
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

/// Waits a moment for output or an end. A process of the child's that outlives it may keep the
/// pipes open, so ends are looked for too.
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

/// \return whether the child has ended; its result is then whole
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

}  // namespace

void runChildren(std::size_t count, int jobs,
                 const std::function<std::vector<std::string>(std::size_t)>& arguments,
                 const std::function<void(std::size_t, ChildResult)>& finished,
                 const std::filesystem::path& program) {
    const std::string path = program.empty() ? "/proc/self/exe" : program.string();
    // a caller that ignores the ends of its children has its children ignore theirs
    signal(SIGCHLD, SIG_DFL);
    std::list<Child> children;
    std::size_t next = 0;
    std::vector<std::string> waiting;  // arguments of the next; empty: not asked for yet
    while (next < count || !children.empty()) {
        while (next < count && children.size() < static_cast<std::size_t>(jobs)) {
            if (waiting.empty()) waiting = arguments(next);
            if (waiting.empty()) {  // not wanted any more
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
            finished(number, std::move(result));
        }
    }
}

ChildResult runChild(const std::filesystem::path& program,
                     const std::vector<std::string>& arguments) {
    ChildResult result;
    runChildren(
        1, 1, [&](std::size_t) { return arguments; },
        [&](std::size_t, ChildResult ended) { result = std::move(ended); }, program);
    return result;
}

}  // namespace adaptiso
