#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <optional>

#include "BlocksByDefinition.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/SpanSpace/IndexFile.h"

namespace adaptiso::testing {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kHeader = 48;    // bytes before the nodes
constexpr std::size_t kChecksum = 8;   // bytes after them
constexpr std::size_t kSearchAt = 12;  // as IndexFile.h lays the header out
constexpr std::size_t kBlockSizeAt = 15;
constexpr std::size_t kVolumeSizeAt = 16;

const double kIsovalues[] = {-1e300, 0, 0.5, 3, 7, 10.5, 11, 11.5, 127, 1e300};

/// The error that decodeIndex() gives, if any.
std::optional<std::string> refusal(const Bytes& bytes, const VolumeView& volume) {
    try {
        decodeIndex(bytes, volume, "a.idx");
        return std::nullopt;
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

::testing::AssertionResult isRefused(const Bytes& bytes, const VolumeView& volume,
                                     const std::string& why) {
    const std::optional<std::string> message = refusal(bytes, volume);
    if (!message) return ::testing::AssertionFailure() << "is taken";
    if (message->rfind("a.idx: ", 0) == 0 && message->find(why) != std::string::npos) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << *message;
}

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

/// Gives changed bytes the checksum that belongs to them, as a forger would.
Bytes resealed(Bytes bytes) {
    const std::size_t content = bytes.size() - kChecksum;
    put(bytes, content, indexChecksum(std::span(bytes).first(content)));
    return bytes;
}

/// Where the block of node `n` stands in a kd-tree's bytes. \pre samples of uint8
std::size_t blockAt(const Bytes& bytes, std::size_t n) {
    const std::size_t count = (bytes.size() - kHeader - kChecksum) / 6;
    return kHeader + 2 * count + 4 * n;
}

::testing::AssertionResult answersAlike(const SpanSpaceIndex& a, const SpanSpaceIndex& b) {
    for (const double isovalue : kIsovalues) {
        const BlockQuery one = a.blocksAt(isovalue), other = b.blocksAt(isovalue);
        if (one.blocks != other.blocks || one.nodesVisited != other.nodesVisited) {
            return ::testing::AssertionFailure() << "not at " << isovalue;
        }
    }
    return ::testing::AssertionSuccess();
}

struct Kept {
    Volume volume;
    Bytes bytes;
};

/// A small index of uint8 noise, in which most blocks have ranges of their own.
Kept smallIndex(BlockSearchKind search = BlockSearchKind::KdTree) {
    Volume volume = hardSamples<std::uint8_t>({7, 6, 5}, 3);
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {2, Border::Closed, search});
    Bytes bytes = encodeIndex(index, volume);
    return {std::move(volume), std::move(bytes)};
}

template <class T>
class IndexFile : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(IndexFile, PixelTypes);

}  // namespace

TYPED_TEST(IndexFile, GivesBackTheIndexThatItKeeps) {
    std::uint64_t state = 21;
    for (int n = 0; n < 6; ++n) {
        const Volume volume = hardSamples<TypeParam>(randomSize(state, 30), nextRandom(state));
        for (const BlockSearchKind search : kSearches) {
            for (const int blockSize : kBlockSizes) {
                for (const Border border : kBorders) {
                    const SpanSpaceIndex index =
                        SpanSpaceIndex::build(volume, {blockSize, border, search});
                    const Bytes bytes = encodeIndex(index, volume);
                    EXPECT_LE(bytes.size(), largestIndexBytes(volume));
                    const SpanSpaceIndex again = decodeIndex(bytes, volume);
                    EXPECT_EQ(again.grid(), index.grid());
                    EXPECT_EQ(again.search(), search);
                    EXPECT_EQ(again.pixelType(), index.pixelType());
                    EXPECT_EQ(again.memoryBytes(), index.memoryBytes());
                    EXPECT_TRUE(answersAlike(again, index));
                    EXPECT_EQ(encodeIndex(again, volume), bytes);
                }
            }
        }
    }
}

TEST(IndexFile, HoldsWhatItsLayoutSays) {
    // 14 x 1 x 1 samples are 7 blocks of 2 with an open border: 48 + 7 * (2 + 2 + 4) + 8 bytes
    const Volume volume = randomVolume<std::int16_t>({14, 1, 1}, 100, 1);
    const SpanSpaceIndex index = SpanSpaceIndex::build(volume, {2, Border::Open});
    const Bytes bytes = encodeIndex(index, volume);
    ASSERT_EQ(bytes.size(), 48u + 7 * 8 + 8);
    const unsigned char start[24] = {'A', 'D', 'A', 'P', 'T', 'I', 'D', 'X', 2, 0, 0, 0,
                                     0,   1,   3,   2,   14,  0,   0,   0,   0, 0, 0, 0};
    EXPECT_EQ(std::memcmp(bytes.data(), start, sizeof start), 0);
}

TEST(IndexFile, RefusesEveryChangedByte) {
    for (const BlockSearchKind search : kSearches) {
        const Kept kept = smallIndex(search);
        for (std::size_t at = 0; at < kept.bytes.size(); ++at) {
            for (const unsigned flip : {0x01u, 0x80u, 0xffu}) {
                Bytes bytes = kept.bytes;
                bytes[at] ^= static_cast<std::byte>(flip);
                EXPECT_TRUE(refusal(bytes, kept.volume)) << at << " ^ " << flip;
            }
        }
    }
}

TEST(IndexFile, RefusesEveryOtherLength) {
    const Kept kept = smallIndex();
    for (std::size_t length = 0; length < kept.bytes.size(); ++length) {
        const Bytes bytes(kept.bytes.begin(), kept.bytes.begin() + length);
        EXPECT_TRUE(refusal(bytes, kept.volume)) << length;
    }
    Bytes longer = kept.bytes;
    longer.insert(longer.end(), 6, std::byte{0});
    EXPECT_TRUE(isRefused(longer, kept.volume, "cut off or damaged"));
    EXPECT_TRUE(isRefused(resealed(longer), kept.volume, "its length is wrong"));
}

TEST(IndexFile, TellsWhatIsWrong) {
    const Kept kept = smallIndex();
    EXPECT_TRUE(isRefused({}, kept.volume, "is not an index of adaptiso"));
    EXPECT_TRUE(isRefused(Bytes(1000, std::byte{'x'}), kept.volume, "is not an index"));
    EXPECT_TRUE(isRefused(Bytes(kept.bytes.begin(), kept.bytes.begin() + 20), kept.volume,
                          "the index is cut off"));
    Bytes newer = kept.bytes;
    put(newer, 8, std::uint32_t{3});
    EXPECT_TRUE(isRefused(newer, kept.volume, "format version 3; this program reads version 2"));
    Bytes damaged = kept.bytes;
    damaged[60] ^= std::byte{4};
    EXPECT_TRUE(isRefused(damaged, kept.volume, "its checksum is wrong"));
}

TEST(IndexFile, RefusesAnotherVolume) {
    const Kept kept = smallIndex();
    const auto view = kept.volume.view().as<std::uint8_t>();
    const std::vector<std::uint8_t> samples(view.samples, view.samples + 7 * 6 * 5);
    ImageGeometry geometry = view.geometry;

    geometry.size = {6, 7, 5};  // as many samples
    EXPECT_TRUE(isRefused(kept.bytes, Volume::fromSamples(samples, geometry),
                          "of 7 x 6 x 5 samples of uint8; this one has 6 x 7 x 5 samples"));
    const VolumeView asSigned(samples.data(), PixelType::Int8, view.geometry);  // the same bytes
    EXPECT_TRUE(isRefused(kept.bytes, asSigned, "this one has 7 x 6 x 5 samples of int8"));
    for (std::size_t n = 0; n < samples.size(); ++n) {
        std::vector<std::uint8_t> others = samples;
        others[n] ^= 1;
        EXPECT_TRUE(isRefused(kept.bytes, Volume::fromSamples(others, view.geometry),
                              "another image of the same size"));
    }
    EXPECT_THROW(encodeIndex(SpanSpaceIndex::build(kept.volume, {}), asSigned), InvalidInput);
}

TEST(IndexFile, TakesTheSameSamplesInAnotherFrame) {
    const Kept kept = smallIndex();
    ImageGeometry geometry = kept.volume.view().geometry();
    geometry.originMm = {5, 6, 7};
    const VolumeView moved(kept.volume.view().samples(), PixelType::UInt8, geometry);
    EXPECT_EQ(refusal(kept.bytes, moved), std::nullopt);
}

TEST(IndexFile, RefusesForgedHeaders) {
    const Kept kept = smallIndex();
    const auto forged = [&](std::size_t at, auto value) {
        Bytes bytes = kept.bytes;
        put(bytes, at, value);
        return resealed(std::move(bytes));
    };
    for (unsigned code = 3; code < 256; ++code) {
        EXPECT_TRUE(isRefused(forged(kSearchAt, static_cast<std::uint8_t>(code)), kept.volume,
                              "means nothing"));
    }
    for (unsigned size = 0; size < 256; ++size) {
        if (size == 2) continue;
        EXPECT_TRUE(refusal(forged(kBlockSizeAt, static_cast<std::uint8_t>(size)), kept.volume))
            << size;
    }
    // nothing is allocated for what a header claims: these would be 2^62 blocks
    for (const std::int64_t extent : {std::int64_t{1} << 62, std::int64_t{-1}, std::int64_t{0}}) {
        EXPECT_TRUE(
            isRefused(forged(kVolumeSizeAt, extent), kept.volume, "is the index of another image"));
    }
}

TEST(IndexFile, RefusesForgedNodes) {
    const Kept kept = smallIndex();
    const std::size_t count = (kept.bytes.size() - kHeader - kChecksum) / 6;
    const auto refuses = [&](const std::function<void(Bytes&)>& change) {
        Bytes bytes = kept.bytes;
        change(bytes);
        return isRefused(resealed(std::move(bytes)), kept.volume, "does not fit the image");
    };
    const auto node = [&](Bytes& bytes, std::size_t n) {  // its bytes: minimum, maximum, block
        return std::array<std::byte*, 3>{&bytes[kHeader + n], &bytes[kHeader + count + n],
                                         &bytes[blockAt(bytes, n)]};
    };
    for (std::size_t n = 0; n < count; ++n) {
        EXPECT_TRUE(refuses([&](Bytes& b) { *node(b, n)[0] ^= std::byte{1}; })) << n;
        EXPECT_TRUE(refuses([&](Bytes& b) { *node(b, n)[1] ^= std::byte{1}; })) << n;
        EXPECT_TRUE(refuses([&](Bytes& b) { put(b, blockAt(b, n), std::uint32_t(count)); })) << n;
        EXPECT_TRUE(refuses([&](Bytes& b) { put(b, blockAt(b, n), ~std::uint32_t{0}); })) << n;
        // nodes that are true, but in the wrong places: one twice, or two swapped
        const std::size_t other = (n + 1 + n % 3) % count;
        const auto copy = [&](Bytes& b, std::size_t from, std::size_t to) {
            *node(b, to)[0] = *node(b, from)[0];
            *node(b, to)[1] = *node(b, from)[1];
            std::memcpy(node(b, to)[2], node(b, from)[2], 4);
        };
        EXPECT_TRUE(refuses([&](Bytes& b) { copy(b, other, n); })) << n;
        EXPECT_TRUE(refuses([&](Bytes& b) {
            const Bytes before = b;
            copy(b, other, n);
            *node(b, other)[0] = before[kHeader + n];
            *node(b, other)[1] = before[kHeader + count + n];
            std::memcpy(node(b, other)[2], &before[blockAt(b, n)], 4);
        })) << n;
    }
}

TEST(IndexFile, TakesNothingForgedButTheTruth) {
    // random changes under the right checksum: refused, or what build() gives
    std::uint64_t state = 99;
    int taken = 0;
    for (int n = 0; n < 6000; ++n) {
        const BlockSearchKind search = kSearches[n % 3];
        const Kept kept = smallIndex(search);
        Bytes bytes = kept.bytes;
        const std::uint64_t changes = 1 + nextRandom(state) % 4;
        for (std::uint64_t c = 0; c < changes; ++c) {
            const std::size_t at = nextRandom(state) % bytes.size();
            bytes[at] = nextRandom(state) % 2 ? bytes[nextRandom(state) % bytes.size()]
                                              : static_cast<std::byte>(nextRandom(state));
        }
        if (n % 10 == 0) bytes.resize(nextRandom(state) % (2 * bytes.size()));
        if (bytes.size() < kChecksum) continue;
        bytes = resealed(std::move(bytes));
        try {
            const SpanSpaceIndex index = decodeIndex(bytes, kept.volume);
            EXPECT_TRUE(answersAlike(index, SpanSpaceIndex::build(kept.volume, index.options())));
            ++taken;
        } catch (const InvalidInput&) {
        }
    }
    EXPECT_GT(taken, 0);  // a change that changes nothing
}

}  // namespace adaptiso::testing
