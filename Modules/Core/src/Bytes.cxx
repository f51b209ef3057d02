#include "adaptiso/Core/Bytes.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

std::string systemReason() {
    return errno != 0 ? std::strerror(errno) : "unknown reason";
}

ByteSink& ByteSink::operator<<(std::int64_t number) {
    char text[24];
    const auto end = std::to_chars(text, text + sizeof(text), number).ptr;
    return *this << std::string_view(text, static_cast<std::size_t>(end - text));
}

ByteSink& ByteSink::operator<<(double number) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof(text), number + 0.0,  // + 0.0: no "-0"
                                   std::chars_format::general, 9)
                         .ptr;
    return *this << std::string_view(text, static_cast<std::size_t>(end - text));
}

std::string shortestText(double number) {
    std::array<char, 64> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr};
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

void writeText(const std::filesystem::path& path, std::string_view text) {
    writeBytes(path, [text](ByteSink& sink) { sink << text; });
}

}  // namespace adaptiso
