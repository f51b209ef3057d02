#include "ZarrCodecs.h"

#include <fmt/core.h>
#include <zlib.h>
#ifndef ADAPTISO_WITHOUT_ZARR_CODECS
#include <blosc.h>
#include <lz4.h>
#include <zstd.h>
#endif

#include <array>
#include <cstring>
#include <limits>
#include <memory>

#include "FileFault.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::byte>;

[[noreturn]] void refuseChunk(const fs::path& file, std::string_view codec) {
    refuse(file, fmt::format("its {} data are damaged, or unpack to more than a chunk", codec),
           "get the dataset again");
}

/// The first four bytes, little-endian.
std::uint32_t firstWord(std::span<const std::byte> bytes) {
    std::uint32_t word = 0;
    for (std::size_t n = 4; n-- > 0;) word = word << 8 | std::to_integer<std::uint32_t>(bytes[n]);
    return word;
}

/// One stream of zlib or gzip, and nothing behind it.
Bytes inflated(const Bytes& packed, std::uint64_t most, const fs::path& file) {
    struct End {
        void operator()(z_stream* stream) const { inflateEnd(stream); }
    };
    z_stream stream{};
    constexpr int kEitherHeader = 32 + MAX_WBITS;
    if (inflateInit2(&stream, kEitherHeader) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, End> guard(&stream);
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
    Bytes out(static_cast<std::size_t>(most));
    std::size_t taken = 0, given = 0;
    for (int state = Z_OK; state != Z_STREAM_END;) {
        stream.next_in =
            const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data() + taken));  // NOLINT
        stream.avail_in = static_cast<uInt>(std::min(packed.size() - taken, kMostAtOnce));
        stream.next_out = reinterpret_cast<Bytef*>(out.data() + given);
        stream.avail_out = static_cast<uInt>(std::min(out.size() - given, kMostAtOnce));
        const uInt in = stream.avail_in, room = stream.avail_out;
        state = inflate(&stream, Z_NO_FLUSH);
        taken += in - stream.avail_in;
        given += room - stream.avail_out;
        const bool isStuck = in == stream.avail_in && room == stream.avail_out;
        if (state != Z_STREAM_END && (state != Z_OK || isStuck)) refuseChunk(file, "deflate");
    }
    if (taken != packed.size()) refuseChunk(file, "deflate");
    out.resize(given);
    return out;
}

#ifndef ADAPTISO_WITHOUT_ZARR_CODECS
Bytes unzstd(const Bytes& packed, std::uint64_t most, const fs::path& file) {
    Bytes out(static_cast<std::size_t>(most));
    const std::size_t size = ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
    if (ZSTD_isError(size) != 0) refuseChunk(file, "zstd");
    out.resize(size);
    return out;
}

Bytes unblosc(const Bytes& packed, std::uint64_t most, const fs::path& file) {
    std::size_t size = 0;
    const bool isBlosc = packed.size() >= BLOSC_MIN_HEADER_LENGTH &&
                         blosc_cbuffer_validate(packed.data(), packed.size(), &size) == 0;
    if (!isBlosc || size > most) refuseChunk(file, "blosc");
    Bytes out(size);
    const int got = blosc_decompress_ctx(packed.data(), out.data(), out.size(), 1);
    if (got < 0 || static_cast<std::size_t>(got) != size) refuseChunk(file, "blosc");
    return out;
}

/// numcodecs' form: the size, then one block.
Bytes unlz4(const Bytes& packed, std::uint64_t most, const fs::path& file) {
    constexpr std::size_t kHeader = 4;
    constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<int>::max());
    if (packed.size() < kHeader || packed.size() > kMost) refuseChunk(file, "lz4");
    const std::uint32_t size = firstWord(packed);
    if (size > most || size > kMost) refuseChunk(file, "lz4");
    Bytes out(size);
    const int got = LZ4_decompress_safe(
        reinterpret_cast<const char*>(packed.data() + kHeader), reinterpret_cast<char*>(out.data()),
        static_cast<int>(packed.size() - kHeader), static_cast<int>(size));
    if (got < 0 || static_cast<std::uint32_t>(got) != size) refuseChunk(file, "lz4");
    return out;
}

