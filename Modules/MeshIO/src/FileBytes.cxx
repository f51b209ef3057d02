#include "FileBytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"

namespace adaptiso::meshio {
namespace {

std::string systemReason() {
    return errno != 0 ? std::strerror(errno) : "unknown reason";
}

}  // namespace

std::string readBytes(const std::filesystem::path& path, std::uint64_t most) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) {
        if (const auto foreign = findForeignContent(path)) {  // a link of git-annex
            throw FileError(path.string() + ": " + foreign->fault + "; " + foreign->remedy);
        }
        throw FileError(path.string() + ": no such file; check the name");
    }
    if (!fs::is_regular_file(status)) {
        throw FileError(path.string() + ": not a regular file; give a file on disk");
    }
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    const std::uintmax_t size = std::min<std::uintmax_t>(most, fs::file_size(path, error));
    if (!stream || error) {
        throw FileError(path.string() + ": can't be opened (" + systemReason() +
                        "); check its permissions");
    }
    std::string bytes(size, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
        throw FileError(path.string() + ": only " + std::to_string(stream.gcount()) + " of " +
                        std::to_string(size) + " bytes can be read; check the disk");
    }
    return bytes;
}

void writeBytes(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write) {
    errno = 0;
    std::ofstream stream(path, std::ios::binary | std::ios::trunc);
    if (!stream) {
        throw FileError(path.string() + ": can't be made (" + systemReason() +
                        "); check that the folder exists and may be written to");
    }
    ByteSink sink(stream);
    write(sink);
    sink.finish();
    stream.close();
    if (!stream) {
        throw FileError(path.string() + ": can't be written (" + systemReason() +
                        "); free space on the disk or write elsewhere");
    }
}

}  // namespace adaptiso::meshio
