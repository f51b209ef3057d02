#pragma once

#include <filesystem>
#include <vector>

namespace adaptiso::detail {

/// The mode to make a file or folder with that is to replace `final`: `otherwise`, when nothing is
/// there, else open to its owner alone until keepAttributes() knows better.
unsigned modeToReplace(const std::filesystem::path& final, unsigned otherwise);

/// Gives `temporary` the mode and access control list of `final`, which it is about to replace, and
/// its owner and group where that is permitted; where the group can't be kept, the new one may do
/// no more than all others. Nothing happens when `final` is not there.
void keepAttributes(const std::filesystem::path& final, const std::filesystem::path& temporary);

/// Puts files or folders in place, one after the other, until keep() makes it final. What is not
/// kept is undone when the object goes: the old ones come back, the new ones have their temporary
/// names again. \pre signals wait
class Replacements {
public:
    Replacements() = default;
    ~Replacements();
    Replacements(const Replacements&) = delete;
    Replacements& operator=(const Replacements&) = delete;

    /// Renames `temporary` to `final`. What is there is kept beside it: where the file system can
    /// exchange names it stands there until then, else a file gets a second name (a hard link), and
    /// a folder is renamed first. Where there are no links a file's replacement can't be undone.
    /// \return 0, or errno; then nothing has changed
    int replace(const std::filesystem::path& temporary, const std::filesystem::path& final);

    /// Removes the old ones; of a folder the files that lie in it.
    void keep();

private:
    enum class Kind { New, Exchanged, Aside, Linked, Overwritten };
    struct Done {
        Kind kind;
        std::filesystem::path temporary, final;
        std::filesystem::path old;  ///< where the old one is now; empty: nowhere
    };
    std::vector<Done> done_;
};

}  // namespace adaptiso::detail
