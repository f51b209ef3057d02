#include "Common/AtomicFolder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "Common/FileReplacement.h"
#include "Common/Temporaries.h"
#include "Common/TemporaryNames.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

using namespace detail;
namespace fs = std::filesystem;

namespace {

/// "model" of "model/", so that temporaries lie beside it.
fs::path withoutSlash(const fs::path& path) {
    return path.has_filename() || !path.has_parent_path() ? path : path.parent_path();
}

/// A name in `folder` that is none of `ownNames`; empty: there is none.
std::string foreignName(const fs::path& folder, const OwnNames& ownNames) {
    const auto isOwn = [&](const fs::directory_entry& entry, const std::string& name) {
        std::error_code error;
        return ownNames.contain(name) && entry.is_regular_file(error) && !entry.is_symlink(error);
    };
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        std::error_code error;
        const bool isFolder = entry.is_directory(error) && !entry.is_symlink(error);
        if (!isFolder && !isOwn(entry, name)) return name;
        if (!isFolder) continue;
        bool isEmpty = true;
        for (const auto& inner : fs::directory_iterator(entry.path())) {
            const std::string innerName = name + "/" + inner.path().filename().string();
            if (!isOwn(inner, innerName)) return innerName;
            isEmpty = false;
        }
        if (isEmpty) return name;
    }
    return {};
}

}  // namespace

OwnNames::OwnNames(std::vector<std::string_view> names) {
    if (names.empty()) return;
    isOwn_ = [names = std::vector<std::string>(names.begin(), names.end())](std::string_view name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
}

void AtomicFolder::check(const fs::path& path, const OwnNames& ownNames) {
    const fs::path target = withoutSlash(path);
    const fs::path parent = folderOf(target);
    std::error_code error;
    if (!fs::is_directory(parent, error)) {
        throw FileError(target.string() + ": there is no folder " + parent.string());
    }
    if (access(parent.c_str(), W_OK | X_OK) != 0) {
        throw FileError(target.string() + ": can't be made: " + reason());
    }
    const fs::file_status status = fs::symlink_status(target, error);
    if (!fs::exists(status)) return;
    if (!fs::is_directory(status)) throw FileError(target.string() + ": exists and is no folder");
    const std::string other = foreignName(target, ownNames);
    if (other.empty()) return;
    throw FileError(
        target.string() +
        (ownNames.areNone()
             ? ": exists and is not empty; nothing is replaced unless asked for"
             : ": holds " + other + ", which this program does not write; it is not replaced"));
}

AtomicFolder::AtomicFolder(const fs::path& target, const OwnNames& ownNames)
    : target_(withoutSlash(target)), ownNames_(ownNames) {
    check(target_, ownNames);
    const SignalsWait untilItIsRemembered;
    const NewTemporary made = makeTemporaryFolder(target_, modeToReplace(target_, 0777), target_);
    temporary_ = made.path;
    registrations_.push_back(
        std::make_unique<Registration>(rememberTemporary(temporary_, true), made.lock));
}

AtomicFolder::~AtomicFolder() {
    while (!registrations_.empty()) registrations_.pop_back();  // files first, then the folder
}

fs::path AtomicFolder::place(const std::string& name) {
    fs::path path = temporary_ / name;
    const std::string folder = fs::path(name).parent_path().string();
    if (!folder.empty() && std::find(folders_.begin(), folders_.end(), folder) == folders_.end()) {
        const SignalsWait untilItIsRemembered;
        std::error_code error;
        fs::create_directory(temporary_ / folder, error);
        if (error) {
            throw FileError((target_ / folder).string() + ": can't be made: " + error.message());
        }
        folders_.push_back(folder);
        registrations_.push_back(
            std::make_unique<Registration>(rememberTemporary(temporary_ / folder, true)));
    }
    names_.push_back(name);
    registrations_.push_back(std::make_unique<Registration>(rememberTemporary(path, false)));
    return path;
}

std::vector<std::pair<std::string, std::uintmax_t>> AtomicFolder::files() const {
    std::vector<std::pair<std::string, std::uintmax_t>> result;
    for (const std::string& name : names_) {
        std::error_code error;
        result.emplace_back(name, fs::file_size(temporary_ / name, error));
    }
    return result;
}

void AtomicFolder::fill(const std::function<void()>& writer) {
    try {
        writer();
    } catch (const FileError& error) {
        throw FileError(withTargetsName(error.what(), temporary_, target_));
    } catch (const InvalidInput& error) {
        throw InvalidInput(withTargetsName(error.what(), temporary_, target_));
    }
}

void AtomicFolder::writeText(const std::string& name, const std::string& text) {
    const fs::path path = place(name);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) throw FileError((target_ / name).string() + ": can't be written: " + reason());
}

/// One after the other; thousands at once, as each on its own costs a turn of the disk.
void AtomicFolder::forceToDisk() const {
    constexpr std::size_t kMany = 64;
    if (names_.size() <= kMany) {
        for (const std::string& name : names_) syncToDisk(temporary_ / name, target_ / name);
        return;
    }
    const int folder = open(temporary_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool isSynced = folder >= 0 && syncfs(folder) == 0;
    const std::string why = isSynced ? "" : reason();
    if (folder >= 0) close(folder);
    if (!isSynced) throw FileError(target_.string() + ": can't be written: " + why);
}

void AtomicFolder::commit(std::span<AtomicOutput> outputs) {
    for (const std::string& name : names_) keepAttributes(target_ / name, temporary_ / name);
    forceToDisk();
    for (const std::string& folder : folders_) syncFolder(temporary_ / folder);
    syncFolder(temporary_);
    const SignalsWait untilAllAreInPlace;
    check(target_, ownNames_);  // again: it took a while
    Replacements replacements;
    if (const int why = replacements.replace(temporary_, target_); why != 0) {
        throw FileError(target_.string() + ": can't be put in place: " + std::strerror(why));
    }
    AtomicOutput::commit(outputs);
    for (const auto& registration : registrations_) registration->temporary_.exists.store(false);
    replacements.keep();
}

}  // namespace adaptiso
