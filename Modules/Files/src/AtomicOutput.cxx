#include "adaptiso/Files/AtomicOutput.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string_view>

#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Shortage.h"

namespace adaptiso {

namespace fs = std::filesystem;

/// A file or folder that a signal's handler removes. Records are only ever added to the list,
/// newest first, so that the handler may walk it at any moment; a folder's files come before it.
struct detail::Temporary {
    const std::string path;
    const int lock;  ///< an open file with flock(), for as long as the process lives; -1 for none
    std::atomic<bool> exists{true};
    Temporary* next = nullptr;
};

namespace {

using detail::folderOf, detail::reason, detail::Temporary;

std::atomic<Temporary*> newestTemporary{nullptr};
std::atomic<int> signalsWait{0}, postponedSignal{0}, writingChild{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal's handler may use no locks");

void require(bool isGood, const fs::path& target, const std::string& fault) {
    if (!isGood) throw FileError(target.string() + ": " + fault);
}

/// Throws unless a system call succeeded; the message ends with the text of errno.
void requireDone(bool isDone, const fs::path& target, const char* fault = "can't be written") {
    if (isDone) return;
    if (isShortage(errno)) throw Shortage(target.string() + ": " + fault + ": " + reason());
    require(false, target, fault + (": " + reason()));
}

std::string prefixOf(int process) {
    return ".adaptiso-" + std::to_string(process) + "-";
}

/// True for the names that newName() makes: ".adaptiso-12-0.part.vtp".
bool isOwnName(std::string_view name) {
    const auto take = [&name](std::string_view text) {
        if (!name.starts_with(text)) return false;
        name.remove_prefix(text.size());
        return true;
    };
    const auto takeDigits = [&name] {
        const std::size_t count = std::min(name.find_first_not_of("0123456789"), name.size());
        name.remove_prefix(count);
        return count > 0;
    };
    return take(".adaptiso-") && takeDigits() && take("-") && takeDigits() && take(".part") &&
           (name.empty() || name.rfind('.') == 0);
}

/// ".adaptiso-<process>-<n>.part<extension>" beside `final`.
fs::path newName(const fs::path& final) {
    static std::atomic<int> count{0};
    std::string extension = final.extension().string();  // writers choose formats by it
    if (extension.size() > 40) extension.clear();        // the name could exceed NAME_MAX
    return folderOf(final) / (prefixOf(getpid()) + std::to_string(count++) + ".part" + extension);
}

/// Async-signal-safe. A file or an empty folder; the flag falls last, for a handler in between.
void removeNow(Temporary* temporary) {
    if (!temporary->exists.load()) return;
    if (unlink(temporary->path.c_str()) != 0) rmdir(temporary->path.c_str());
    temporary->exists.store(false);
}

/// Opens a file or folder and locks it. \return -1 and EWOULDBLOCK: a living process holds the lock
int openLocked(const fs::path& path) {
    int file = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0 && errno == EISDIR) file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_DIRECTORY);
    if (file < 0 || flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    const int fault = errno;
    close(file);
    errno = fault;
    return -1;
}

/// Makes an empty file or folder beside `final`; others may open it only where nothing stands yet
/// whose permissions it is to take over. \throws FileError  naming `target`
std::shared_ptr<Temporary> makeTemporary(const fs::path& final, bool isFolder,
                                         const fs::path& target) {
#ifndef __EMSCRIPTEN__  // whose flock() locks nothing; a page's files are of one process
    detail::removeLeftTemporaries(folderOf(final), 0);
#endif
    const detail::SignalsWait untilItIsRecorded;
    const unsigned mode = access(final.c_str(), F_OK) == 0 ? 0700 : 0777;
    for (;;) {
        const fs::path path = newName(final);
        const int made =
            isFolder ? mkdir(path.c_str(), mode)
                     : open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode & 0666U);
        if (made >= 0 && !isFolder) close(made);
        if (made < 0) {
            // processes of other machines and containers may have the same number
            requireDone(errno == EEXIST, target, "can't be made");
            continue;
        }
        // one that cleans up may come in between, and is about to remove it or has done so
        const int lock = openLocked(path);
        const bool isTaken = lock < 0 && errno == EWOULDBLOCK;
        if (!isTaken && access(path.c_str(), F_OK) == 0) return detail::removedAtEnd(path, lock);
        if (lock >= 0) close(lock);
    }
}

/// Async-signal-safe. \pre installed with SA_NODEFER
void removeTemporariesAndEnd(int signal) {
    if (signalsWait.load() > 0) {
        postponedSignal.store(signal);
        return;
    }
    detail::removeTemporaries();
    std::signal(signal, SIG_DFL);
    raise(signal);
}

/// The path with symbolic links resolved, also those to a file that does not exist yet.
fs::path resolved(const fs::path& target) {
    fs::path file = target;
    std::error_code error;
    for (int n = 0; n < 40 && fs::is_symlink(file, error); ++n) {  // as many as Linux follows
        file = folderOf(file) / fs::read_symlink(file);  // an absolute link replaces the folder
    }
    return file;
}

/// Gives `temporary` the mode of `final`, which it is about to replace, and its owner and group
/// where permitted; where the group can't be kept, the new one gets no permissions.
void keepAttributes(const fs::path& final, const fs::path& temporary) {
    struct stat old {};
    if (stat(final.c_str(), &old) != 0) return;
    constexpr auto kSame = static_cast<uid_t>(-1);
    const bool keepsGroup = chown(temporary.c_str(), old.st_uid, old.st_gid) == 0 ||
                            chown(temporary.c_str(), kSame, old.st_gid) == 0;
    // a folder passes on who inherits its group and who may remove from it; a file no such rights
    const mode_t all = S_ISDIR(old.st_mode) ? 03777U : 0777U;
    (void)!chmod(temporary.c_str(), old.st_mode & (keepsGroup ? all : 0707U));
}

/// \param sync  fsync(), or syncfs() for the whole file system
bool forceToDisk(const fs::path& path, int (*sync)(int) = fsync) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool isSynced = file >= 0 && sync(file) == 0;
    if (file >= 0) close(file);
    return isSynced;
}

