#include "Common/TemporaryNames.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <ctime>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "Common/Sha256.h"
#include "Common/Temporaries.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = ".adaptiso-";

/// A process, told from all others of the machines that share a disk.
struct Owner {
    std::string process, start, space, boot, machine;  ///< empty: unknown

    bool isKnown() const { return !start.empty() && !space.empty() && !boot.empty(); }
};

std::string content(const char* file) {
    std::ifstream in(file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

std::string abbreviated(const std::string& text) {
    constexpr std::size_t kDigits = 8;
    return text.empty() ? text : sha256Of(text).substr(0, kDigits);
}

/// When a process began, in clock ticks since the machine's start; empty: unknown or no process.
std::string startOf(const std::string& process) {
    constexpr int kFieldsBefore = 19;  // proc(5): starttime is field 22, the first here is field 3
    const std::string stat = content(("/proc/" + process + "/stat").c_str());
    const std::size_t afterName = stat.rfind(')');
    if (afterName == std::string::npos) return {};
    std::size_t at = afterName + 2;
    for (int n = 0; n < kFieldsBefore && at != std::string::npos; ++n) {
        at = stat.find(' ', at);
        if (at != std::string::npos) ++at;
    }
    if (at == std::string::npos) return {};
    return stat.substr(at, stat.find(' ', at) - at);
}

/// The number in "pid:[4026531836]", one of a kind while the namespace lives.
std::string pidNamespace() {
    std::error_code error;
    const std::string link = fs::read_symlink("/proc/self/ns/pid", error).string();
    const std::size_t begin = link.find('['), end = link.find(']');
    if (error || begin == std::string::npos || end == std::string::npos) return {};
    return link.substr(begin + 1, end - begin - 1);
}

/// Copies of a machine share its identity, and so may machines that start from one disk; they have
/// names of their own.
std::string machineName() {
    constexpr std::size_t kLongest = 256;
    const std::string id = content("/etc/machine-id");
    std::string name(kLongest, '\0');
    if (id.empty() || gethostname(name.data(), name.size() - 1) != 0) return {};
    return id + "/" + name.c_str();
}

/// Asked anew in a process that was forked.
const Owner& thisProcess() {
    static Owner owner;
    const std::string process = std::to_string(getpid());
    if (owner.process != process) {
        owner = {process, startOf("self"), pidNamespace(),
                 abbreviated(content("/proc/sys/kernel/random/boot_id")),
                 abbreviated(machineName())};
    }
    return owner;
}

struct ParsedName {
    Owner owner;
    bool keepsLock = false;
};

/// None: not the name of a temporary of ours.
std::optional<ParsedName> parse(std::string_view name) {
    constexpr std::size_t kParts = 6;
    const std::size_t end = name.find(".part");
    if (!name.starts_with(kPrefix) || end == std::string_view::npos) return std::nullopt;
    name = name.substr(kPrefix.size(), end - kPrefix.size());
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t dash = std::min(name.find('-', at), name.size());
        parts.emplace_back(name.substr(at, dash - at));
        at = dash + 1;
    }
    if (parts.size() != kParts || parts.front().empty()) return std::nullopt;
    return ParsedName{{parts[0], parts[1], parts[2], parts[3], parts[4]}, parts[5].ends_with('k')};
}

/// It may run where this process can't see it but as a number.
bool hasEnded(const Owner& owner) {
    pid_t process = 0;
    const char* const end = owner.process.data() + owner.process.size();
    if (std::from_chars(owner.process.data(), end, process).ptr != end || process <= 0) {
        return false;
    }
    if (kill(process, 0) != 0 && errno == ESRCH) return true;
    const std::string start = startOf(owner.process);
    return !start.empty() && start != owner.start;  // another process has got its number
}

/// The lock of a file or folder that nobody else keeps, as a descriptor; -1: somebody does, or it
/// can't be told.
int lockOf(const fs::path& path) {
    // a network's file system locks only what may be written
    int file = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    if (file >= 0) close(file);
    return -1;
}

/// Made a while ago: its maker had the time to lock it.
bool isOld(const fs::path& path) {
    constexpr std::time_t kSeconds = 60;
    struct stat status {};
    return lstat(path.c_str(), &status) == 0 && status.st_ctime + kSeconds < std::time(nullptr);
}

void removeIfLeft(const fs::path& path, const Owner& self) {
    const std::optional<ParsedName> name = parse(path.filename().string());
    if (!name || !name->owner.isKnown()) return;
    const Owner& owner = name->owner;
    if (owner.boot == self.boot && owner.space == self.space) {
        if (hasEnded(owner)) removeTemporary(path);
        return;
    }
    const bool isOfThisMachine =
        owner.boot == self.boot || (!owner.machine.empty() && owner.machine == self.machine);
    if (!isOfThisMachine || !name->keepsLock || !isOld(path)) return;
    const int lock = lockOf(path);
    if (lock < 0) return;
    removeTemporary(path);
    close(lock);
}

std::string nameFor(const fs::path& final, bool keepsLock) {
    // writers look at extensions of formats, which are short; a long one could make the name too
    // long for the file system
    constexpr std::size_t kLongestExtension = 40;
    static std::atomic<int> count{0};
    const Owner& self = thisProcess();
    const std::string extension = final.extension().string();
    return std::string(kPrefix) + self.process + "-" + self.start + "-" + self.space + "-" +
           self.boot + "-" + self.machine + "-" + std::to_string(count++) + (keepsLock ? "k" : "") +
           ".part" + (extension.size() > kLongestExtension ? std::string() : extension);
}

void removeLeftOnce(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> done;
    const std::lock_guard<std::mutex> lock(mutex);
    if (done.insert(folder).second) removeLeftTemporaries(folder);
}

/// \param make  makes a file or folder and opens it: a descriptor, or -1 and errno
template <class Make>
NewTemporary makeTemporary(const fs::path& final, const fs::path& target, const Make& make) {
    constexpr int kMostLocks = 256;  // descriptors are few, and others need them
    removeLeftOnce(folderOf(final));
    bool canLock = true;
    for (;;) {
        const fs::path path = folderOf(final) / nameFor(final, canLock);
        const int file = make(path);
        if (file < 0) {
            // a machine that shares this folder may have a process of the same number
            if (errno == EEXIST) continue;
            throw FileError(target.string() + ": can't be made: " + reason());
        }
        if (!canLock) {
            close(file);
            return {path, -1};
        }
        if (file < kMostLocks && flock(file, LOCK_EX | LOCK_NB) == 0) return {path, file};
        canLock = false;
        close(file);
        removeTemporary(path);
    }
}

}  // namespace

