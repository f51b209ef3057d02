#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace adaptiso {

namespace detail {
struct Registration;
}

/// A file that appears under its name only when it is whole.
///
/// It is written to a temporary name in the same folder (TemporaryNames.h), forced to disk, then
/// renamed. The temporary goes when the object does without commit(), and, once
/// removeOutputsOnSignals() has been called, when a signal ends the program. A file that is
/// replaced leaves its mode, owner and group to the new one (keepAttributes()).
class AtomicOutput {
public:
    /// Makes the temporary file. A symbolic link as target is followed, so that the link stays.
    /// \throws FileError  as checkOutput(), or the file can't be made
    explicit AtomicOutput(const std::filesystem::path& target);
    ~AtomicOutput();
    AtomicOutput(AtomicOutput&&) noexcept;
    AtomicOutput& operator=(AtomicOutput&&) = delete;

    const std::filesystem::path& target() const { return target_; }
    const std::filesystem::path& temporary() const { return temporary_; }

    /// Calls `writer` with the temporary's name, then forces what it wrote to disk.
    /// \throws FileError  when the disk says no. A FileError or InvalidInput of `writer` comes out
    ///                    with the target's name in place of the temporary's.
    void write(const std::function<void(const std::filesystem::path&)>& writer);

    /// The same for bytes or a text in memory. \throws FileError
    void writeBytes(std::span<const std::byte> bytes);
    void writeText(const std::string& text);

    /// Renames all of `outputs`, or none. Signals wait until that is done.
    /// \pre each has been written \throws FileError when a file can't be renamed
    static void commit(std::span<AtomicOutput> outputs);

private:
    std::filesystem::path target_;
    std::filesystem::path final_;  ///< target_, with a symbolic link resolved
    std::filesystem::path temporary_;
    std::unique_ptr<detail::Registration> registration_;
};

/// Throws when `target` can't become a regular file: its folder is missing or may not be written,
/// or the name is that of a folder, a device or a write-protected file. Asks, changes nothing.
/// \throws FileError
void checkOutput(const std::filesystem::path& target);

/// Makes a folder, and those that it lies in, where they are not there.
/// \throws FileError  it can't be made
void makeFolders(const std::filesystem::path& folder);

/// Throws when writing `target` would overwrite `input`. \throws FileError
void checkNotInput(const std::filesystem::path& target, const std::filesystem::path& input);

/// From now on SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGPIPE remove temporary files before they end
/// the program (those that the caller ignores stay ignored), and a file that grows beyond the
/// process's limit is an error of writing, not a signal.
void removeOutputsOnSignals();

}  // namespace adaptiso