/// Calls `writer`; its errors name `target` where they name `temporary`.
void writeNaming(const fs::path& temporary, const fs::path& target,
                 const std::function<void()>& writer) {
    const auto renamed = [&](std::string text) {
        const std::string from = temporary.string(), to = target.string();
        for (std::size_t at = text.find(from); at != std::string::npos;
             at = text.find(from, at + to.size())) {
            text.replace(at, from.size(), to);
        }
        return text;
    };
    try {
        errno = 0;
        writer();
    } catch (const FileError& error) {
        if (isShortage(errno)) throw Shortage(renamed(error.what()));  // writers say it in words
        throw FileError(renamed(error.what()));
    } catch (const InvalidInput& error) {
        throw InvalidInput(renamed(error.what()));
    }
}

void writeFile(const fs::path& path, std::span<const std::byte> bytes) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    file.close();
    requireDone(file.good(), path);
}

void requireFolder(const fs::path& target, const fs::path& folder) {
    std::error_code error;
    require(fs::is_directory(folder, error), target, "there is no folder " + folder.string());
    requireDone(access(folder.c_str(), W_OK | X_OK) == 0, target, "the folder can't be written");
}

/// A name in `folder` that is not an own file's nor a folder of them; may be empty.
std::string foreignName(const fs::path& folder, const OwnNames& ownNames) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const fs::file_status status = entry.symlink_status();
        if (fs::is_directory(status) && !fs::is_empty(entry.path())) continue;
        std::string name = entry.path().lexically_relative(folder).generic_string();
        if (!fs::is_regular_file(status) || !ownNames || !ownNames(name)) return name;
    }
    return {};
}

void renameTo(const fs::path& temporary, const fs::path& final, const fs::path& target) {
    std::error_code error;
    fs::rename(temporary, final, error);
    require(!error, target, "can't be put in place: " + error.message());
    forceToDisk(folderOf(final));
}

}  // namespace