void removeTemporary(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(fs::symlink_status(path, error))) {
        for (const auto& entry : fs::directory_iterator(path, error)) {
            removeTemporary(entry.path());  // a file, or a folder of files
        }
        rmdir(path.c_str());
    } else {
        unlink(path.c_str());
    }
}

void removeLeftTemporaries(const fs::path& folder) {
    const Owner& self = thisProcess();
    if (!self.isKnown()) return;
    std::error_code error;
    std::vector<fs::path> found;
    fs::directory_iterator entry(folder, error);
    for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
        if (entry->path().filename().string().starts_with(kPrefix)) found.push_back(entry->path());
    }
    for (const fs::path& path : found) removeIfLeft(path, self);
}

fs::path newTemporaryName(const fs::path& final) {
    return folderOf(final) / nameFor(final, false);
}

NewTemporary makeTemporaryFile(const fs::path& final, unsigned mode, const fs::path& target) {
    return makeTemporary(final, target, [mode](const fs::path& path) {
        return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    });
}

NewTemporary makeTemporaryFolder(const fs::path& final, unsigned mode, const fs::path& target) {
    return makeTemporary(final, target, [mode](const fs::path& path) {
        if (mkdir(path.c_str(), mode) != 0) return -1;
        const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder < 0) {
            const int why = errno;
            rmdir(path.c_str());
            errno = why;
        }
        return folder;
    });
}

}  // namespace adaptiso::detail
