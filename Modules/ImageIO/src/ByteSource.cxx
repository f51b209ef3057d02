#include "ByteSource.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string_view>

#include "FileFault.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Surplus.h"

namespace adaptiso::detail {
namespace {

constexpr std::size_t kTailHead = std::size_t{1} << 20;

/// Counts `bytes` in.
void take(std::string_view bytes, ByteTail& tail) {
    tail.byteCount += bytes.size();
    tail.isZeros = tail.isZeros && tail.byteCount <= kMostPadding && areZeros(bytes);
    tail.head += bytes.substr(0, kTailHead - std::min(kTailHead, tail.head.size()));
}

/// True if `bytes` inflate, as far as they go.
bool beginsStream(std::string& bytes) {
    z_stream stream{};
    constexpr int kGzipOrZlib = MAX_WBITS + 32;
    if (inflateInit2(&stream, kGzipOrZlib) != Z_OK) return false;
    unsigned char out[256];
    stream.next_in = reinterpret_cast<unsigned char*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = out;
    stream.avail_out = sizeof out;
    const int status = inflate(&stream, Z_NO_FLUSH);
    const bool hasOutput = stream.total_out > 0;
    inflateEnd(&stream);
    return hasOutput && (status == Z_OK || status == Z_STREAM_END);
}

}  // namespace

void ByteSource::CloseFile::operator()(const int* descriptor) const {
    ::close(*descriptor);
    delete descriptor;
}

ByteSource::ByteSource(std::filesystem::path file, std::uint64_t offset, Encoding encoding)
    : file_(std::move(file)), position_(offset) {
    requireRegularFile(file_);
    // not blocked by a pipe that has taken the file's place since
    const int descriptor = ::open(file_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        refuse(file_, std::string("can't be opened: ") + std::strerror(errno),
               "check its permissions");
    }
    descriptor_.reset(new int(descriptor));
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        refuse(file_, "is not a regular file", "give an image file or a DICOM folder");
    }
    end_ = static_cast<std::uint64_t>(status.st_size);
    if (position_ > end_) {
        refuse(file_,
               fmt::format("truncated: its data would begin at byte {} of {}", position_, end_),
               "get the whole file, in binary mode");
    }
    rawBytes_ = end_ - position_;

    if (encoding == Encoding::Deflate) {
        inflater_.reset(new z_stream{});
        constexpr int kGzipOrZlib = MAX_WBITS + 32;
        if (inflateInit2(inflater_.get(), kGzipOrZlib) != Z_OK) {
            throw InternalError("ByteSource: zlib can't be started");
        }
        input_.resize(std::size_t{1} << 16);
    }
}

ByteSource::Encoding ByteSource::encodingOf(const std::filesystem::path& file) {
    unsigned char magic[2] = {0, 0};
    ByteSource(file, 0, Encoding::Raw).readSome(magic, sizeof magic);
    return magic[0] == 0x1f && magic[1] == 0x8b ? Encoding::Deflate : Encoding::Raw;
}

ByteSource ByteSource::openPlainOrGzip(const std::filesystem::path& file) {
    return ByteSource(file, 0, encodingOf(file));
}

void ByteSource::requireRoomFor(std::uint64_t byteCount) const {
    if (!inflater_) {
        if (byteCount > bytesLeft()) refuseTruncated(byteCount - bytesLeft());
        return;
    }
    constexpr std::uint64_t kDeflateLimit = 1032;  // no deflate stream expands further
    const std::uint64_t most = rawBytes_ * kDeflateLimit;
    if (byteCount > most) refuseTruncated(byteCount - most);
    if (!kImageUnpackLimit.allows(rawBytes_, byteCount)) {
        refuse(file_,
               fmt::format("its {} compressed bytes expand to a size of {}, as only a "
                           "decompression bomb or an empty image does",
                           rawBytes_, byteCount),
               "decompress it first if it is meant to be so");
    }
}

std::size_t ByteSource::readSome(void* out, std::size_t byteCount) {
    return inflater_ ? readInflated(out, byteCount) : readRaw(out, byteCount);
}

void ByteSource::read(void* out, std::uint64_t byteCount) {
    const std::size_t got = readSome(out, byteCount);
    if (got < byteCount) refuseTruncated(byteCount - got);
}

void ByteSource::skip(std::uint64_t byteCount) {
    if (!inflater_) {
        if (byteCount > bytesLeft()) refuseTruncated(byteCount - bytesLeft());
        position_ += byteCount;
        return;
    }
    std::vector<char> scratch(std::min<std::uint64_t>(byteCount, std::uint64_t{1} << 20));
    while (byteCount > 0) {
        const std::size_t piece = std::min<std::uint64_t>(byteCount, scratch.size());
        const std::size_t got = readSome(scratch.data(), piece);
        if (got < piece) refuseTruncated(byteCount - got);
        byteCount -= piece;
    }
}

void ByteSource::skipLine() {
    char piece[256];
    for (;;) {
        const std::uint64_t begin = position_;
        const std::size_t got = readRaw(piece, sizeof piece);
        if (got == 0) refuseTruncated(1);
        const auto* const line = static_cast<const char*>(std::memchr(piece, '\n', got));
        if (line == nullptr) continue;
        position_ = begin + static_cast<std::uint64_t>(line - piece) + 1;
        return;
    }
}

