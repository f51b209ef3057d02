#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "Common/AtomicOutput.h"

namespace adaptiso {

/// Which files a folder already there may hold if it is to be replaced.
class OwnNames {
public:
    OwnNames() = default;  ///< none: the folder must be empty or not be there
    template <std::size_t N>
    OwnNames(const std::array<std::string_view, N>& names)
        : OwnNames(std::vector<std::string_view>(names.begin(), names.end())) {}
    OwnNames(std::vector<std::string_view> names);
    /// \param isOwn  asked of each file's path in the folder: "walls.vtp", "regions/3.vtp"
    explicit OwnNames(std::function<bool(std::string_view)> isOwn) : isOwn_(std::move(isOwn)) {}

    bool areNone() const { return !isOwn_; }
    bool contain(std::string_view name) const { return isOwn_ && isOwn_(name); }

private:
    std::function<bool(std::string_view)> isOwn_;
};

/// A folder of files, some in folders in it, that appears under its name only when all of it is
/// whole.
///
/// It is filled under a temporary name beside the target, then renamed. What was not committed
/// goes when the object does, and, once removeOutputsOnSignals() has been called, when a signal
/// ends the program.
class AtomicFolder {
public:
    /// Makes the temporary folder. \throws FileError  as check(), or the folder can't be made
    AtomicFolder(const std::filesystem::path& target, const OwnNames& ownNames);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// Throws when the folder can't be made or replaced. Asks, changes nothing. \throws FileError
    static void check(const std::filesystem::path& path, const OwnNames& ownNames);

    const std::filesystem::path& target() const { return target_; }

    /// Where to write a file of this name, for writers that write several at once: registered, so
    /// that it goes with the folder. The name may begin with that of one folder ("regions/3.vtp"),
    /// which is made. \throws FileError  it can't be made
    std::filesystem::path place(const std::string& name);

    /// The temporary name: where the files are until commit().
    const std::filesystem::path& path() const { return temporary_; }

    /// Names and bytes of the files, in the order in which they got their places.
    std::vector<std::pair<std::string, std::uintmax_t>> files() const;

    /// Calls `writer` with the folder's temporary name. A FileError or InvalidInput of it comes
    /// out with the target's name instead.
    void fill(const std::function<void()>& writer);

    /// \throws FileError
    void writeText(const std::string& name, const std::string& text);

    /// Renames the folder, and `outputs` after it. Signals wait until that is done. When one can't
    /// be renamed, all is changed back. A folder that is replaced leaves its mode to the new one,
    /// files of the same name theirs, as AtomicOutput does.
    /// \pre every file that got a place has been written  \throws FileError
    void commit(std::span<AtomicOutput> outputs = {});

private:
    void forceToDisk() const;

    std::filesystem::path target_, temporary_;
    OwnNames ownNames_;
    std::vector<std::string> folders_;  ///< in it
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<detail::Registration>> registrations_;  ///< folders before files
};

}  // namespace adaptiso
