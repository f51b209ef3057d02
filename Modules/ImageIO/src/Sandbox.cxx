#include "Sandbox.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/sysinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "FileFault.h"
#include "Samples.h"
#include "adaptiso/Core/Shortage.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

class FileDescriptor {
public:
    explicit FileDescriptor(int number = -1) : number_(number) {}
    ~FileDescriptor() { close(); }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;

    int number() const { return number_; }
    void close() {
        if (number_ >= 0) ::close(number_);
        number_ = -1;
    }

private:
    int number_;
};

/// The name of the file that the child works on, where both processes see it.
class BlameNote {
public:
    BlameNote()
        : text_(static_cast<char*>(::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE,
                                          MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
    ~BlameNote() {
        if (isUsable()) ::munmap(text_, kBytes);
    }
    BlameNote(const BlameNote&) = delete;
    BlameNote& operator=(const BlameNote&) = delete;

    bool isUsable() const { return text_ != MAP_FAILED; }
    std::span<char> bytes() const { return {text_, kBytes}; }
    /// \return `otherwise` where the child has blamed nothing
    fs::path fileOr(const fs::path& otherwise) const {
        const std::string file(text_, ::strnlen(text_, kBytes));
        return file.empty() || file.size() == kBytes ? otherwise : fs::path(file);
    }

private:
    static constexpr std::size_t kBytes = 8192;  // Linux's PATH_MAX is 4096
    char* text_;
};

class ChildProcess {
public:
    explicit ChildProcess(pid_t pid) : pid_(pid) {}
    ~ChildProcess() { end(); }
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Kills the child if it still runs. \return its status from waitpid(); 0 if unknown
    int end() {
        if (pid_ < 0) return status_;
        ::kill(pid_, SIGKILL);  // changes nothing for one that has ended
        pid_t done = -1;
        do {
            done = ::waitpid(pid_, &status_, 0);
        } while (done < 0 && errno == EINTR);
        if (done < 0) status_ = 0;  // SIGCHLD is ignored: the status is lost
        pid_ = -1;
        return status_;
    }

private:
    pid_t pid_;
    int status_ = 0;
};

[[noreturn]] void refuseStart(const fs::path& input) {
    refuseShort(input,
                fmt::format("can't be read: no process could be started to decode it ({})",
                            std::strerror(errno)),
                "free memory or processes");
}

/// Of a child that runs; 0 where it can't be had.
std::chrono::milliseconds processorTime(pid_t process) {
    clockid_t clock{};
    timespec used{};
    if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0)
        return {};
    return std::chrono::seconds(used.tv_sec) +
           std::chrono::duration_cast<std::chrono::milliseconds>(
               std::chrono::nanoseconds(used.tv_nsec));
}

/// Reads the pipe until the child closes it.
/// \return the limit that was exceeded before, in words; may be empty
std::string collect(int pipe, pid_t child, std::chrono::milliseconds limit, std::string& answer) {
    constexpr int kFar = 10;
    const Clock::time_point begin = Clock::now();
    const auto inSeconds = [](std::chrono::milliseconds time) {
        return std::chrono::duration_cast<std::chrono::seconds>(time).count();
    };
    std::vector<char> piece(std::size_t{1} << 16);
    for (;;) {
        const std::chrono::milliseconds left = limit - processorTime(child);
        if (left.count() <= 0) return fmt::format("{} s of processor time", inSeconds(limit));
        if (Clock::now() - begin > kFar * limit)
            return fmt::format("{} s", inSeconds(kFar * limit));
        pollfd ready{pipe, POLLIN, 0};
        const int found = ::poll(
            &ready, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 1, 1'000'000)));
        if (found == 0 || (found < 0 && errno == EINTR)) continue;
        const ssize_t got = ::read(pipe, piece.data(), piece.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return {};
        answer.append(piece.data(), static_cast<std::size_t>(got));
        if (answer.size() > kLongestAnswer) return {};
    }
}

/// The volume's samples as a read-only view of the child's memory, which nobody can change or
/// shorten any more.
std::shared_ptr<const void> mapSamples(int memory, const SandboxAnswer& answer) {
    if (::fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) != 0) return {};
    void* const samples = ::mmap(nullptr, answer.byteCount, PROT_READ, MAP_PRIVATE, memory,
                                 static_cast<off_t>(answer.offset));
    if (samples == MAP_FAILED) return {};
    return {samples, [byteCount = answer.byteCount](const void* mapped) {
                ::munmap(const_cast<void*>(mapped), byteCount);
            }};
}

bool holdsSamples(int memory, const SandboxAnswer& answer) {
    const off_t end = ::lseek(memory, 0, SEEK_END);
    return end >= 0 && answer.offset <= static_cast<std::uint64_t>(end) &&
           answer.byteCount <= static_cast<std::uint64_t>(end) - answer.offset;
}

ReadVolume volumeOf(const fs::path& input, int memory, SandboxAnswer answer) {
    if (!holdsSamples(memory, answer) ||
        answer.byteCount != requireImageBytes(input, answer.geometry.size, answer.pixelType)) {
        refuse(input, "its decoder answered nonsense", "the file is damaged");
    }
    const std::shared_ptr<const void> samples = mapSamples(memory, answer);
    if (!samples) {
        refuseShort(input,
                    fmt::format("needs {} bytes of memory, more than there is", answer.byteCount),
                    "use a machine with more memory or crop the image");
    }
    requireUsableGeometry(input, answer.geometry);
    return {Volume(VolumeView(samples.get(), answer.pixelType, answer.geometry), samples),
            std::move(answer.format), std::move(answer.warnings), std::move(answer.scaling)};
}

