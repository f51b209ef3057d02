#include "Common/Sha256.h"

#include <fcntl.h>
#include <unistd.h>
#ifndef ADAPTISO_WITHOUT_OPENSSL
#include <openssl/evp.h>
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

#ifdef ADAPTISO_WITHOUT_OPENSSL
/// FIPS 180-4, section 6.2.
class Sha256 {
public:
    void add(const void* bytes, std::size_t count) {
        const auto* next = static_cast<const std::uint8_t*>(bytes);
        for (std::size_t n = 0; n < count; ++n) addByte(next[n]);
    }
    std::string digits() {
        const std::uint64_t bits = 8 * length_;
        addByte(0x80);
        while (length_ % kBlock != kBlock - 8) addByte(0);
        for (int shift = 56; shift >= 0; shift -= 8)
            addByte(static_cast<std::uint8_t>(bits >> shift));
        std::string text;
        for (const std::uint32_t word : state_) {
            for (int shift = 28; shift >= 0; shift -= 4)
                text += "0123456789abcdef"[word >> shift & 15];
        }
        return text;
    }

private:
    static constexpr std::size_t kBlock = 64;

    /// The first 32 bits of the fraction of a prime's cube root, by integers alone.
    static std::array<std::uint32_t, 64> cubeRoots() {
        std::array<std::uint32_t, 64> roots{};
        std::size_t count = 0;
        for (std::uint32_t prime = 2; count < roots.size(); ++prime) {
            bool isPrime = true;
            for (std::uint32_t d = 2; d * d <= prime; ++d) isPrime = isPrime && prime % d != 0;
            if (!isPrime) continue;
            // the largest r with r^3 <= prime * 2^96: r is below 2^35, its cube below 2^105
            std::uint64_t root = 0;
            for (std::uint64_t bit = std::uint64_t{1} << 34; bit > 0; bit >>= 1) {
                __extension__ using Wide = unsigned __int128;
                const Wide wider = root | bit;
                if (wider * wider * wider <= Wide{prime} << 96) root |= bit;
            }
            roots[count++] = static_cast<std::uint32_t>(root);
        }
        return roots;
    }

    void addByte(std::uint8_t byte) {
        block_[length_++ % kBlock] = byte;
        if (length_ % kBlock == 0) mix();
    }
    void mix() {
        static const std::array<std::uint32_t, 64> kRoots = cubeRoots();
        std::array<std::uint32_t, 64> w{};
        for (std::size_t n = 0; n < 16; ++n) {
            for (std::size_t b = 0; b < 4; ++b) w[n] = w[n] << 8 | block_[4 * n + b];
        }
        const auto turned = [](std::uint32_t x, int a, int b, int c) {
            return std::rotr(x, a) ^ std::rotr(x, b) ^ std::rotr(x, c);
        };
        for (std::size_t n = 16; n < 64; ++n) {
            const std::uint32_t a = w[n - 15], b = w[n - 2];
            w[n] = w[n - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[n - 7] +
                   (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
        }
        auto [a, b, c, d, e, f, g, h] = state_;
        for (std::size_t n = 0; n < 64; ++n) {
            const std::uint32_t one =
                h + turned(e, 6, 11, 25) + ((e & f) ^ (~e & g)) + kRoots[n] + w[n];
            const std::uint32_t two = turned(a, 2, 13, 22) + ((a & b) ^ (a & c) ^ (b & c));
            h = g, g = f, f = e, e = d + one, d = c, c = b, b = a, a = one + two;
        }
        const std::array<std::uint32_t, 8> mixed{a, b, c, d, e, f, g, h};
        for (std::size_t n = 0; n < 8; ++n) state_[n] += mixed[n];
    }

    std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                        0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<std::uint8_t, kBlock> block_{};
    std::uint64_t length_ = 0;
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
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
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
