// A zip archive: for each file a header and its data; then the directory, an entry for each file;
// then the record of the end. Zip64 (as lib3mf writes) has 64-bit sizes in an extra field.

#include "Zip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "Bytes.h"
#include "Counts.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kLocalMark = "PK\3\4"sv, kEntryMark = "PK\1\2"sv, kEndMark = "PK\5\6"sv,
                           kEnd64Mark = "PK\6\6"sv;
constexpr std::size_t kEndBytes = 22, kLocator64Bytes = 20;
constexpr std::uint16_t kVersion = 20, kStored = 0, kDeflated = 8, kFirstDay = 0x21;  // of 1980
constexpr std::uint32_t kIn64 = 0xFFFFFFFF;
constexpr std::size_t kZlibHead = 2, kZlibTail = 4;  // around what is deflated

std::uint32_t checksumOf(std::string_view bytes) {
    uLong sum = crc32(0, nullptr, 0);
    while (!bytes.empty()) {
        const std::string_view piece = bytes.substr(0, std::size_t{1} << 30);
        sum = crc32(sum, reinterpret_cast<const Bytef*>(piece.data()),
                    static_cast<uInt>(piece.size()));
        bytes.remove_prefix(piece.size());
    }
    return static_cast<std::uint32_t>(sum);
}

template <class T>
T next(ByteSource& source) {
    return source.number<T>(std::endian::little);
}

void requireMark(ByteSource& source, std::string_view mark) {
    if (source.take(mark.size()) != mark) damaged("its zip archive has no header where one is due");
}

std::string_view at(std::string_view bytes, std::uint64_t position) {
    if (position > bytes.size()) damaged("its zip archive points behind its end");
    return bytes.substr(static_cast<std::size_t>(position));
}

}  // namespace

void writeZip(const std::vector<std::pair<std::string, std::string>>& files, ByteSink& sink) {
    std::string directory;
    std::uint64_t position = 0;
    for (const auto& [name, bytes] : files) {
        const std::string stream = deflated(bytes);
        const auto packed =
            std::string_view(stream).substr(kZlibHead, stream.size() - kZlibHead - kZlibTail);
        if (bytes.size() >= kIn64 || position + packed.size() >= kIn64) {
            throw InvalidInput("the surface is too large for a zip archive of 4 GB; write .ply");
        }
        std::string common;
        for (const std::uint16_t number :
             {kVersion, std::uint16_t{0}, kDeflated, std::uint16_t{0}, kFirstDay}) {
            appendLittleEndian(number, common);
        }
        for (const std::size_t number :
             {std::size_t{checksumOf(bytes)}, packed.size(), bytes.size()}) {
            appendLittleEndian(static_cast<std::uint32_t>(number), common);
        }
        appendLittleEndian(static_cast<std::uint16_t>(name.size()), common);
        appendLittleEndian(std::uint16_t{0}, common);  // no extra fields
        directory.append(kEntryMark);
        appendLittleEndian(kVersion, directory);
        directory.append(common).append(10, '\0');  // no comment, first disk, no attributes
        appendLittleEndian(static_cast<std::uint32_t>(position), directory);
        directory.append(name);
        sink << kLocalMark << common << name << packed;
        position += kLocalMark.size() + common.size() + name.size() + packed.size();
    }
    std::string end(kEndMark);
    end.append(4, '\0');
    for (int twice = 0; twice < 2; ++twice) {
        appendLittleEndian(static_cast<std::uint16_t>(files.size()), end);
    }
    appendLittleEndian(static_cast<std::uint32_t>(directory.size()), end);
    appendLittleEndian(static_cast<std::uint32_t>(position), end);
    sink << directory << end.append(2, '\0');
}

