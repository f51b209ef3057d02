#pragma once

#include <filesystem>
#include <string>

namespace adaptiso::detail {

/// A temporary file or folder, made under a name that says whose it is, so that a later run can
/// tell what a killed one has left:
/// ".adaptiso-<process>-<its start>-<its PID namespace>-<boot>-<machine>-<n>[k].part<extension>".
/// "k": its maker keeps a lock (flock) on it for as long as it lives.
struct NewTemporary {
    std::filesystem::path path;
    int lock = -1;  ///< descriptor that keeps the lock; -1: the file system has none
};

/// Makes an empty file beside `final`. What ended processes have left in that folder goes first,
/// once for each folder.
/// \param mode  of the file, as open() takes it  \throws FileError  naming `target`
NewTemporary makeTemporaryFile(const std::filesystem::path& final, unsigned mode,
                               const std::filesystem::path& target);

/// The same, a folder.
NewTemporary makeTemporaryFolder(const std::filesystem::path& final, unsigned mode,
                                 const std::filesystem::path& target);

/// A name of the kind above that nothing has yet, without lock.
std::filesystem::path newTemporaryName(const std::filesystem::path& final);

/// Removes a file, or a folder without folders in it; what can't be removed stays.
void removeTemporary(const std::filesystem::path& path);

/// Removes the temporaries in `folder` whose process has surely ended: one of this boot and PID
/// namespace that runs no more; one of another namespace, or of an earlier boot of this machine,
/// whose lock nobody keeps. All others stay, those of other machines among them.
void removeLeftTemporaries(const std::filesystem::path& folder);

}  // namespace adaptiso::detail
