#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <string_view>
#include <vector>

#include "Checksum.h"
#include "Support/AnalyticVolumes.h"

namespace adaptiso::detail {
namespace {

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

std::vector<std::byte> randomBytes(std::size_t count) {
    std::uint64_t state = 5;
    std::vector<std::byte> bytes(count);
    for (std::byte& b : bytes) b = static_cast<std::byte>(testing::nextRandom(state));
    return bytes;
}

}  // namespace

TEST(Checksum, IsXxh64) {
    // xxhsum -H1 of Debian's package xxhash prints the same
    EXPECT_EQ(xxh64({}), 0xef46db3751d8e999u);
    EXPECT_EQ(xxh64(bytesOf("a")), 0xd24ec4f1a98c6e5bu);
    EXPECT_EQ(xxh64(bytesOf("abc")), 0x44bc2cf5ad770999u);
    EXPECT_EQ(xxh64(bytesOf("Nobody inspects the spammish repetition")), 0xfbcea83c8a378bf1u);
}

TEST(Checksum, OfPiecesIsTheSameForEveryNumberOfThreads) {
    const std::vector<std::byte> bytes = randomBytes(5'000'001);
    const std::uint64_t checksum = checksumOf(bytes);
    for (const std::size_t threads : {1u, 2u, 7u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(checksumOf(bytes), checksum) << threads;
    }
}

TEST(Checksum, OfPiecesIsThatOfTheirChecksums) {
    const std::vector<std::byte> bytes = randomBytes((1 << 20) + 3);
    const std::span<const std::byte> all(bytes);
    const std::uint64_t pieces[] = {xxh64(all.first(1 << 20)), xxh64(all.last(3))};
    EXPECT_EQ(checksumOf(bytes), xxh64(std::as_bytes(std::span(pieces))));
    const std::uint64_t ofNothing = xxh64({});
    EXPECT_EQ(checksumOf({}), xxh64(std::as_bytes(std::span(&ofNothing, 1))));
}

}  // namespace adaptiso::detail
