#include "ZarrStore.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "DataFile.h"
#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

ZarrFile::ZarrFile(fs::path path, int descriptor)
    : path_(std::move(path)), descriptor_(new int(descriptor)) {
    struct stat status {};
    if (fstat(descriptor, &status) != 0) {
        refuse(path_, std::string("can't be read: ") + std::strerror(errno), "check the disk");
    }
    if (!S_ISREG(status.st_mode)) refuse(path_, "is not a file", "get the dataset again");
    size_ = static_cast<std::uint64_t>(status.st_size);
    if (size_ == 0) {
        refuse(path_, "is empty, which is no way to leave a chunk out", "get the dataset again");
    }
}

void ZarrFile::CloseFile::operator()(const int* descriptor) const {
    ::close(*descriptor);
    delete descriptor;
}

void ZarrFile::read(std::uint64_t offset, void* out, std::size_t byteCount) const {
    auto* to = static_cast<char*>(out);
    while (byteCount > 0) {
        const ssize_t got = pread(*descriptor_, to, byteCount, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            refuse(path_, std::string("can't be read: ") + std::strerror(errno), "check the disk");
        }
        if (got == 0) refuse(path_, "truncated", "get the whole file");
        to += got;
        offset += static_cast<std::uint64_t>(got);
        byteCount -= static_cast<std::size_t>(got);
    }
}

namespace {

/// A key's file, or a folder on the way to it, is a link.
bool goesByLink(const fs::path& root, const std::string& key) {
    fs::path at = root;
    for (const fs::path& part : fs::path(key)) {
        at /= part;
        std::error_code error;
        if (fs::is_symlink(fs::symlink_status(at, error))) return true;
    }
    return false;
}

}  // namespace

std::optional<ZarrFile> ZarrStore::open(const std::string& key) const {
    const fs::path path = root_ / key;
    int flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK;
    if (goesByLink(root_, key)) {
        std::error_code error;
        const bool isThere = fs::exists(path, error);
        if (!isThere && fs::is_symlink(fs::symlink_status(path, error))) {
            refuseForeignContent(path);
            refuse(path, "the link points to no existing file", "get the file it points to");
        }
        if (isThere) requireInFolder(root_, path);
    } else {
        flags |= O_NOFOLLOW;
    }
    const int file = ::open(path.c_str(), flags);
    if (file < 0 && errno == ENOENT) return std::nullopt;
    if (file < 0) {
        refuse(path, std::string("can't be opened: ") + std::strerror(errno),
               "a chunk that is not there must not be there at all");
    }
    return ZarrFile(path, file);
}

std::optional<std::string> ZarrStore::readText(const std::string& key) const {
    constexpr std::uint64_t kLargest = std::uint64_t{16} << 20;
    const std::optional<ZarrFile> file = open(key);
    if (!file) return std::nullopt;
    if (file->size() > kLargest) {
        refuse(file->path(), "is larger than any metadata that are read here (16 MiB)",
               "check what it is");
    }
    std::string text(static_cast<std::size_t>(file->size()), '\0');
    file->read(0, text.data(), text.size());
    return text;
}

}  // namespace adaptiso::detail
