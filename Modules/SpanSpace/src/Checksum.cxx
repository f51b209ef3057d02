// XXH64, written from the description of the algorithm [Collet2012].

#include "Checksum.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

static_assert(std::endian::native == std::endian::little,
              "checksums and index files are of little-endian numbers, as memory holds them");

constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87, kPrime2 = 0xC2B2AE3D27D4EB4F,
                        kPrime3 = 0x165667B19E3779F9, kPrime4 = 0x85EBCA77C2B2AE63,
                        kPrime5 = 0x27D4EB2F165667C5;

template <class T>
T load(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

std::uint64_t mixed(std::uint64_t lane, std::uint64_t word) {
    return std::rotl(lane + word * kPrime2, 31) * kPrime1;
}

/// The stripes of 32 bytes, in four lanes; `at` ends after the last of them.
std::uint64_t stripes(const std::byte*& at, const std::byte* end) {
    std::array<std::uint64_t, 4> lane{kPrime1 + kPrime2, kPrime2, 0, 0 - kPrime1};
    for (; end - at >= 32; at += 32) {
        for (std::size_t n = 0; n < 4; ++n)
            lane[n] = mixed(lane[n], load<std::uint64_t>(at + 8 * n));
    }
    std::uint64_t hash = std::rotl(lane[0], 1) + std::rotl(lane[1], 7) + std::rotl(lane[2], 12) +
                         std::rotl(lane[3], 18);
    for (const std::uint64_t l : lane) hash = (hash ^ mixed(0, l)) * kPrime1 + kPrime4;
    return hash;
}

std::uint64_t avalanche(std::uint64_t hash) {
    hash = (hash ^ (hash >> 33)) * kPrime2;
    hash = (hash ^ (hash >> 29)) * kPrime3;
    return hash ^ (hash >> 32);
}

}  // namespace

std::uint64_t xxh64(std::span<const std::byte> bytes) {
    const std::byte* at = bytes.data();
    const std::byte* const end = at + bytes.size();
    std::uint64_t hash = bytes.size() < 32 ? kPrime5 : stripes(at, end);
    hash += bytes.size();
    for (; end - at >= 8; at += 8) {
        hash = std::rotl(hash ^ mixed(0, load<std::uint64_t>(at)), 27) * kPrime1 + kPrime4;
    }
    if (end - at >= 4) {
        hash = std::rotl(hash ^ load<std::uint32_t>(at) * kPrime1, 23) * kPrime2 + kPrime3;
        at += 4;
    }
    for (; at != end; ++at) {
        hash = std::rotl(hash ^ std::to_integer<std::uint64_t>(*at) * kPrime5, 11) * kPrime1;
    }
    return avalanche(hash);
}

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
    constexpr std::int64_t kPiece = std::int64_t{1} << 20;
    const std::int64_t count = std::ssize(bytes);
    std::vector<std::uint64_t> pieces(std::max<std::int64_t>(1, (count + kPiece - 1) / kPiece),
                                      xxh64({}));
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        pieces[begin / kPiece] = xxh64(bytes.subspan(begin, end - begin));
    });
    return xxh64(std::as_bytes(std::span(pieces)));
}

}  // namespace adaptiso::detail
