#include "Common/Temporaries.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "Common/AtomicOutput.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace detail {
namespace {

namespace fs = std::filesystem;

std::atomic<Temporary*> temporaries{nullptr};
std::atomic<int> signalsWait{0};
std::atomic<int> postponedSignal{0};
std::atomic<int> writingChild{0};  ///< process; 0: none
static_assert(std::atomic<Temporary*>::is_always_lock_free &&
                  std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal's handler may use only atomics without locks");

}  // namespace

void endFirst(int process) {
    writingChild.store(process);
}

/// kill, waitpid, unlink and rmdir only.
void removeTemporaries() {
    if (const int child = writingChild.exchange(0); child > 0) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    for (const Temporary* t = temporaries.load(); t != nullptr; t = t->next) {
        if (!t->exists.load()) continue;
        if (t->isFolder) {
            rmdir(t->path.c_str());
        } else {
            unlink(t->path.c_str());
        }
    }
}

namespace {

/// Async-signal-safe. \pre its handler was installed with SA_NODEFER
void endBySignal(int signal) {
    struct sigaction byDefault {};
    byDefault.sa_handler = SIG_DFL;
    sigaction(signal, &byDefault, nullptr);
    raise(signal);
}

/// Async-signal-safe: the above and lock-free atomics only.
void removeTemporariesAndEnd(int signal) {
    if (signalsWait.load() > 0) {
        postponedSignal.store(signal);
        return;
    }
    removeTemporaries();
    endBySignal(signal);
}

}  // namespace

Temporary& rememberTemporary(const fs::path& path, bool isFolder) {
    auto* const temporary = new Temporary{path.string(), isFolder};
    temporary->next = temporaries.load();
    while (!temporaries.compare_exchange_weak(temporary->next, temporary)) {
    }
    return *temporary;
}

Registration::~Registration() {
    if (temporary_.exists.load()) {
        if (temporary_.isFolder) {
            rmdir(temporary_.path.c_str());
        } else {
            unlink(temporary_.path.c_str());
        }
    }
    temporary_.exists.store(false);
    if (lock_ >= 0) close(lock_);
}

SignalsWait::SignalsWait() {
    ++signalsWait;
}

SignalsWait::~SignalsWait() {
    if (--signalsWait > 0) return;
    if (const int signal = postponedSignal.exchange(0); signal != 0) raise(signal);
}

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::string reason() {
    return std::strerror(errno);
}

void syncToDisk(const fs::path& path, const fs::path& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool isSynced = file >= 0 && fsync(file) == 0;
    const std::string why = isSynced ? "" : reason();
    if (file >= 0) close(file);
    if (!isSynced) throw FileError(target.string() + ": can't be written: " + why);
}

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

}  // namespace detail

void removeOutputsOnSignals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        struct sigaction old {};
        sigaction(signal, nullptr, &old);
        if (old.sa_handler == SIG_IGN) continue;  // as under nohup
        struct sigaction action {};
        action.sa_handler = detail::removeTemporariesAndEnd;
        action.sa_flags = SA_NODEFER;
        sigaction(signal, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace adaptiso
