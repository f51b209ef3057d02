#include "ZarrStore.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "FileFault.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"

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
        if (isThere) requireIn(path, root_);
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

namespace fs = std::filesystem;

std::optional<ZarrJson> readZarrJson(const ZarrStore& store, const std::string& key) {
    const std::optional<std::string> text = store.readText(key);
    if (!text) return std::nullopt;
    // writers of Python put NaN into fill_value as a bare word, which JSON has not
    ZarrJson json = parseJson<ZarrJson>(*text);
    if (json.is_discarded() || !json.is_object()) {
        refuse(store.root() / key, "is damaged: it is no JSON object, or has a key twice",
               "get the dataset again");
    }
    return json;
}

const ZarrJson& memberOf(const ZarrJson& object, const char* key) {
    static const ZarrJson kNone;
    if (!object.is_object()) return kNone;
    const auto found = object.find(key);
    return found == object.end() ? kNone : *found;
}

std::string shownJson(const ZarrJson& value) {
    if (value.is_array()) return "[...]";
    if (value.is_object()) return "{...}";
    return printable(value.dump(-1, ' ', true, ZarrJson::error_handler_t::replace));
}

std::string textOf(const fs::path& file, const ZarrJson& object, const char* key) {
    const ZarrJson& value = memberOf(object, key);
    if (!value.is_string()) {
        refuse(file, fmt::format("its metadata are damaged: no {}", key), "repair them");
    }
    return value.get<std::string>();
}

std::vector<std::uint64_t> numbersOf(const fs::path& file, const ZarrJson& object, const char* key,
                                     std::uint64_t least) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 48;
    const ZarrJson& list = memberOf(object, key);
    std::vector<std::uint64_t> numbers;
    if (list.is_array()) {
        for (const ZarrJson& value : list) {
            if (!value.is_number_unsigned()) break;
            numbers.push_back(value.get<std::uint64_t>());
            if (numbers.back() < least || numbers.back() > kMost) numbers.clear();
            if (numbers.empty()) break;
        }
    }
    if (numbers.empty() || numbers.size() != list.size()) {
        refuse(file,
               fmt::format("its metadata are damaged: {} is no list of whole numbers from {} on",
                           key, least),
               "repair them");
    }
    return numbers;
}

}  // namespace adaptiso::detail