/// lz4-java's form: blocks with a header each, and one of no bytes at the end. Their checksums
/// (XXH32) are not looked at.
Bytes unlz4Stream(const Bytes& packed, std::uint64_t most, const fs::path& file) {
    constexpr std::string_view kMagic = "LZ4Block";
    constexpr std::size_t kHeader = 21, kPacked = 9, kSize = 13;
    constexpr std::uint32_t kMost = std::uint32_t{1} << 25;  // of a block
    constexpr int kMethod = 0xf0, kRaw = 0x10, kLz4 = 0x20;
    Bytes out;
    for (std::size_t at = 0;;) {
        if (packed.size() - at < kHeader ||
            std::memcmp(packed.data() + at, kMagic.data(), kMagic.size()) != 0) {
            refuseChunk(file, "lz4");
        }
        const std::span<const std::byte> block = std::span(packed).subspan(at);
        const int method = std::to_integer<int>(block[kMagic.size()]) & kMethod;
        const std::uint32_t length = firstWord(block.subspan(kPacked)),
                            size = firstWord(block.subspan(kSize));
        at += kHeader;
        if (size == 0 && length == 0 && at == packed.size()) return out;
        if (size == 0 || size > kMost || length > packed.size() - at || size > most - out.size() ||
            (method == kRaw ? length != size : method != kLz4)) {
            refuseChunk(file, "lz4");
        }
        const std::size_t begin = out.size();
        out.resize(begin + size);
        auto* const to = reinterpret_cast<char*>(out.data() + begin);
        const auto* const from = reinterpret_cast<const char*>(packed.data() + at);
        if (method == kRaw) {
            std::memcpy(to, from, size);
        } else if (LZ4_decompress_safe(from, to, static_cast<int>(length),
                                       static_cast<int>(size)) != static_cast<int>(size)) {
            refuseChunk(file, "lz4");
        }
        at += length;
    }
}

#endif

Bytes withoutChecksum(Bytes packed, const fs::path& file) {
    constexpr std::size_t kSum = 4;
    if (packed.size() < kSum) refuse(file, "is too short for its checksum", "get it again");
    const std::span<const std::byte> all(packed);
    if (crc32c(all.first(packed.size() - kSum)) != firstWord(all.last(kSum))) {
        refuse(file, "is damaged: its checksum (crc32c) differs", "get the dataset again");
    }
    packed.resize(packed.size() - kSum);
    return packed;
}

}  // namespace

ZarrCodec zarrCodecOf(const fs::path& metadata, std::string_view name) {
    constexpr std::string_view kNumcodecs = "numcodecs.";
    std::string_view known = name;
    if (known.starts_with(kNumcodecs)) known.remove_prefix(kNumcodecs.size());
    if (known == "zlib" || known == "gzip") return ZarrCodec::Deflate;
#ifndef ADAPTISO_WITHOUT_ZARR_CODECS
    if (known == "zstd") return ZarrCodec::Zstd;
    if (known == "blosc") return ZarrCodec::Blosc;
    if (known == "lz4") return ZarrCodec::Lz4;
#endif
    if (name == "crc32c") return ZarrCodec::Crc32c;
    refuse(metadata, fmt::format("its codec {} is not read here", printable(name)),
           "write the array with raw, gzip, zlib, zstd, blosc or lz4 chunks");
}

std::uint64_t zarrPackedLimit(std::uint64_t byteCount) {
    constexpr std::uint64_t kHeaders = std::uint64_t{64} << 10;
    return byteCount + byteCount / 8 + kHeaders;
}

Bytes unpackZarrChunk(Bytes packed, std::span<const ZarrCodec> codecs, std::uint64_t byteCount,
                      const fs::path& file) {
    for (std::size_t n = codecs.size(); n-- > 0;) {
        // what is packed once more may be a little more than the chunk
        const std::uint64_t most = n == 0 ? byteCount : zarrPackedLimit(byteCount);
        switch (codecs[n]) {
            case ZarrCodec::Deflate:
                packed = inflated(packed, most, file);
                break;
#ifndef ADAPTISO_WITHOUT_ZARR_CODECS
            case ZarrCodec::Zstd:
                packed = unzstd(packed, most, file);
                break;
            case ZarrCodec::Blosc:
                packed = unblosc(packed, most, file);
                break;
            case ZarrCodec::Lz4:
                packed = unlz4(packed, most, file);
                break;
            case ZarrCodec::Lz4Stream:
                packed = unlz4Stream(packed, most, file);
                break;
#endif
            case ZarrCodec::Crc32c:
                packed = withoutChecksum(std::move(packed), file);
                break;
            default:
                throw InternalError("unpackZarrChunk: a codec that this build is without");
        }
    }
    if (packed.size() != byteCount) {
        refuse(file, fmt::format("holds {} bytes of a chunk of {}", packed.size(), byteCount),
               "get the dataset again");
    }
    return packed;
}

std::uint32_t crc32c(std::span<const std::byte> bytes) {
    static const std::array<std::uint32_t, 256> kTable = [] {
        std::array<std::uint32_t, 256> table{};
        constexpr std::uint32_t kPolynomial = 0x82f63b78;  // reflected
        for (std::uint32_t n = 0; n < table.size(); ++n) {
            std::uint32_t value = n;
            for (int bit = 0; bit < 8; ++bit) {
                value = (value >> 1) ^ ((value & 1) != 0 ? kPolynomial : 0);
            }
            table[n] = value;
        }
        return table;
    }();
    std::uint32_t sum = ~std::uint32_t{0};
    for (const std::byte byte : bytes) {
        sum = (sum >> 8) ^ kTable[(sum ^ std::to_integer<std::uint32_t>(byte)) & 0xff];
    }
    return ~sum;
}

}  // namespace adaptiso::detail
