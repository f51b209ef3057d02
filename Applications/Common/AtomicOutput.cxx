#include "Common/AtomicOutput.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// A temporary file that a signal's handler may have to remove. Records are only ever added to the
/// list, and one's path is set before it is, so that the handler may walk the list at any moment.
struct Temporary {
    const std::string path;
    std::atomic<bool> exists{true};
    Temporary* next = nullptr;
};

std::atomic<Temporary*> temporaries{nullptr};
std::atomic<bool> signalsWait{false};
std::atomic<int> postponedSignal{0};
static_assert(std::atomic<Temporary*>::is_always_lock_free &&
                  std::atomic<bool>::is_always_lock_free,
              "a signal's handler may use only atomics without locks");

Temporary& rememberTemporary(const fs::path& path) {
    auto* const temporary = new Temporary{path.string()};  // kept as long as a signal may come
    temporary->next = temporaries.load();
    while (!temporaries.compare_exchange_weak(temporary->next, temporary)) {
    }
    return *temporary;
}

/// Async-signal-safe: unlink, sigaction, raise and lock-free atomics only.
void removeTemporariesAndEnd(int signal) {
    if (signalsWait.load()) {
        postponedSignal.store(signal);
        return;
    }
    for (const Temporary* t = temporaries.load(); t != nullptr; t = t->next) {
        if (t->exists.load()) unlink(t->path.c_str());
    }
    struct sigaction byDefault {};
    byDefault.sa_handler = SIG_DFL;
    sigaction(signal, &byDefault, nullptr);
    raise(signal);  // the handler was installed with SA_NODEFER: this ends the program here
}

/// While one lives, a signal waits: what is done meanwhile is done whole.
class SignalsWait {
public:
    SignalsWait() { signalsWait.store(true); }
    ~SignalsWait() {
        signalsWait.store(false);
        if (const int signal = postponedSignal.exchange(0); signal != 0) raise(signal);
    }
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;
};

std::string reason() {
    return std::strerror(errno);
}

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Where the file really goes: symbolic links are followed, also to a file that is not there yet.
fs::path resolved(const fs::path& target) {
    constexpr int kMaxLinks = 40;  // as many as Linux follows
    fs::path file = target;
    std::error_code error;
    for (int n = 0; n < kMaxLinks && fs::is_symlink(file, error); ++n) {
        file = folderOf(file) / fs::read_symlink(file);  // an absolute link replaces the folder
    }
    return file;
}

void syncToDisk(const fs::path& path, const fs::path& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool isSynced = file >= 0 && fsync(file) == 0;
    const std::string why = isSynced ? "" : reason();
    if (file >= 0) close(file);
    if (!isSynced) throw FileError(target.string() + ": can't be written: " + why);
}

/// So that the new name outlives a power failure. Not every file system can; the file is whole.
void syncFolder(const fs::path& folder) {
    const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    fsync(file);
    close(file);
}

std::string withTargetsName(std::string message, const fs::path& temporary,
                            const fs::path& target) {
    const std::string from = temporary.string();
    const std::string to = target.string();
    for (std::size_t at = message.find(from); at != std::string::npos;
         at = message.find(from, at + to.size())) {
        message.replace(at, from.size(), to);
    }
    return message;
}

}  // namespace

struct AtomicOutput::Registration {
    explicit Registration(Temporary& temporary) : temporary_(temporary) {}
    ~Registration() {
        if (temporary_.exists.load()) unlink(temporary_.path.c_str());
        temporary_.exists.store(false);
    }
    Registration(const Registration&) = delete;
    Registration& operator=(const Registration&) = delete;

    Temporary& temporary_;
};

void checkOutput(const fs::path& target) {
    const fs::path file = resolved(target);
    const fs::path folder = folderOf(file);
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw FileError(target.string() + ": there is no folder " + folder.string());
    }
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        throw FileError(target.string() + ": the folder can't be written: " + reason());
    }
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) return;
    if (!fs::is_regular_file(status)) {
        throw FileError(target.string() + ": exists and is not a regular file");
    }
    if (access(file.c_str(), W_OK) != 0) {
        throw FileError(target.string() + ": exists and is write-protected");
    }
}

void checkNotInput(const fs::path& target, const fs::path& input) {
    std::error_code error;
    if (fs::equivalent(target, input, error)) {
        throw FileError(target.string() + ": is the input, which is never overwritten");
    }
}

AtomicOutput::AtomicOutput(const fs::path& target) : target_(target), final_(resolved(target)) {
    checkOutput(target);
    static std::atomic<int> count{0};
    const SignalsWait untilItIsRemembered;
    for (;;) {
        temporary_ =
            folderOf(final_) / (".adaptiso-" + std::to_string(getpid()) + "-" +
                                std::to_string(count++) + ".part" + final_.extension().string());
        const int file = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) {
            close(file);
            break;
        }
        // a machine that shares this folder may have a process of the same number
        if (errno != EEXIST) throw FileError(target_.string() + ": can't be made: " + reason());
    }
    registration_ = std::make_unique<Registration>(rememberTemporary(temporary_));
}

AtomicOutput::~AtomicOutput() = default;
AtomicOutput::AtomicOutput(AtomicOutput&&) noexcept = default;

void AtomicOutput::write(const std::function<void(const fs::path&)>& writer) {
    try {
        writer(temporary_);
    } catch (const FileError& error) {
        throw FileError(withTargetsName(error.what(), temporary_, target_));
    } catch (const InvalidInput& error) {
        throw InvalidInput(withTargetsName(error.what(), temporary_, target_));
    }
    syncToDisk(temporary_, target_);
}

void AtomicOutput::writeText(const std::string& text) {
    writeBytes(std::as_bytes(std::span(text)));
}

void AtomicOutput::writeBytes(std::span<const std::byte> bytes) {
    write([&](const fs::path& path) {
        std::ofstream file(path, std::ios::binary | std::ios::trunc);
        file.write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) throw FileError(path.string() + ": can't be written: " + reason());
    });
}

void AtomicOutput::commit(std::span<AtomicOutput> outputs) {
    const SignalsWait untilAllAreInPlace;
    for (AtomicOutput& output : outputs) {
        if (std::rename(output.temporary_.c_str(), output.final_.c_str()) != 0) {
            throw FileError(output.target_.string() + ": can't be put in place: " + reason());
        }
        output.registration_->temporary_.exists.store(false);
        syncFolder(folderOf(output.final_));
    }
}

void removeOutputsOnSignals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        struct sigaction old {};
        sigaction(signal, nullptr, &old);
        if (old.sa_handler == SIG_IGN) continue;  // as under nohup
        struct sigaction action {};
        action.sa_handler = removeTemporariesAndEnd;
        action.sa_flags = SA_NODEFER;
        sigaction(signal, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace adaptiso
