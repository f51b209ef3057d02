#include "Common/AtomicOutput.h"

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <utility>

#include "Common/FileReplacement.h"
#include "Common/Temporaries.h"
#include "Common/TemporaryNames.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

using namespace detail;

namespace {

namespace fs = std::filesystem;

/// Where the file really goes: symbolic links are followed, also to a file that is not there yet.
fs::path resolved(const fs::path& target) {
    constexpr int kMaxLinks = 40;  // as many as Linux follows
    fs::path file = target;
    std::error_code error;
    for (int n = 0; n < kMaxLinks && fs::is_symlink(file, error); ++n) {
        file = folderOf(file) / fs::read_symlink(file);  // an absolute link replaces the folder
    }
    return file;
}

}  // namespace

void makeFolders(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        throw FileError(folder.string() + ": the folder can't be made (" + error.message() +
                        "); choose another");
    }
}

void checkOutput(const fs::path& target) {
    const fs::path file = resolved(target);
    const fs::path folder = folderOf(file);
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw FileError(target.string() + ": there is no folder " + folder.string());
    }
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        throw FileError(target.string() + ": the folder can't be written: " + reason());
    }
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) return;
    if (!fs::is_regular_file(status)) {
        throw FileError(target.string() + ": exists and is not a regular file");
    }
    if (access(file.c_str(), W_OK) != 0) {
        throw FileError(target.string() + ": exists and is write-protected");
    }
}

void checkNotInput(const fs::path& target, const fs::path& input) {
    std::error_code error;
    if (fs::equivalent(target, input, error)) {
        throw FileError(target.string() + ": is the input, which is never overwritten");
    }
}

AtomicOutput::AtomicOutput(const fs::path& target) : target_(target), final_(resolved(target)) {
    checkOutput(target);
    const SignalsWait untilItIsRemembered;
    const NewTemporary made = makeTemporaryFile(final_, modeToReplace(final_, 0666), target_);
    temporary_ = made.path;
    registration_ = std::make_unique<Registration>(rememberTemporary(temporary_, false), made.lock);
}

AtomicOutput::~AtomicOutput() = default;
AtomicOutput::AtomicOutput(AtomicOutput&&) noexcept = default;

void AtomicOutput::write(const std::function<void(const fs::path&)>& writer) {
    try {
        writer(temporary_);
    } catch (const FileError& error) {
        throw FileError(withTargetsName(error.what(), temporary_, target_));
    } catch (const InvalidInput& error) {
        throw InvalidInput(withTargetsName(error.what(), temporary_, target_));
    }
    syncToDisk(temporary_, target_);
}

void AtomicOutput::writeText(const std::string& text) {
    writeBytes(std::as_bytes(std::span(text)));
}

void AtomicOutput::writeBytes(std::span<const std::byte> bytes) {
    write([&](const fs::path& path) {
        std::ofstream file(path, std::ios::binary | std::ios::trunc);
        file.write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) throw FileError(path.string() + ": can't be written: " + reason());
    });
}

void AtomicOutput::commit(std::span<AtomicOutput> outputs) {
    const SignalsWait untilAllAreInPlace;
    for (const AtomicOutput& output : outputs) checkOutput(output.target_);  // it took a while
    Replacements replacements;
    for (const AtomicOutput& output : outputs) {
        if (const int why = replacements.replace(output.temporary_, output.final_); why != 0) {
            throw FileError(output.target_.string() +
                            ": can't be put in place: " + std::strerror(why));
        }
    }
    for (const AtomicOutput& output : outputs) {
        output.registration_->temporary_.exists.store(false);
    }
    replacements.keep();
}

}  // namespace adaptiso
