#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

/// Zarr and N5 written on paper: an image of 7 x 6 x 5 samples whose values say where they lie, in
/// chunks that are ragged at every end.
namespace adaptiso::testing {

using Text = std::string;

constexpr int kX = 7, kY = 6, kZ = 5;  // samples
constexpr int kChunk = 4;              // a side
constexpr int kChunksX = 2, kChunksY = 2, kChunksZ = 2;

/// What the voxel holds, in every test.
std::int16_t valueAt(int x, int y, int z);
/// The samples of a chunk, padded with 7; \param isF  x slowest
Text chunkAt(int cx, int cy, int cz, bool isF = false, bool isBig = false, int side = kChunk);

Text zstdOf(const Text& text);
/// \param inner  blosc's own codec: "lz4"
Text bloscOf(const Text& text, const char* inner);
/// A block alone, without its size.
Text lz4BlockOf(const Text& text);
/// As numcodecs has it.
Text lz4Of(const Text& text);
/// With its CRC-32C behind it.
Text withSum(const Text& text);
Text same(const Text& text);

/// JSON whose keys are there once: of those that `text` has twice, with the last value.
Text withLastOfKeys(const Text& text);

/// A folder for a hierarchy, gone at the end of the test.
class ZarrFolder : public ::testing::Test {
protected:
    void SetUp() override;
    void TearDown() override { std::filesystem::remove_all(root_); }

    void put(const std::string& key, const Text& text) const;

    static Text metadata2(const std::string& compressor, const std::string& more = "",
                          const std::string& dtype = "<i2", const std::string& order = "C");
    static Text metadata3(const std::string& codecs, const std::string& more = "");

    /// All chunks, packed by `pack`, under prefix and numbers with a separator between.
    void putChunks(const std::string& prefix, const std::string& separator,
                   const std::function<Text(const Text&)>& pack, bool isF = false,
                   bool isBig = false) const;

    /// \param options  that it was read with
    void expectValues(const ReadVolume& read, const ReadOptions& options = {}) const {
        expectValues(read, root_, options);
    }
    static void expectValues(const ReadVolume& read, const std::filesystem::path& folder,
                             const ReadOptions& options = {});
    /// What ImageRegions reads, over and beside the walls of chunks.
    static void expectParts(const std::filesystem::path& folder, const ReadOptions& options);

    void expectRefused(const std::string& reason, const ReadOptions& options = {}) const;

    std::filesystem::path root_;
};

}  // namespace adaptiso::testing
