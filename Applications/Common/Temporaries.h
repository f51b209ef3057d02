#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace adaptiso::detail {

/// A temporary file or folder that a signal's handler may have to remove. Records are only ever
/// added to the list, newest first, and one's path is set before it is, so that the handler may
/// walk the list at any moment; the files of a folder come before the folder.
struct Temporary {
    const std::string path;
    const bool isFolder;
    std::atomic<bool> exists{true};
    Temporary* next = nullptr;
};

/// Puts `path` on the list. \return its record, which is kept as long as a signal may come
Temporary& rememberTemporary(const std::filesystem::path& path, bool isFolder);

/// A child process that writes temporaries: it is ended before these are removed. 0: none any more
void endFirst(int process);

/// Removes all temporaries that exist, before the program ends at once. Async-signal-safe.
void removeTemporaries();

/// Removes the file, or the empty folder, when it goes, unless it does not exist any more.
struct Registration {
    /// \param lock  a descriptor to close when it goes; -1: none
    explicit Registration(Temporary& temporary, int lock = -1)
        : temporary_(temporary), lock_(lock) {}
    ~Registration();
    Registration(const Registration&) = delete;
    Registration& operator=(const Registration&) = delete;

    Temporary& temporary_;

private:
    int lock_;
};

/// While one lives, a signal waits: what is done meanwhile is done whole. They may be nested.
class SignalsWait {
public:
    SignalsWait();
    ~SignalsWait();
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;
};

std::filesystem::path folderOf(const std::filesystem::path& path);

/// Text of errno.
std::string reason();

/// Forces what was written to `path` to disk.
/// \throws FileError  naming `target`
void syncToDisk(const std::filesystem::path& path, const std::filesystem::path& target);

/// So that a new name outlives a power failure. Not every file system can; the file is whole.
void syncFolder(const std::filesystem::path& folder);

/// `message` with every mention of `temporary` as `target`.
std::string withTargetsName(std::string message, const std::filesystem::path& temporary,
                            const std::filesystem::path& target);

}  // namespace adaptiso::detail