void makeFolders(const fs::path& folder, const fs::path& ownFolder) {
    if (!ownFolder.empty()) requireNoLink(folder, ownFolder);
    std::error_code error;
    fs::create_directories(folder, error);
    require(!error, folder, "the folder can't be made (" + error.message() + "); choose another");
}

void checkOutput(const fs::path& target, const fs::path& ownFolder) {
    if (!ownFolder.empty()) requireNoLink(target, ownFolder);
    const fs::path file = resolved(target);
    requireFolder(target, folderOf(file));
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) return;
    require(fs::is_regular_file(status), target, "exists and is not a regular file");
    require(access(file.c_str(), W_OK) == 0, target, "exists and is write-protected");
}

void checkNotInput(const fs::path& target, const fs::path& input) {
    std::error_code error;
    fs::path file = input;
    const std::string name = input.string();
    if (!fs::exists(input, error)) file = name.substr(0, name.rfind(':'));  // model.fif:inner_skull
    require(!fs::equivalent(target, file, error), target,
            "is the input, which is never overwritten");
}

void removeOutputsOnSignals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        struct sigaction action {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler == SIG_IGN) continue;  // as under nohup
        action.sa_handler = removeTemporariesAndEnd;
        action.sa_flags = SA_NODEFER;
        sigaction(signal, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

namespace detail {

std::shared_ptr<Temporary> removedAtEnd(const fs::path& path, int lock) {
    auto* const temporary = new Temporary{path.string(), lock};  // for as long as a signal may come
    temporary->next = newestTemporary.load();
    while (!newestTemporary.compare_exchange_weak(temporary->next, temporary)) {
    }
    return {temporary, [](Temporary* each) {
                removeNow(each);
                if (each->lock >= 0) close(each->lock);
            }};
}

void removeTemporaries() {
    if (const int child = writingChild.exchange(0); child > 0) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    for (auto* each = newestTemporary.load(); each != nullptr; each = each->next) removeNow(each);
}

void removeLeftTemporaries(const fs::path& folder, int process) {
    const auto dayAgo = fs::file_time_type::clock::now() - std::chrono::hours(24);
    std::error_code error, ignored;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (!isOwnName(name)) continue;
        const int lock = openLocked(entry.path());
        if (lock < 0 && errno == EWOULDBLOCK) continue;
        const auto written = entry.last_write_time(error);
        const bool isOld = !error && written < dayAgo;  // where there are no locks
        if (lock >= 0 || isOld || name.starts_with(prefixOf(process))) {
            fs::remove_all(entry.path(), ignored);
        }
        if (lock >= 0) close(lock);
    }
}

void endFirst(int process) {
    writingChild.store(process);
}

SignalsWait::SignalsWait() {
    ++signalsWait;
}

SignalsWait::~SignalsWait() {
    if (--signalsWait > 0) return;
    if (const int signal = postponedSignal.exchange(0); signal != 0) raise(signal);
}

bool SignalsWait::hasCome() {
    return postponedSignal.load() != 0;
}

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::string reason() {
    return std::strerror(errno);
}

}  // namespace detail

AtomicOutput::AtomicOutput(const fs::path& target, const fs::path& ownFolder)
    : target_(target), ownFolder_(ownFolder), final_(resolved(target)) {
    checkOutput(target, ownFolder);
    record_ = makeTemporary(final_, false, target_);
    temporary_ = record_->path;
}

void AtomicOutput::write(const std::function<void(const fs::path&)>& writer) {
    writeNaming(temporary_, target_, [&] { writer(temporary_); });
    requireDone(forceToDisk(temporary_), target_);
}

void AtomicOutput::writeText(const std::string& text) {
    writeBytes(std::as_bytes(std::span(text)));
}

void AtomicOutput::writeBytes(std::span<const std::byte> bytes) {
    write([&](const fs::path& path) { writeFile(path, bytes); });
}

