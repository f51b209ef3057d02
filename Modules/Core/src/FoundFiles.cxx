#include "adaptiso/Core/FoundFiles.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& file, const std::string& fault) {
    throw FileError(file.string() + ": " + fault);
}

/// Both without links and dots.
bool isBelow(const fs::path& file, const fs::path& folder) {
    const auto [inFolder, inFile] =
        std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return inFolder == folder.end() && inFile != file.end();
}

/// Empty where it can't be resolved.
fs::path resolved(const fs::path& path) {
    std::error_code error;
    fs::path real = fs::canonical(path.empty() ? fs::path(".") : path, error);
    return error ? fs::path() : real;
}

bool isInAnnexAbove(const fs::path& file, const fs::path& folder) {
    for (fs::path above = folder; above.has_relative_path(); above = above.parent_path()) {
        const fs::path objects = resolved(above / ".git" / "annex" / "objects");
        if (!objects.empty() && isBelow(file, objects)) return true;
    }
    return false;
}

/// A file that does not lie where it should: missing ones are no fault.
void refuseLink(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(file, error))) return;
    refuse(file, fs::exists(file, error)
                     ? "is, or lies behind, a link to outside of its folder; put the file itself "
                       "there"
                     : "the link points to no existing file");
}

bool isLink(const fs::path& path) {
    std::error_code error;
    return fs::is_symlink(fs::symlink_status(path, error));
}

std::string contentOf(const fs::path& file, int descriptor, std::uint64_t most) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) {
        refuse(file, std::string("can't be read: ") + std::strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) refuse(file, "is no regular file; remove it");
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > most) {
        refuse(file, "has " + std::to_string(size) + " bytes, more than any such file (" +
                         std::to_string(most) + ")");
    }
    std::string text(static_cast<std::size_t>(size), '\0');
    std::size_t done = 0;
    while (done < text.size()) {
        const ssize_t got = ::read(descriptor, text.data() + done, text.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) refuse(file, std::string("can't be read: ") + std::strerror(errno));
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    text.resize(done);
    return text;
}

}  // namespace

bool liesIn(const fs::path& file, const fs::path& folder) {
    const fs::path real = resolved(file), in = resolved(folder);
    return !real.empty() && !in.empty() && (isBelow(real, in) || isInAnnexAbove(real, in));
}

bool liesBeside(const fs::path& file, const fs::path& named) {
    const fs::path target = resolved(named);
    return liesIn(file, named.parent_path()) ||
           (!target.empty() && liesIn(file, target.parent_path()));
}

void requireIn(const fs::path& file, const fs::path& folder) {
    if (!liesIn(file, folder)) refuseLink(file);
}

void requireBeside(const fs::path& file, const fs::path& named) {
    if (!liesBeside(file, named)) refuseLink(file);
}

void requireNoLink(const fs::path& file, const fs::path& folder) {
    fs::path at = fs::absolute(folder.empty() ? fs::path(".") : folder).lexically_normal();
    const fs::path whole = fs::absolute(file).lexically_normal();
    fs::path inFolder = whole.lexically_relative(at);
    if (!staysBelow(inFolder)) {
        at = whole.parent_path();
        inFolder = whole.filename();
    }
    for (const fs::path& part : inFolder) {
        at /= part;
        if (!isLink(at)) continue;
        refuse(file, (at == whole ? "is a link" : "lies behind the link " + at.string()) +
                         ", and links are followed only where the command line names them; remove "
                         "it");
    }
}

bool staysBelow(const fs::path& path) {
    return !path.empty() && path.is_relative() &&
           std::ranges::find(path, fs::path("..")) == path.end() &&
           path.native().find('\0') == std::string::npos;
}

std::optional<std::string> readSmallFile(const fs::path& file, std::uint64_t most) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0 && (errno == ENOENT || errno == ENOTDIR)) return std::nullopt;
    if (descriptor < 0) refuse(file, std::string("can't be opened: ") + std::strerror(errno));
    try {
        std::string text = contentOf(file, descriptor, most);
        ::close(descriptor);
        return text;
    } catch (...) {
        ::close(descriptor);
        throw;
    }
}

std::optional<std::string> readFoundFile(const fs::path& file, const fs::path& folder,
                                         std::uint64_t most) {
    requireIn(file, folder);
    return readSmallFile(file, most);
}

}  // namespace adaptiso
