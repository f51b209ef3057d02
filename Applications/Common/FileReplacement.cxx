#include "Common/FileReplacement.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "Common/Temporaries.h"
#include "Common/TemporaryNames.h"

namespace adaptiso::detail {
namespace {

namespace fs = std::filesystem;

/// As the kernel stores it; what a file has none of can't be read.
void copyAccessList(const fs::path& from, const fs::path& to) {
    constexpr const char* kName = "system.posix_acl_access";
    constexpr std::size_t kLongest = 65536;
    std::vector<char> list(kLongest);
    const ssize_t size = getxattr(from.c_str(), kName, list.data(), list.size());
    if (size > 0) setxattr(to.c_str(), kName, list.data(), static_cast<std::size_t>(size), 0);
}

bool exchange(const fs::path& a, const fs::path& b) {
    return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

}  // namespace

unsigned modeToReplace(const fs::path& final, unsigned otherwise) {
    struct stat old {};
    return stat(final.c_str(), &old) == 0 ? otherwise & 0700U : otherwise;
}

void keepAttributes(const fs::path& final, const fs::path& temporary) {
    struct stat old {
    }, made{};
    if (stat(final.c_str(), &old) != 0) return;
    constexpr auto kSame = static_cast<uid_t>(-1);
    const bool keepsOwner = chown(temporary.c_str(), old.st_uid, kSame) == 0;
    (void)!chown(temporary.c_str(), kSame, old.st_gid);  // asked for below
    if (stat(temporary.c_str(), &made) != 0) return;
    const bool keepsGroup = made.st_gid == old.st_gid;
    mode_t mode = old.st_mode & 07777U;
    if (!keepsOwner || !keepsGroup) mode &= 0777U;
    if (!keepsGroup) mode &= 0707U | ((mode & 07U) << 3U);
    if (chmod(temporary.c_str(), mode) == 0 && keepsGroup) copyAccessList(final, temporary);
}

Replacements::~Replacements() {
    for (auto done = done_.rbegin(); done != done_.rend(); ++done) {
        switch (done->kind) {
            case Kind::New:
                std::rename(done->final.c_str(), done->temporary.c_str());
                break;
            case Kind::Exchanged:
                exchange(done->temporary, done->final);
                break;
            case Kind::Aside:
            case Kind::Linked:
                // the new one gets its name back first; then the old one's two names are one again
                std::rename(done->final.c_str(), done->temporary.c_str());
                std::rename(done->old.c_str(), done->final.c_str());
                break;
            case Kind::Overwritten:
                break;
        }
        syncFolder(folderOf(done->final));
    }
}

int Replacements::replace(const fs::path& temporary, const fs::path& final) {
    struct stat old {};
    if (lstat(final.c_str(), &old) != 0) {
        if (std::rename(temporary.c_str(), final.c_str()) != 0) return errno;
        done_.push_back({Kind::New, temporary, final, {}});
        return 0;
    }
    keepAttributes(final, temporary);
    if (exchange(temporary, final)) {
        done_.push_back({Kind::Exchanged, temporary, final, temporary});
        return 0;
    }
    if (errno == ENOENT) {
        // gone since: nothing is replaced
        if (std::rename(temporary.c_str(), final.c_str()) != 0) return errno;
        done_.push_back({Kind::New, temporary, final, {}});
        return 0;
    }
    const fs::path kept = newTemporaryName(final);
    if (S_ISDIR(old.st_mode)) {
        // for a moment there is neither; a file system without exchange (NFS, 9p, FUSE) has no more
        if (std::rename(final.c_str(), kept.c_str()) != 0) return errno;
        if (std::rename(temporary.c_str(), final.c_str()) != 0) {
            const int why = errno;
            std::rename(kept.c_str(), final.c_str());
            return why;
        }
        done_.push_back({Kind::Aside, temporary, final, kept});
        return 0;
    }
    const bool isLinked = link(final.c_str(), kept.c_str()) == 0;
    if (std::rename(temporary.c_str(), final.c_str()) != 0) {
        const int why = errno;
        if (isLinked) unlink(kept.c_str());
        return why;
    }
    done_.push_back({isLinked ? Kind::Linked : Kind::Overwritten, temporary, final,
                     isLinked ? kept : fs::path()});
    return 0;
}

void Replacements::keep() {
    for (const Done& done : done_) {
        if (!done.old.empty()) removeTemporary(done.old);
        syncFolder(folderOf(done.final));
    }
    done_.clear();
}

}  // namespace adaptiso::detail