void AtomicOutput::check(std::span<const AtomicOutput> outputs) {
    for (const AtomicOutput& output : outputs) {
        checkOutput(output.target_, output.ownFolder_);
        require(fs::exists(output.temporary_), output.target_, "its temporary file is gone");
    }
}

void AtomicOutput::commit(std::span<AtomicOutput> outputs) {
    const detail::SignalsWait untilAllAreInPlace;
    check(outputs);
    for (const AtomicOutput& output : outputs) {
        keepAttributes(output.final_, output.temporary_);
        renameTo(output.temporary_, output.final_, output.target_);
        output.record_->exists.store(false);
    }
}

AtomicFolder::AtomicFolder(const fs::path& target, const OwnNames& ownNames)
    : target_(target.has_filename() ? target : folderOf(target)), ownNames_(ownNames) {
    check(target_, ownNames);
    records_.push_back(makeTemporary(target_, true, target_));
    temporary_ = records_.front()->path;
}

AtomicFolder::~AtomicFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
}

void AtomicFolder::check(const fs::path& path, const OwnNames& ownNames) {
    const fs::path target = path.has_filename() ? path : folderOf(path);
    requireFolder(target, folderOf(target));
    std::error_code error;
    const fs::file_status status = fs::symlink_status(target, error);
    if (!fs::exists(status)) return;
    require(fs::is_directory(status), target, "exists and is no folder");
    const std::string other = foreignName(target, ownNames);
    require(other.empty() || ownNames, target,
            "exists and is not empty; --force replaces a folder that this program wrote");
    require(other.empty(), target,
            "holds " + other + ", which this program does not write; it is not replaced");
}

fs::path AtomicFolder::place(const std::string& name) {
    fs::path file = temporary_ / name;
    const fs::path folder = file.parent_path();
    if (folder != temporary_ && !fs::exists(folder)) {
        records_.push_back(detail::removedAtEnd(folder));
        fill([&] { makeFolders(folder); });
    }
    names_.push_back(name);
    records_.push_back(detail::removedAtEnd(file));
    return file;
}

std::vector<std::pair<std::string, std::uintmax_t>> AtomicFolder::files() const {
    std::vector<std::pair<std::string, std::uintmax_t>> result;
    for (const std::string& name : names_) {
        std::error_code error;
        result.emplace_back(name, fs::file_size(temporary_ / name, error));
    }
    return result;
}

void AtomicFolder::fill(const std::function<void()>& writer) {
    writeNaming(temporary_, target_, writer);
}

void AtomicFolder::writeText(const std::string& name, const std::string& text) {
    const fs::path file = place(name);
    fill([&] { writeFile(file, std::as_bytes(std::span(text))); });
}

void AtomicFolder::commit(std::span<AtomicOutput> outputs) {
    constexpr std::size_t kMany = 64;  // one syncfs() costs less than so many fsync()
    const bool areMany = names_.size() > kMany;
    for (const std::string& name : names_) {
        const fs::path file = temporary_ / name;
        keepAttributes(target_ / name, file);
        requireDone(areMany || (forceToDisk(file) && forceToDisk(file.parent_path())), target_);
    }
    requireDone(forceToDisk(temporary_, areMany ? syncfs : fsync), target_);
    const detail::SignalsWait untilAllAreInPlace;
    check(target_, ownNames_);  // again: it may have changed
    AtomicOutput::check(outputs);
    keepAttributes(target_, temporary_);
    const fs::path former = newName(target_);  // for a moment there is neither
    const int lock = openLocked(target_);
    std::error_code ignored;
    fs::rename(target_, former, ignored);
    try {
        renameTo(temporary_, target_, target_);
    } catch (const FileError&) {
        fs::rename(former, target_, ignored);
        if (lock >= 0) close(lock);
        throw;
    }
    fs::remove_all(former, ignored);
    if (lock >= 0) close(lock);
    for (const auto& record : records_) record->exists.store(false);
    AtomicOutput::commit(outputs);
}

}  // namespace adaptiso
