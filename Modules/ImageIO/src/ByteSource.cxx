#include "ByteSource.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "FileFault.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::detail {

ByteSource::ByteSource(std::filesystem::path file, std::uint64_t offset, Encoding encoding)
    : file_(std::move(file)) {
    const std::uint64_t fileBytes = requireRegularFile(file_);
    if (offset > fileBytes) {
        refuse(file_,
               fmt::format("truncated: its data would begin at byte {} of {}", offset, fileBytes),
               "get the whole file");
    }
    rawBytes_ = fileBytes - offset;
    stream_.open(file_, std::ios::binary);
    stream_.seekg(static_cast<std::streamoff>(offset));
    if (!stream_) refuse(file_, "can't be opened for reading", "check its permissions");

    if (encoding == Encoding::Deflate) {
        inflater_.reset(new z_stream{});
        constexpr int kGzipOrZlib = MAX_WBITS + 32;
        if (inflateInit2(inflater_.get(), kGzipOrZlib) != Z_OK) {
            throw InternalError("ByteSource: zlib can't be started");
        }
        input_.resize(std::size_t{1} << 16);
    }
}

ByteSource ByteSource::openPlainOrGzip(const std::filesystem::path& file) {
    unsigned char magic[2] = {0, 0};
    ByteSource plain(file, 0, Encoding::Raw);
    plain.readSome(magic, sizeof magic);
    const bool isGzip = magic[0] == 0x1f && magic[1] == 0x8b;
    return ByteSource(file, 0, isGzip ? Encoding::Deflate : Encoding::Raw);
}

void ByteSource::requireRoomFor(std::uint64_t byteCount) const {
    constexpr std::uint64_t kDeflateLimit = 1032;  // no deflate stream expands further
    const std::uint64_t most = inflater_ ? rawBytes_ * kDeflateLimit : rawBytes_;
    if (byteCount > most) refuseTruncated(byteCount - most);
}

std::size_t ByteSource::readSome(void* out, std::size_t byteCount) {
    return inflater_ ? readInflated(out, byteCount) : readRaw(out, byteCount);
}

void ByteSource::read(void* out, std::uint64_t byteCount) {
    const std::size_t got = readSome(out, byteCount);
    if (got < byteCount) refuseTruncated(byteCount - got);
}

void ByteSource::skip(std::uint64_t byteCount) {
    std::vector<char> scratch(std::min<std::uint64_t>(byteCount, std::uint64_t{1} << 20));
    while (byteCount > 0) {
        const std::size_t piece = std::min<std::uint64_t>(byteCount, scratch.size());
        const std::size_t got = readSome(scratch.data(), piece);
        if (got < piece) refuseTruncated(byteCount - got);
        byteCount -= piece;
    }
}

void ByteSource::skipLine() {
    char c = 0;
    while (c != '\n') read(&c, 1);
}

void ByteSource::finish() {
    if (!inflater_) return;
    std::vector<char> scratch(std::size_t{1} << 16);
    for (int piece = 0; piece < 1024 && !inflateDone_; ++piece) {
        if (readSome(scratch.data(), scratch.size()) < scratch.size()) return;
    }
}

std::size_t ByteSource::readRaw(void* out, std::size_t byteCount) {
    stream_.read(static_cast<char*>(out), static_cast<std::streamsize>(byteCount));
    return static_cast<std::size_t>(stream_.gcount());
}

std::size_t ByteSource::readInflated(void* out, std::size_t byteCount) {
    std::size_t done = 0;
    while (done < byteCount && !inflateDone_) {
        if (inflater_->avail_in == 0 && !refillInput()) {
            refuse(file_, "truncated: its compressed data end in the middle", "get the whole file");
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
            refuse(file_, "its compressed data are damaged (zlib or gzip check failed)",
                   "get the file again");
        }
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
           "get the whole file");
}

}  // namespace adaptiso::detail
