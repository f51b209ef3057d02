#include "FileFault.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/Shortage.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f) {
            out += fmt::format("\\x{:02x}", byte);
        } else {
            out += c;
        }
    }
    return out;
}

std::string_view kindOf(fs::file_type type) {
    switch (type) {
        case fs::file_type::fifo:
            return "a named pipe";
        case fs::file_type::socket:
            return "a socket";
        case fs::file_type::block:
        case fs::file_type::character:
            return "a device";
        case fs::file_type::directory:
            return "a folder";
        default:
            return "not a file";
    }
}

}  // namespace

std::string printable(std::string_view text) {
    constexpr std::size_t kLongest = 80;
    return escaped(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "");
}

std::string displayName(const fs::path& path) {
    return escaped(path.native());
}

std::string number(double value) {
    return fmt::format("{:.7g}", value);
}

namespace {

std::string lineOf(const fs::path& file, std::string_view fault, std::string_view remedy) {
    return fmt::format("{}: {}; {}", displayName(file), fault, remedy);
}

}  // namespace

void refuse(const fs::path& file, std::string_view fault, std::string_view remedy) {
    throw FileError(lineOf(file, fault, remedy));
}

void refuseChoice(const fs::path& file, std::string_view fault, std::string_view remedy,
                  ChoiceNeeded::Among among, std::int64_t count) {
    throw ChoiceNeeded(lineOf(file, fault, remedy), among, count);
}

void refuseShort(const fs::path& file, std::string_view fault, std::string_view remedy) {
    throw Shortage(lineOf(file, fault, remedy));
}

void refuseForeignContent(const fs::path& file) {
    const auto foreign = findForeignContent(file);
    if (!foreign) return;
    const bool isElsewhere = foreign->kind == ForeignKind::StandIn;
    refuse(file, foreign->fault + (isElsewhere ? "" : ", not a format that is read here"),
           foreign->remedy);
}

std::uint64_t requireRegularFile(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (status.type() == fs::file_type::not_found) {
        refuseForeignContent(file);  // a link of git-annex
        const bool isLink = fs::is_symlink(fs::symlink_status(file, error));
        refuse(file, isLink ? "the link points to no existing file" : "no such file",
               "check the path");
    }
    if (error) refuse(file, "can't be looked at: " + error.message(), "check the path");
    if (!fs::is_regular_file(status)) {
        refuse(file, fmt::format("is {}, not a regular file", kindOf(status.type())),
               "give an image file or a DICOM folder");
    }
    if (::access(file.c_str(), R_OK) != 0) {
        refuse(file, std::string("can't be opened: ") + std::strerror(errno),
               "check its permissions");
    }
    const std::uintmax_t size = fs::file_size(file, error);
    if (error) refuse(file, "can't be looked at: " + error.message(), "check the path");
    return size;
}

}  // namespace adaptiso::detail
