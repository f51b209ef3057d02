#include "Common/Sha256.h"

#include <fcntl.h>
#include <unistd.h>
#ifndef ADAPTISO_WITHOUT_OPENSSL
#include <openssl/evp.h>
#endif

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

#ifdef ADAPTISO_WITHOUT_OPENSSL
/// For WebAssembly: checksums are for batches, and these need processes.
class Sha256 {
public:
    Sha256() {
        throw InvalidInput(
            "a batch: this build has no processes to run its inputs in; run the program for each");
    }
    void add(const void*, std::size_t) {}
    std::string digits() { return {}; }
};
#else
class Sha256 {
public:
    Sha256() : context_(EVP_MD_CTX_new()) {
        require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
    }
    void add(const void* bytes, std::size_t count) {
        require(EVP_DigestUpdate(context_.get(), bytes, count) == 1);
    }
    std::string digits() {
        constexpr std::string_view kDigits = "0123456789abcdef";
        std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
        unsigned int length = 0;
        require(EVP_DigestFinal_ex(context_.get(), digest.data(), &length) == 1);
        std::string text;
        for (unsigned int n = 0; n < length; ++n) {
            text += {kDigits[digest[n] >> 4], kDigits[digest[n] & 15]};
        }
        return text;
    }

private:
    static void require(bool isDone) {
        if (!isDone) throw InternalError("sha256: OpenSSL refuses it");
    }
    struct Free {
        void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
    };
    std::unique_ptr<EVP_MD_CTX, Free> context_;
};
#endif

}  // namespace

std::string sha256Of(std::string_view bytes) {
    Sha256 sum;
    sum.add(bytes.data(), bytes.size());
    return sum.digits();
}

std::string sha256OfFile(const std::filesystem::path& path) {
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    const auto fail = [&path] {
        throw FileError(path.string() + ": can't be read: " + std::strerror(errno));
    };
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0) fail();
    const std::unique_ptr<const int, void (*)(const int*)> closed(
        &file, [](const int* descriptor) { close(*descriptor); });
    Sha256 sum;
    std::vector<std::uint8_t> piece(kPiece);
    for (;;) {
        const ssize_t count = read(file, piece.data(), piece.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail();
        if (count == 0) return sum.digits();
        sum.add(piece.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace adaptiso
