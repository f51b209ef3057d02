#include "Files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::meshio {

std::string systemReason() {
    return errno != 0 ? std::strerror(errno) : "unknown reason";
}

/// The bytes of a regular file.
std::string readBytes(const std::filesystem::path& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) {
        throw FileError(path.string() + ": no such file; check the name");
    }
    if (!fs::is_regular_file(status)) {
        throw FileError(path.string() + ": not a regular file; give a file on disk");
    }
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    const std::uintmax_t size = fs::file_size(path, error);
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

void writeFile(const std::filesystem::path& path, const std::function<void(ByteSink&)>& write) {
    const auto fail = [&](const char* what) {
        throw FileError(path.string() + ": can't be " + what + " (" + systemReason() + ")");
    };
    errno = 0;
    std::ofstream stream(path, std::ios::binary | std::ios::trunc);
    if (!stream) fail("made");
    ByteSink sink(stream);
    write(sink);
    sink.finish();
    stream.close();
    if (!stream) fail("written");
}

}  // namespace adaptiso::meshio
