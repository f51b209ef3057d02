#include "Common/AtomicFolder.h"

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

}  // namespace

void AtomicFolder::check(const fs::path& path, std::span<const std::string_view> ownNames) {
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
    for (const auto& entry : fs::directory_iterator(target)) {
        const std::string name = entry.path().filename().string();
        const bool isOwn = std::find(ownNames.begin(), ownNames.end(), name) != ownNames.end() &&
                           entry.is_regular_file(error) && !entry.is_symlink(error);
        if (isOwn) continue;
        throw FileError(target.string() +
                        (ownNames.empty() ? ": exists and is not empty; nothing is replaced unless "
                                            "asked for"
                                          : ": holds " + name +
                                                ", which is not of a model; it is not replaced"));
    }
}

AtomicFolder::AtomicFolder(const fs::path& target, std::span<const std::string_view> ownNames)
    : target_(withoutSlash(target)), ownNames_(ownNames.begin(), ownNames.end()) {
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

void AtomicFolder::commit(std::span<AtomicOutput> outputs) {
    for (const std::string& name : names_) {
        keepAttributes(target_ / name, temporary_ / name);
        syncToDisk(temporary_ / name, target_ / name);
    }
    syncFolder(temporary_);
    const SignalsWait untilAllAreInPlace;
    const std::vector<std::string_view> own(ownNames_.begin(), ownNames_.end());
    check(target_, own);  // again: it took a while
    Replacements replacements;
    if (const int why = replacements.replace(temporary_, target_); why != 0) {
        throw FileError(target_.string() + ": can't be put in place: " + std::strerror(why));
    }
    AtomicOutput::commit(outputs);
    for (const auto& registration : registrations_) registration->temporary_.exists.store(false);
    replacements.keep();
}

}  // namespace adaptiso
