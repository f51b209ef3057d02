#include "Bytes.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::meshio {

namespace {

constexpr bool isSpace(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f';
}

bool spells(std::string_view word, std::int64_t& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && stop == word.data() + word.size();
}

/// Whole numbers may be written as reals ("3.0", "1e2").
bool spellsInteger(std::string_view word, std::int64_t& value) {
    if (spells(word, value)) return true;
    constexpr double kExact = 9007199254740992;  // 2^53
    const std::optional<double> real = parseReal(word);
    if (!real || !(std::abs(*real) <= kExact) || *real != std::floor(*real)) return false;
    value = static_cast<std::int64_t>(*real);
    return true;
}

[[noreturn]] void refuseWord(std::string_view word, std::string_view what, std::string_view kind) {
    const std::string met = std::string(what) + " is " + printable(word);
    if (word.find(',') != std::string_view::npos) {
        unsupported(met + ", with a comma",
                    "save it with decimal points and blanks between numbers");
    }
    malformed(met + ", must be " + std::string(kind));
}

}  // namespace

void damaged(const std::string& what) {
    throw FileError(what + "; the file is cut off or damaged: get it again");
}

void malformed(const std::string& what) {
    unsupported(what,
                "the file is damaged or of a dialect that is not read: save it again, e.g. with "
                "MeshLab or ParaView");
}

void unsupported(const std::string& what, const std::string& advice) {
    throw FileError(what + "; " + advice);
}

void requireRoom(std::string_view what, std::int64_t count, std::int64_t bytesEach,
                 std::size_t bytesLeft) {
    if (count < 0 || static_cast<std::uint64_t>(count) > bytesLeft / bytesEach) {
        damaged("it says it holds " + std::to_string(count) + " " + std::string(what) +
                ", but only " + std::to_string(bytesLeft) + " bytes are left for them");
    }
}

std::string_view ByteSource::take(std::size_t count) {
    if (count > left()) {
        damaged("it ends after " + std::to_string(bytes_.size()) + " bytes, where " +
                std::to_string(count - left()) + " more are due");
    }
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
}

std::string_view ByteSource::line() {
    return takeLine(bytes_, position_);
}

std::string_view ByteSource::word() {
    while (position_ < bytes_.size() && isSpace(bytes_[position_])) ++position_;
    const std::size_t begin = position_;
    while (position_ < bytes_.size() && !isSpace(bytes_[position_])) ++position_;
    return bytes_.substr(begin, position_ - begin);
}

std::string_view ByteSource::requireWord(std::string_view what) {
    const std::string_view found = word();
    if (found.empty()) damaged("it ends where " + std::string(what) + " is due");
    return found;
}

std::int64_t ByteSource::integerWord(std::string_view what) {
    return toInteger(requireWord(what), what);
}

double ByteSource::realWord(std::string_view what) {
    return toReal(requireWord(what), what);
}

std::size_t findComment(std::string_view line) {
    std::size_t at = line.find('#');
    while (at != std::string_view::npos && at > 0 && !isSpace(line[at - 1])) {
        at = line.find('#', at + 1);
    }
    return at;
}

std::int64_t toInteger(std::string_view word, std::string_view what) {
    std::int64_t value = 0;
    if (!spellsInteger(word, value)) refuseWord(word, what, "a whole number");
    return value;
}

double toReal(std::string_view word, std::string_view what) {
    const std::optional<double> value = parseReal(word);
    if (!value) refuseWord(word, what, "a number");
    return *value;
}

float toFloat(double value, std::string_view what) {
    if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) {
        unsupported(
            std::string(what) + " is " + formatShort(value) + ", too large for single precision",
            "repair the mesh");
    }
    return static_cast<float>(value);
}

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

}  // namespace adaptiso::meshio
