#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace adaptiso::detail {

/// Content of a file behind the last byte that was read.
struct ByteTail {
    std::uint64_t byteCount = 0;   ///< inflated where the data are compressed
    bool isZeros = true;           ///< no more than 64 KiB, all of them 0: padding
    std::string head;              ///< the first of them, at most 1 MiB
    bool hasSecondStream = false;  ///< behind compressed data: zlib or gzip data begin again
    bool hasStray = false;         ///< or something else that is no padding
    std::string stray;             ///< the first bytes of that, at most 64 KiB
};

/// The bytes of a file from an offset on, as they are or inflated. Every read that can't be
/// fulfilled throws FileError: nobody downstream sees bytes that are not in the file.
class ByteSource {
public:
    enum class Encoding { Raw, Deflate };  ///< Deflate: gzip or zlib, whichever it is

    ByteSource(std::filesystem::path file, std::uint64_t offset, Encoding encoding);

    /// Raw, or Deflate where the file begins with gzip's magic.
    static Encoding encodingOf(const std::filesystem::path& file);
    static ByteSource openPlainOrGzip(const std::filesystem::path& file);

    /// Position of the next byte in the file. \pre Raw
    std::uint64_t position() const { return position_; }

    /// \throws FileError when `byteCount` bytes can't possibly follow, or when compressed data are
    ///         so small for them that they are a decompression bomb (cheap; before allocating)
    void requireRoomFor(std::uint64_t byteCount) const;

    /// Reads up to `byteCount` bytes; fewer only at the end.
    std::size_t readSome(void* out, std::size_t byteCount);
    /// \throws FileError when the data end early
    void read(void* out, std::uint64_t byteCount);
    void skip(std::uint64_t byteCount);
    /// Past the next '\n'.
    void skipLine();
    /// To where `byteCount` bytes are left. \pre Raw
    void skipToLast(std::uint64_t byteCount);

    /// Reads on to the end, which also checks the checksum of compressed data; of these no more
    /// than `enough` bytes and at least 64 MiB are inflated.
    /// \throws FileError when compressed data are damaged or end early
    ByteTail readTail(std::uint64_t enough);

private:
    struct InflateEnd {
        void operator()(z_stream* stream) const {
            inflateEnd(stream);
            delete stream;
        }
    };
    struct CloseFile {
        void operator()(const int* descriptor) const;
    };

    std::uint64_t bytesLeft() const { return position_ < end_ ? end_ - position_ : 0; }
    std::size_t readRaw(void* out, std::size_t byteCount);
    std::size_t readInflated(void* out, std::size_t byteCount);
    bool refillInput();
    bool nextMemberBegins();
    ByteTail rawTail();
    void lookBehindStream(ByteTail& tail);
    [[noreturn]] void refuseTruncated(std::uint64_t missing) const;

    std::filesystem::path file_;
    std::unique_ptr<const int, CloseFile> descriptor_;
    std::uint64_t position_ = 0;  ///< of the next raw byte in the file
    std::uint64_t end_ = 0;       ///< the file's size
    std::uint64_t rawBytes_ = 0;  ///< from the offset given to the end of the file
    std::unique_ptr<z_stream, InflateEnd> inflater_;
    std::vector<unsigned char> input_;
    bool hasInflated_ = false, inflateDone_ = false;
};

}  // namespace adaptiso::detail