ZipFiles::ZipFiles(std::string_view bytes, std::size_t fileBytes)
    : bytes_(bytes), fileBytes_(fileBytes) {
    const std::size_t end = bytes.rfind(kEndMark);
    if (end == std::string_view::npos || bytes.size() - end < kEndBytes) {
        damaged("its zip archive has no directory at its end");
    }
    ByteSource record(bytes.substr(end + kEndMark.size()));
    record.take(6);
    std::uint64_t count = next<std::uint16_t>(record);
    std::uint64_t size = next<std::uint32_t>(record), begin = next<std::uint32_t>(record);
    const std::size_t comment = next<std::uint16_t>(record);
    record.take(std::min(comment, record.left()));
    behind_ = record.rest();
    std::uint64_t directoryEnd = end;
    if (begin == kIn64 || count == 0xFFFF) {
        ByteSource locator(at(bytes, end - std::min(end, kLocator64Bytes)));
        locator.take(8);
        directoryEnd = next<std::uint64_t>(locator);
        ByteSource record64(at(bytes, directoryEnd));
        requireMark(record64, kEnd64Mark);
        record64.take(28);
        count = next<std::uint64_t>(record64);
        size = next<std::uint64_t>(record64);
        begin = next<std::uint64_t>(record64);
    }
    if (size > directoryEnd) damaged("the directory of its zip archive is longer than the archive");
    if (directoryEnd - size != begin) {
        refuseSecondFile({"files", static_cast<std::int64_t>(count), 1}, "3MF");
    }
    ByteSource directory(
        bytes.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(size)));
    while (!directory.atEnd()) {
        requireMark(directory, kEntryMark);
        directory.take(4);
        Entry entry;
        entry.flags = next<std::uint16_t>(directory);
        entry.method = next<std::uint16_t>(directory);
        directory.take(4);
        entry.checksum = next<std::uint32_t>(directory);
        entry.packedBytes = next<std::uint32_t>(directory);
        entry.bytes = next<std::uint32_t>(directory);
        const std::size_t name = next<std::uint16_t>(directory),
                          extra = next<std::uint16_t>(directory),
                          note = next<std::uint16_t>(directory);
        directory.take(8);
        entry.at = next<std::uint32_t>(directory);
        std::string key = lowerCase(directory.take(name));
        ByteSource fields(directory.take(extra));
        directory.take(note);
        while (fields.left() >= 4) {
            const auto kind = next<std::uint16_t>(fields);
            const std::size_t length = next<std::uint16_t>(fields);
            ByteSource field(fields.take(length));
            if (kind != 1) continue;
            for (std::uint64_t* const number : {&entry.bytes, &entry.packedBytes, &entry.at}) {
                if (*number == kIn64) *number = next<std::uint64_t>(field);
            }
        }
        if (!entries_.emplace(std::move(key), entry).second) {
            malformed("its zip archive holds a file twice");
        }
    }
}

bool ZipFiles::has(const std::string& name) const {
    return entries_.contains(lowerCase(name));
}

std::string ZipFiles::read(const std::string& name) {
    const auto found = entries_.find(lowerCase(name));
    if (found == entries_.end()) malformed("its zip archive has no file " + printable(name));
    const Entry& entry = found->second;
    const bool isEncrypted = (entry.flags & 1) != 0;
    if (isEncrypted || (entry.method != kStored && entry.method != kDeflated)) {
        unsupported(
            printable(name) + " in its zip archive is " +
                (isEncrypted ? "encrypted" : "packed by method " + std::to_string(entry.method)),
            "save it anew, or unpack the archive and pack it by zip");
    }
    ByteSource source(at(bytes_, entry.at));
    requireMark(source, kLocalMark);
    source.take(22);
    const std::size_t nameBytes = next<std::uint16_t>(source), extra = next<std::uint16_t>(source);
    source.take(nameBytes + extra);
    if (entry.packedBytes > source.left()) source.take(source.left() + 1);  // damaged
    const std::string_view packed = source.take(static_cast<std::size_t>(entry.packedBytes));
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max() / 2;
    unpacked_ += std::min(entry.bytes, kMost - unpacked_);
    requirePlausibleSize(fileBytes_, static_cast<std::size_t>(std::min<std::uint64_t>(
                                         unpacked_, std::numeric_limits<std::size_t>::max())));
    if (entry.method == kStored) {
        const bool isWhole = entry.bytes == entry.packedBytes;
        if (!isWhole || checksumOf(packed) != entry.checksum) {
            damaged(printable(name) + " is damaged");
        }
        return std::string(packed);
    }
    // as a gzip file, whose end has the checksum and size
    std::string stream("\x1F\x8B\x08\0\0\0\0\0\0\0"sv);
    stream.append(packed);
    appendLittleEndian(entry.checksum, stream);
    appendLittleEndian(static_cast<std::uint32_t>(entry.bytes), stream);
    return inflated(stream, static_cast<std::size_t>(entry.bytes));
}

}  // namespace adaptiso::meshio
