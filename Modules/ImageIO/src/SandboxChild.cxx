#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#if __has_include(<linux/landlock.h>)
#include <linux/landlock.h>
#endif

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <new>
#include <optional>
#include <string>

#include "Sandbox.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Shortage.h"

namespace adaptiso::detail {
namespace {

/// Pieces of the shared memory file, each mapped by itself. Lives in the child alone.
class SharedArena {
public:
    SharedArena(int file, std::span<char> blameNote) : file_(file), blameNote_(blameNote) {}

    std::shared_ptr<std::byte[]> allocate(std::uint64_t byteCount) {
        const std::uint64_t begin = end_;
        if (byteCount > machineMemoryBytes()) return {};  // a memfd itself promises anything
        const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
        const std::uint64_t whole =
            (std::max<std::uint64_t>(byteCount, 1) + page - 1) / page * page;
        if (::ftruncate(file_, static_cast<off_t>(begin + whole)) != 0) return {};
        void* const mapped = ::mmap(nullptr, whole, PROT_READ | PROT_WRITE, MAP_SHARED, file_,
                                    static_cast<off_t>(begin));
        if (mapped == MAP_FAILED) return {};
        end_ += whole;
        auto* const bytes = static_cast<std::byte*>(mapped);
        blocks_[bytes] = {begin, whole};
        return {bytes, [this](std::byte* block) { release(block); }};
    }

    /// Where in the file `samples` lie; they are copied into it if they do not yet.
    std::uint64_t offsetOf(const void* samples, std::uint64_t byteCount) {
        const auto* const begin = static_cast<const std::byte*>(samples);
        for (const auto& [bytes, block] : blocks_) {
            if (bytes == begin && byteCount <= block.byteCount) return block.offset;
        }
        copy_ = allocate(byteCount);
        if (!copy_) throw std::bad_alloc();
        std::memcpy(copy_.get(), samples, byteCount);
        return blocks_.at(copy_.get()).offset;
    }

    void blame(const std::string& file) const {
        std::ranges::fill(blameNote_, '\0');
        file.copy(blameNote_.data(), blameNote_.size() - 1);
    }

private:
    struct Block {
        std::uint64_t offset, byteCount;
    };

    void release(std::byte* bytes) {
        const Block block = blocks_.at(bytes);
        blocks_.erase(bytes);
        ::munmap(bytes, block.byteCount);
        ::fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                    static_cast<off_t>(block.offset), static_cast<off_t>(block.byteCount));
    }

