#include "MappedFile.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

#include "adaptiso/ImageIO/MappedInput.h"

namespace adaptiso::detail {
namespace {

/// A mapping that lives, where a signal handler finds it without a lock.
struct Slot {
    std::atomic<bool> isTaken{false};
    std::atomic<const std::byte*> begin{nullptr};  ///< set last, cleared first
    std::atomic<const std::byte*> end{nullptr};
    std::array<char, 4096> file{};
};
static_assert(std::atomic<const std::byte*>::is_always_lock_free);

std::array<Slot, 32> slots;

Slot* takeSlot() {
    for (Slot& slot : slots) {
        if (!slot.isTaken.exchange(true)) return &slot;
    }
    return nullptr;
}

bool isLocalDisk(int descriptor) {
    constexpr unsigned long kXfs = 0x58465342, kZfs = 0x2fc12fc1;  // not in linux/magic.h
    struct statfs status {};
    if (::fstatfs(descriptor, &status) != 0) return false;
    switch (static_cast<unsigned long>(status.f_type)) {
        case EXT4_SUPER_MAGIC:
        case BTRFS_SUPER_MAGIC:
        case F2FS_SUPER_MAGIC:
        case TMPFS_MAGIC:
        case OVERLAYFS_SUPER_MAGIC:
        case kXfs:
        case kZfs:
            return true;
        default:
            return false;
    }
}

/// Fails where another process has the file open for writing, or it is another user's. The signal
/// by which the kernel would tell of a writer is one that is ignored by default.
bool holdWritersBack(int descriptor) {
    return ::fcntl(descriptor, F_SETSIG, SIGURG) == 0 &&
           ::fcntl(descriptor, F_SETLEASE, F_RDLCK) == 0;
}

}  // namespace

std::shared_ptr<const void> mapFile(const std::filesystem::path& file, int descriptor,
                                    std::uint64_t offset, std::uint64_t byteCount) {
    if (byteCount < kLeastMappedBytes || !isLocalDisk(descriptor)) return {};
    if (file.native().size() >= Slot().file.size()) return {};
    const int own = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 3);  // a lease ends with its last user
    if (own < 0) return {};
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    const std::uint64_t before = offset % page, wholeBytes = before + byteCount;
    Slot* const slot = holdWritersBack(own) ? takeSlot() : nullptr;
    void* const mapped = slot == nullptr ? MAP_FAILED
                                         : ::mmap(nullptr, wholeBytes, PROT_READ, MAP_PRIVATE, own,
                                                  static_cast<off_t>(offset - before));
    if (mapped == MAP_FAILED) {
        if (slot != nullptr) slot->isTaken = false;
        ::fcntl(own, F_SETLEASE, F_UNLCK);
        ::close(own);
        return {};
    }
    const auto* const begin = static_cast<const std::byte*>(mapped);
    slot->file.fill('\0');
    file.native().copy(slot->file.data(), slot->file.size() - 1);
    slot->end = begin + wholeBytes;
    slot->begin = begin;
    return {begin + before, [=](const void*) {
                slot->begin = nullptr;
                ::munmap(mapped, wholeBytes);
                slot->isTaken = false;
                ::fcntl(own, F_SETLEASE, F_UNLCK);
                ::close(own);
            }};
}

}  // namespace adaptiso::detail

namespace adaptiso {

const char* mappedFileAt(const void* address) noexcept {
    for (const detail::Slot& slot : detail::slots) {
        const std::byte* const begin = slot.begin;
        if (begin != nullptr && begin <= address && address < slot.end) return slot.file.data();
    }
    return nullptr;
}

}  // namespace adaptiso
