#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

namespace detail {
struct Temporary;
}

/// A file that appears under its name only when it is whole.
///
/// It is written to a temporary name in the same folder, forced to disk, then renamed. The
/// temporary is removed when the object goes without commit(), and, once removeOutputsOnSignals()
/// has been called, when a signal ends the program. A file that is replaced passes on its mode, and
/// its owner and group where permitted.
class AtomicOutput {
public:
    /// Makes the temporary file. A symbolic link as target is followed, so that the link stays,
    /// but only where the user named it.
    /// \param ownFolder  where the program chose the name: the folder above it that the user named,
    ///                   below which links are refused; empty: the user named `target`
    /// \throws FileError  as checkOutput(), or the file can't be made
    explicit AtomicOutput(const std::filesystem::path& target,
                          const std::filesystem::path& ownFolder = {});
    AtomicOutput(AtomicOutput&&) = default;

    const std::filesystem::path& target() const { return target_; }
    const std::filesystem::path& temporary() const { return temporary_; }

    /// Calls `writer` with the temporary's name, then forces its bytes to disk.
    /// \throws FileError  the disk refuses. A FileError or InvalidInput of `writer` is rethrown
    /// with
    ///                    the target's name in place of the temporary's.
    void write(const std::function<void(const std::filesystem::path&)>& writer);

    /// The same for bytes or a text in memory. \throws FileError
    void writeBytes(std::span<const std::byte> bytes);
    void writeText(const std::string& text);

    /// Renames `outputs`, once check() has accepted all of them. Signals wait until that is done.
    /// \pre each has been written \throws FileError when a file can't be renamed
    static void commit(std::span<AtomicOutput> outputs);

    /// \throws FileError  a target can't be replaced, or a temporary is gone
    static void check(std::span<const AtomicOutput> outputs);

private:
    std::filesystem::path target_, ownFolder_;
    std::filesystem::path final_;  ///< with a symbolic link resolved
    std::filesystem::path temporary_;
    std::shared_ptr<detail::Temporary> record_;
};

/// Accepts the files that a folder may hold when it is replaced, by their paths in the folder:
/// "walls.vtp", "regions/3.vtp". If empty, the folder must be empty or missing.
using OwnNames = std::function<bool(std::string_view)>;

/// A folder of files, some in subfolders, that appears under its name only when it is whole.
///
/// It is filled under a temporary name beside the target, then renamed. Without commit() it is
/// removed, as AtomicOutput's temporary is.
class AtomicFolder {
public:
    /// Makes the temporary folder. \throws FileError  as check(), or the folder can't be made
    AtomicFolder(const std::filesystem::path& target, const OwnNames& ownNames);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// Throws when the folder can't be made or replaced. Changes nothing. \throws FileError
    static void check(const std::filesystem::path& path, const OwnNames& ownNames);

    const std::filesystem::path& target() const { return target_; }
    /// The temporary name: where the files are until commit().
    const std::filesystem::path& path() const { return temporary_; }

    /// The path to write a file of this name to, which a signal removes. The name may begin with a
    /// subfolder ("regions/3.vtp"), which is made. \throws FileError  it can't be made
    std::filesystem::path place(const std::string& name);

    /// Names and bytes of the files, in the order of their place() calls.
    std::vector<std::pair<std::string, std::uintmax_t>> files() const;

    /// Calls `writer`. A FileError or InvalidInput of it is rethrown with the target's name in
    /// place of the temporary's.
    void fill(const std::function<void()>& writer);

    /// \throws FileError
    void writeText(const std::string& name, const std::string& text);

    /// Renames the folder, then commits `outputs`, which are checked first. Signals wait until that
    /// is done. A folder that is replaced is renamed aside, then removed; it passes on its mode,
    /// and its files theirs to files of the same name. \pre every placed file has been written
    /// \throws FileError
    void commit(std::span<AtomicOutput> outputs = {});

private:
    std::filesystem::path target_, temporary_;
    OwnNames ownNames_;
    std::vector<std::string> names_;
    std::vector<std::shared_ptr<detail::Temporary>> records_;
};

/// Throws when `target` can't become a regular file: its folder is missing or may not be written,
/// or the name is that of a folder, a device or a write-protected file. Changes nothing.
/// \param ownFolder  as AtomicOutput takes it \throws FileError
void checkOutput(const std::filesystem::path& target, const std::filesystem::path& ownFolder = {});

/// Makes a folder and its missing parents.
/// \param ownFolder  the folder above it that the user named, below which links are refused; empty:
///                   the user named `folder`
/// \throws FileError  it can't be made
void makeFolders(const std::filesystem::path& folder, const std::filesystem::path& ownFolder = {});

/// Throws when writing `target` would overwrite `input`. \throws FileError
void checkNotInput(const std::filesystem::path& target, const std::filesystem::path& input);

/// Makes SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGPIPE remove temporary files before they end the
/// program (ignored signals stay ignored), and the process's limit of file size a writing error
/// instead of a signal.
void removeOutputsOnSignals();

namespace detail {

/// The file or empty folder is removed when the result goes, and when a signal ends the program.
/// \param lock  an open file, closed then; -1 for none
std::shared_ptr<Temporary> removedAtEnd(const std::filesystem::path& path, int lock = -1);

/// Removes all temporaries, before the program ends at once. Async-signal-safe.
void removeTemporaries();

/// Removes from `folder` the temporaries (by their exact form of names) of killed processes: those
/// of `process`, those that no process has locked and, where the file system has no locks, those
/// not written to for a day.
void removeLeftTemporaries(const std::filesystem::path& folder, int process);

/// A child process that writes temporaries and so is ended before they are removed; 0 for none.
void endFirst(int process);

/// Postpones signals while it lives. May be nested.
struct SignalsWait {
    SignalsWait();
    ~SignalsWait();
    SignalsWait(const SignalsWait&) = delete;

    /// A signal has come that will end the program when the last of these goes.
    static bool hasCome();
};

/// The folder that holds `path`; "." for a bare name.
std::filesystem::path folderOf(const std::filesystem::path& path);

/// The text of errno.
std::string reason();

}  // namespace detail
}  // namespace adaptiso