/// The child ended without an answer.
[[noreturn]] void refuseSilence(const fs::path& file, int status) {
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) {
            refuse(file, fmt::format("reading it was interrupted (signal {})", signal),
                   "try again");
        }
        const std::string crash =
            fmt::format("its decoder crashed (signal {}, {})", signal, ::strsignal(signal));
        const char* const remedy = "the file is damaged or of an unknown kind";
        if (signal == SIGKILL || signal == SIGBUS) {
            refuseShort(file, crash + ": the machine may be out of memory", remedy);
        }
        refuse(file, crash, remedy);
    }
    refuse(file,
           fmt::format("its decoder ended early (exit code {})",
                       WIFEXITED(status) ? WEXITSTATUS(status) : 0),
           "the file is damaged or of an unknown kind");
}

[[noreturn]] void rethrow(const fs::path& file, const SandboxAnswer& answer,
                          const SandboxLimits& limits) {
    switch (answer.kind) {
        case SandboxAnswer::Kind::FileError:
            throw FileError(answer.message);
        case SandboxAnswer::Kind::Shortage:
            throw Shortage(answer.message);
        case SandboxAnswer::Kind::InvalidInput:
            throw InvalidInput(answer.message);
        case SandboxAnswer::Kind::InternalError:
            throw InternalError(answer.message);
        case SandboxAnswer::Kind::OutOfMemory:
            refuse(file,
                   fmt::format("decoding it asks for more than {} MB of memory",
                               limits.memoryBytes / 1'000'000),
                   "the file is damaged, or needs a machine with more memory");
        default:
            refuse(file, "can't be decoded", "the file is damaged or of an unknown kind");
    }
}

}  // namespace

std::uint64_t machineMemoryBytes() {
    struct sysinfo info {};
    if (::sysinfo(&info) != 0) return ~std::uint64_t{0};
    return (std::uint64_t{info.totalram} + info.totalswap) * info.mem_unit;
}

SandboxLimits sandboxLimitsFor(const fs::path& input) {
    std::error_code error;
    std::uint64_t inputBytes = 0;
    if (fs::is_directory(input, error)) {
        for (fs::directory_iterator it(input, error), end; !error && it != end;
             it.increment(error)) {
            std::error_code ignored;
            if (!it->is_regular_file(ignored)) continue;
            const std::uintmax_t bytes = it->file_size(ignored);
            if (!ignored) inputBytes += bytes;
        }
    } else if (const std::uintmax_t bytes = fs::file_size(input, error); !error) {
        inputBytes = bytes;
    }
    constexpr std::uint64_t kLargestCounted = std::uint64_t{1} << 40;
    inputBytes = std::min(inputBytes, kLargestCounted);
    constexpr std::uint64_t kMillisecondsFloor = 15'000, kBytesPerMillisecond = 1000;
    constexpr std::uint64_t kMemoryFloor = std::uint64_t{1} << 30, kMemoryPerByte = 64;
    return {std::chrono::milliseconds(kMillisecondsFloor + inputBytes / kBytesPerMillisecond),
            std::min(kMemoryFloor + kMemoryPerByte * inputBytes, machineMemoryBytes())};
}

ReadVolume readInSandbox(const fs::path& input, const SandboxLimits& limits,
                         const std::function<ReadVolume()>& read) {
    if (isInSandbox()) return read();

    const FileDescriptor memory(::memfd_create("adaptiso", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    int ends[2] = {-1, -1};
    if (memory.number() < 0 || ::pipe2(ends, O_CLOEXEC) != 0) refuseStart(input);
    const FileDescriptor answerEnd(ends[0]);
    FileDescriptor childsEnd(ends[1]);
    const BlameNote blame;
    if (!blame.isUsable()) refuseStart(input);

    const pid_t pid = forkSandboxChild(
        {childsEnd.number(), memory.number(), blame.bytes(), limits.memoryBytes}, read);
    if (pid < 0) refuseStart(input);
    ChildProcess child(pid);
    childsEnd.close();

    std::string bytes;
    const std::string exceeded = collect(answerEnd.number(), pid, limits.time, bytes);
    const int status = child.end();
    const fs::path blamed = blame.fileOr(input);
    if (!exceeded.empty()) {
        refuse(blamed, fmt::format("its decoding was stopped after {} without an end", exceeded),
               "the file is damaged, or its disk does not answer");
    }
    if (bytes.empty()) refuseSilence(blamed, status);
    std::optional<SandboxAnswer> answer = parseSandboxAnswer(bytes);
    if (!answer) {
        // one that answers without an end was stopped by us
        const bool isCut = WIFSIGNALED(status) && bytes.size() <= kLongestAnswer;
        if (isCut) refuseSilence(blamed, status);
        refuse(blamed, "its decoder answered nonsense", "the file is damaged");
    }
    if (answer->kind != SandboxAnswer::Kind::Volume) rethrow(blamed, *answer, limits);
    return volumeOf(input, memory.number(), std::move(*answer));
}

}  // namespace adaptiso::detail