    int file_;
    std::span<char> blameNote_;
    std::uint64_t end_ = 0;
    std::map<const std::byte*, Block> blocks_;
    std::shared_ptr<std::byte[]> copy_;
};

SharedArena* arena = nullptr;  // of this process, when it is a child in a sandbox process

void limit(int resource, rlim_t soft) {
    rlimit now{};
    if (::getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) return;
    now.rlim_max = std::min(now.rlim_max, soft);
    now.rlim_cur = now.rlim_max;
    ::setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

/// Private writable memory of this process, as RLIMIT_DATA counts it.
std::uint64_t dataBytes() {
    unsigned long long pages = 0;
    std::FILE* const file = std::fopen("/proc/self/statm", "re");
    if (file == nullptr) return 0;
    if (std::fscanf(file, "%*u %*u %*u %*u %*u %llu", &pages) != 1) pages = 0;
    std::fclose(file);
    return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Signals do what they do by default: the parent's handlers would do the parent's work twice.
void forgetSignalHandlers() {
    for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
    std::signal(SIGXFSZ, SIG_IGN);  // too little room is an error, not a signal
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Keeps `one` and `other` and the three standard streams, which go nowhere.
void closeOtherFiles(int one, int other) {
    if (const int null = ::open("/dev/null", O_RDWR); null >= 0) {
        for (int stream = 0; stream < 3; ++stream) {
            if (stream != one && stream != other) ::dup2(null, stream);
        }
    }
    const auto low = static_cast<unsigned>(std::min(one, other));
    const auto high = static_cast<unsigned>(std::max(one, other));
    if (low > 3) ::close_range(3, low - 1, 0);
    if (high > low + 1) ::close_range(std::max(low + 1, 3U), high - 1, 0);
    ::close_range(std::max(high + 1, 3U), ~0U, 0);
}

void sandboxIn(const SandboxChildSetup& setup, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);  // it died before
    const std::uint64_t inherited = dataBytes();
    closeOtherFiles(setup.answerPipe, setup.sharedMemory);
    forgetSignalHandlers();
    limit(RLIMIT_CORE, 0);  // a core file would hold patient data
    limit(RLIMIT_FSIZE, RLIM_INFINITY);
    limit(RLIMIT_DATA, inherited + setup.memoryBytes);
    ::prctl(PR_SET_DUMPABLE, 0);  // nor may a crash reporter have it
}

SandboxAnswer answerOf(const std::function<ReadVolume()>& read, std::optional<ReadVolume>& result) {
    SandboxAnswer answer;
    const auto failed = [&](SandboxAnswer::Kind kind, const char* message) {
        answer.kind = kind;
        answer.message = message;
    };
    try {
        result.emplace(read());
        const VolumeView& view = result->volume.view();
        answer.pixelType = view.pixelType();
        answer.geometry = view.geometry();
        answer.byteCount = view.byteCount();
        answer.offset = arena->offsetOf(view.samples(), answer.byteCount);
        answer.format = result->format;
        answer.scaling = result->scaling;
        answer.warnings = result->warnings;
        answer.kind = SandboxAnswer::Kind::Volume;
    } catch (const Shortage& error) {
        failed(SandboxAnswer::Kind::Shortage, error.what());
    } catch (const FileError& error) {
        failed(SandboxAnswer::Kind::FileError, error.what());
    } catch (const InvalidInput& error) {
        failed(SandboxAnswer::Kind::InvalidInput, error.what());
    } catch (const InternalError& error) {
        failed(SandboxAnswer::Kind::InternalError, error.what());
    } catch (const std::bad_alloc&) {
        failed(SandboxAnswer::Kind::OutOfMemory, "");
    } catch (...) {  // the decoders' own: several lines of source places
        failed(SandboxAnswer::Kind::UnknownError, "");
    }
    return answer;
}

bool writeWhole(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t done = ::write(file, bytes.data(), bytes.size());
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(done));
    }
    return true;
}

[[noreturn]] void runChild(const SandboxChildSetup& setup, pid_t parent,
                           const std::function<ReadVolume()>& read) {
    sandboxIn(setup, parent);
    SharedArena ownArena(setup.sharedMemory, setup.blameNote);
    arena = &ownArena;
    std::optional<ReadVolume> result;  // its samples must stay until the parent has the answer
    const bool isTold = writeWhole(setup.answerPipe, packSandboxAnswer(answerOf(read, result)));
    ::_exit(isTold ? 0 : 1);  // no destructors: they are the parent's to run
}

}  // namespace

pid_t forkSandboxChild(const SandboxChildSetup& setup, const std::function<ReadVolume()>& read) {
    // no handler of the parent's may run in the child before they are forgotten
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const pid_t parent = ::getpid();
    const pid_t pid = ::fork();
    if (pid == 0) runChild(setup, parent, read);
    const int error = errno;
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    errno = error;
    return pid;
}

bool isInSandbox() {
    return arena != nullptr;
}

#if defined(LANDLOCK_ACCESS_FS_READ_FILE) && defined(SYS_landlock_create_ruleset)

bool openOnlyBelow(const std::vector<std::filesystem::path>& places) {
    if (!isInSandbox()) throw InternalError("openOnlyBelow: this is no sandbox process");
    constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
    landlock_ruleset_attr rules{};
    rules.handled_access_fs = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;  // all of its first version
    const auto ruleset =
        static_cast<int>(::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0));
    if (ruleset < 0) return false;
    for (const std::filesystem::path& place : places) {
        const int found = ::open(place.c_str(), O_PATH | O_CLOEXEC);
        struct stat status {};
        if (found < 0) continue;
        landlock_path_beneath_attr below{};
        below.parent_fd = found;
        const bool isFolder = ::fstat(found, &status) == 0 && S_ISDIR(status.st_mode);
        below.allowed_access = isFolder ? kRead : LANDLOCK_ACCESS_FS_READ_FILE;
        ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &below, 0);
        ::close(found);
    }
    const bool isConfined = ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                            ::syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
    ::close(ruleset);
    return isConfined;
}

#else

bool openOnlyBelow(const std::vector<std::filesystem::path>&) {
    return false;
}

#endif

void blameInSandbox(const std::filesystem::path& file) {
    if (arena != nullptr) arena->blame(file.native());
}

std::shared_ptr<std::byte[]> allocateSharedBytes(std::uint64_t byteCount) {
    return arena->allocate(byteCount);
}

}  // namespace adaptiso::detail