void ByteSource::skipToLast(std::uint64_t byteCount) {
    if (byteCount > bytesLeft()) refuseTruncated(byteCount - bytesLeft());
    position_ = end_ - byteCount;
}

ByteTail ByteSource::readTail(std::uint64_t enough) {
    if (!inflater_) return rawTail();
    enough = std::max(enough, std::uint64_t{64} << 20);
    ByteTail tail;
    std::string piece(std::size_t{1} << 16, '\0');
    while (!inflateDone_ && tail.byteCount < enough) {
        const std::size_t got = readSome(piece.data(), piece.size());
        take(std::string_view(piece).substr(0, got), tail);
    }
    if (inflateDone_) lookBehindStream(tail);
    return tail;
}

ByteTail ByteSource::rawTail() {
    const std::uint64_t left = bytesLeft();
    ByteTail tail;
    std::string head(std::min<std::uint64_t>(left, kTailHead), '\0');
    head.resize(readRaw(head.data(), head.size()));
    take(head, tail);
    tail.byteCount = left;
    tail.isZeros = tail.isZeros && left <= kMostPadding;
    return tail;
}

/// Compressed data end by themselves. Tapes leave zeros behind them; another stream is more data.
void ByteSource::lookBehindStream(ByteTail& tail) {
    std::string rest(reinterpret_cast<const char*>(inflater_->next_in), inflater_->avail_in);
    const std::size_t held = rest.size();
    rest.resize(held + std::min<std::uint64_t>(bytesLeft(), kMostPadding + 1));
    rest.resize(held + readRaw(rest.data() + held, rest.size() - held));
    if (rest.size() <= kMostPadding && areZeros(rest)) return;
    tail.hasSecondStream = beginsStream(rest);
    tail.hasStray = !tail.hasSecondStream;
    if (tail.hasStray) tail.stray = std::move(rest);
}

std::size_t ByteSource::readRaw(void* out, std::size_t byteCount) {
    std::size_t done = 0;
    while (done < byteCount) {
        const ssize_t got = ::pread(*descriptor_, static_cast<char*>(out) + done, byteCount - done,
                                    static_cast<off_t>(position_));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            refuse(file_, std::string("can't be read: ") + std::strerror(errno),
                   "check the disk it is on");
        }
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
        position_ += static_cast<std::uint64_t>(got);
    }
    return done;
}

std::size_t ByteSource::readInflated(void* out, std::size_t byteCount) {
    std::size_t done = 0;
    while (done < byteCount && !inflateDone_) {
        if (inflater_->avail_in == 0 && !refillInput()) {
            refuse(file_, "truncated: its compressed data end in the middle",
                   "get the whole file, in binary mode");
        }
        const std::size_t piece =
            std::min<std::size_t>(byteCount - done, std::numeric_limits<uInt>::max());
        inflater_->next_out = static_cast<unsigned char*>(out) + done;
        inflater_->avail_out = static_cast<uInt>(piece);
        const int status = inflate(inflater_.get(), Z_NO_FLUSH);
        done += piece - inflater_->avail_out;
        if (status == Z_STREAM_END) {
            if (!nextMemberBegins()) {
                inflateDone_ = true;
            } else if (inflateReset(inflater_.get()) != Z_OK) {
                throw InternalError("ByteSource: zlib can't be restarted");
            }
        } else if (status != Z_OK && status != Z_BUF_ERROR) {
            constexpr uLong kMagicBytes = 2;
            if (inflater_->total_in <= kMagicBytes && !hasInflated_) {
                refuse(file_,
                       "its data are not compressed (gzip or zlib), or damaged at their begin",
                       "correct the header, or get the file again");
            }
            refuse(file_, "its compressed data are damaged (zlib or gzip check failed)",
                   "get the file again, in binary mode");
        }
        hasInflated_ = hasInflated_ || done > 0;
    }
    return done;
}

bool ByteSource::refillInput() {
    const std::size_t got = readRaw(input_.data(), input_.size());
    inflater_->next_in = input_.data();
    inflater_->avail_in = static_cast<uInt>(got);
    return got > 0;
}

/// gzip allows several members, one after the other; anything else after a member is left alone.
bool ByteSource::nextMemberBegins() {
    if (inflater_->avail_in < 2) {
        const std::size_t kept = inflater_->avail_in;
        std::copy_n(inflater_->next_in, kept, input_.data());
        const std::size_t got = readRaw(input_.data() + kept, input_.size() - kept);
        inflater_->next_in = input_.data();
        inflater_->avail_in = static_cast<uInt>(kept + got);
    }
    return inflater_->avail_in >= 2 && inflater_->next_in[0] == 0x1f &&
           inflater_->next_in[1] == 0x8b;
}

void ByteSource::refuseTruncated(std::uint64_t missing) const {
    refuse(file_,
           fmt::format("truncated: at least {} bytes of the data its header needs are missing",
                       missing),
           "get the whole file, in binary mode");
}

}  // namespace adaptiso::detail
