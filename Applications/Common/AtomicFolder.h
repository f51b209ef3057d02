#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "Common/AtomicOutput.h"

namespace adaptiso {

/// A folder of files that appears under its name only when all of it is whole.
///
/// It is filled under a temporary name beside the target, then renamed. What was not committed
/// goes when the object does, and, once removeOutputsOnSignals() has been called, when a signal
/// ends the program.
class AtomicFolder {
public:
    /// Makes the temporary folder.
    /// \param ownNames  the files that a folder already there may hold if it is to be replaced;
    ///                  empty: it must be empty or not be there
    /// \throws FileError  as check(), or the folder can't be made
    AtomicFolder(const std::filesystem::path& target, std::span<const std::string_view> ownNames);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// Throws when the folder can't be made or replaced. Asks, changes nothing. \throws FileError
    static void check(const std::filesystem::path& path,
                      std::span<const std::string_view> ownNames);

    const std::filesystem::path& target() const { return target_; }

    /// Where to write a file of this name, for writers that write several at once: registered, so
    /// that it goes with the folder.
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
    std::filesystem::path target_, temporary_;
    std::vector<std::string> ownNames_;
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<detail::Registration>> registrations_;  ///< the folder's is first
};

}  // namespace adaptiso
