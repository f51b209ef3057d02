#include "Png.h"

#include <zlib.h>

#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using Bytes = std::vector<std::uint8_t>;

void addNumber(Bytes& bytes, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) {
        bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}

/// Length, type, content and CRC (RFC 2083, section 3.2).
void addChunk(std::string& file, const std::string& type, const Bytes& content) {
    Bytes length;
    addNumber(length, static_cast<std::uint32_t>(content.size()));
    Bytes chunk(type.begin(), type.end());
    chunk.insert(chunk.end(), content.begin(), content.end());
    const uLong crc = crc32(0, chunk.data(), static_cast<uInt>(chunk.size()));
    addNumber(chunk, static_cast<std::uint32_t>(crc));
    file.append(length.begin(), length.end());
    file.append(chunk.begin(), chunk.end());
}

Bytes packed(const Bytes& bytes) {
    constexpr int kLevel = 3;
    uLongf size = compressBound(bytes.size());
    Bytes result(size);
    if (compress2(result.data(), &size, bytes.data(), bytes.size(), kLevel) != Z_OK) {
        throw InternalError("pngOf: zlib fails");
    }
    result.resize(size);
    return result;
}

}  // namespace

std::string pngOf(int width, int height, bool hasOpacity,
                  const std::function<void(int y, std::span<std::uint8_t> samples)>& fillRow) {
    constexpr std::uint8_t kUp = 2, kRgb = 2, kRgba = 6;
    Bytes row(static_cast<std::size_t>(width) * (hasOpacity ? 4 : 3)), above(row.size()), filtered;
    filtered.reserve((row.size() + 1) * height);
    for (int y = 0; y < height; ++y) {
        fillRow(y, row);
        filtered.push_back(kUp);
        for (std::size_t n = 0; n < row.size(); ++n) {
            filtered.push_back(static_cast<std::uint8_t>(row[n] - above[n]));
        }
        row.swap(above);
    }
    Bytes header;
    addNumber(header, static_cast<std::uint32_t>(width));
    addNumber(header, static_cast<std::uint32_t>(height));
    for (const int value : {8, int{hasOpacity ? kRgba : kRgb}, 0, 0, 0}) {
        header.push_back(static_cast<std::uint8_t>(value));
    }
    std::string file = "\x89PNG\r\n\x1a\n";
    addChunk(file, "IHDR", header);
    addChunk(file, "IDAT", packed(filtered));
    addChunk(file, "IEND", {});
    return file;
}

}  // namespace adaptiso
