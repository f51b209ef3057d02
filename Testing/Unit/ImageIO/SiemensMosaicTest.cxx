#include <gtest/gtest.h>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr int kMosaicSlices = 7, kTiles = 3;
constexpr double kSliceStepMm = 2.5;

struct CsaItem {
    std::string name;
    std::vector<std::string> values;
};

/// A CSA header of version 2 ("SV10") or 1, as Siemens writes them.
std::string csaHeader(const std::vector<CsaItem>& items, int version) {
    std::string bytes = version == 2 ? std::string("SV10\4\3\2\1", 8) : std::string();
    bytes += bytesOf(static_cast<std::uint32_t>(items.size())) + bytesOf(std::uint32_t{77});
    const auto firstCount = static_cast<std::int32_t>(items.front().values.size());
    for (const CsaItem& item : items) {
        std::string name = item.name;
        name.resize(64, '\0');
        const auto count = static_cast<std::int32_t>(item.values.size());
        bytes += name + bytesOf(count) + std::string("FD\0\0", 4) + bytesOf(std::int32_t{4}) +
                 bytesOf(count) + bytesOf(std::int32_t{77});
        for (std::string value : item.values) {
            const auto length = static_cast<std::int32_t>(value.size());
            bytes += bytesOf(version == 2 ? length : length + firstCount);
            bytes += bytesOf(length) + bytesOf(std::int32_t{77}) + bytesOf(length);
            value.resize((value.size() + 3) / 4 * 4, '\0');
            bytes += value;
        }
    }
    return bytes;
}

std::string csaOf(const Vec3& normal, int version = 2) {
    return csaHeader(
        {{"EchoLinePosition", {"32"}},
         {"NumberOfImagesInMosaic", {std::to_string(kMosaicSlices)}},
         {"Empty", {}},
         {"SliceNormalVector",
          {std::to_string(normal.x), std::to_string(normal.y), std::to_string(normal.z)}}},
        version);
}

/// Seven slices as tiles of a 3 x 3 mosaic, the first one's first voxel at (1, 2, 3).
DicomBuilder mosaic(const Field& field, const Vec3& normal, const std::string& csa) {
    std::vector<std::uint16_t> samples(kTiles * kTiles * kColumns * kRows, 0);
    for (int k = 0; k < kMosaicSlices; ++k) {
        const auto tile =
            sampleSlice(field, kColumns, kRows, Vec3{1, 2, 3} + k * kSliceStepMm * normal);
        for (int j = 0; j < kRows; ++j) {
            for (int i = 0; i < kColumns; ++i) {
                const int row = k / kTiles * kRows + j, column = k % kTiles * kColumns + i;
                samples[static_cast<std::size_t>(row * kTiles * kColumns + column)] =
                    tile[static_cast<std::size_t>(j * kColumns + i)];
            }
        }
    }
    DicomBuilder image = dicomImage(kTiles * kColumns, kTiles * kRows);
    // the position is that of an image of the mosaic's size around the slice's centre
    const double halfColumns = (kTiles - 1) * kColumns / 2.0, halfRows = (kTiles - 1) * kRows / 2.0;
    placeDicom(image, {1 - halfColumns * 0.5, 2 - halfRows * 0.75, 3});
    image.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC")
        .text(0x00180088, "DS", std::to_string(kSliceStepMm))
        .text(0x00290010, "LO", "SIEMENS CSA HEADER")
        .pixels(samples);
    if (!csa.empty()) image.bytes(0x00291010, "OB", csa);
    return image;
}

TEST(SiemensMosaic, IsCutIntoItsSlices) {
    for (const int version : {1, 2}) {
        const TempFolder folder;
        const Vec3 up{0, 0, 1};
        const ReadVolume read =
            readVolume(writeFile(folder / "x", mosaic(tellTale, up, csaOf(up, version)).file()));
        const ImageGeometry& g = read.volume.view().geometry();
        EXPECT_EQ(g.size, (Index3{kColumns, kRows, kMosaicSlices}));
        expectNear(g.originMm, {1, 2, 3}, 1e-12);
        expectField(read.volume, tellTale);
        EXPECT_TRUE(read.warnings.empty());
    }
}

TEST(SiemensMosaic, TilesMayStackAgainstTheNormal) {
    const TempFolder folder;
    const Vec3 down{0, 0, -1};
    const ReadVolume read =
        readVolume(writeFile(folder / "x", mosaic(tellTale, down, csaOf(down)).file()));
    expectNear(read.volume.view().geometry().originMm, {1, 2, 3 - 6 * kSliceStepMm}, 1e-12);
    expectField(read.volume, tellTale);
}

TEST(SiemensMosaic, MoreTilesThanItsHeaderCountsAreRefused) {
    const TempFolder folder;
    const Vec3 up{0, 0, 1};
    const auto counted = [&](const char* count) {
        const std::string csa = csaHeader(
            {{"NumberOfImagesInMosaic", {count}}, {"SliceNormalVector", {"0", "0", "1"}}}, 2);
        return writeFile(folder / "x", mosaic(tellTale, up, csa).file());
    };
    expectRefusal(counted("6"), "of 6 slices by its header, but its tile 7 holds an image too");
    expectRefusal(counted("5"), "but its tile 6 holds an image too");
    EXPECT_NO_THROW(readVolume(counted("7")));
    const ReadVolume read = readVolume(counted("8"));  // the last one is blank
    ASSERT_EQ(read.warnings.size(), 1U);
    EXPECT_NE(read.warnings[0].text.find("counts 8 slices (NumberOfImagesInMosaic), 1 of them"),
              std::string::npos);
}

TEST(SiemensMosaic, SeveralAreVolumes) {
    const TempFolder folder;
    for (int v = 0; v < 2; ++v) {
        const auto field = [v](const Vec3& p) { return tellTale(p) + 100 * v; };
        writeFile(folder / std::to_string(v), mosaic(field, {0, 0, 1}, csaOf({0, 0, 1}))
                                                  .text(0x00200012, "IS", std::to_string(2 - v))
                                                  .file());
    }
    expectRefusal(folder.path(),
                  "4-D image: 2 volumes at the same position (acquisitions; mosaics");
    const ReadVolume read = readVolume(folder.path(), {.volumeIndex = 1});
    expectField(read.volume, tellTale);  // acquisition 2
}

TEST(SiemensMosaic, WithoutWhatItTakesIsRefusedByName) {
    const TempFolder folder;
    const Vec3 up{0, 0, 1};
    const auto refused = [&](const DicomBuilder& image, std::string_view why) {
        const auto file = writeFile(folder / "x", image.file());
        expectRefusal(file, "is a Siemens mosaic");
        expectRefusal(file, why);
    };
    refused(mosaic(tellTale, up, ""), "no CSA header");
    refused(mosaic(tellTale, up, csaOf(up)).text(0x00290010, "LO", "OTHER MAKER"), "no CSA header");
    refused(mosaic(tellTale, up, csaHeader({{"NumberOfImagesInMosaic", {"7"}}}, 2)),
            "no CSA header");
    refused(mosaic(tellTale, up, csaOf({0, 1, 0})), "another direction");
    refused(mosaic(tellTale, up, csaOf(up)).without(0x00180088), "SpacingBetweenSlices");
    refused(mosaic(tellTale, up, csaOf(up)).without(0x00200032), "where it lies");
    for (const char* count : {"0", "-7", "26", "3.5", "1e9"}) {  // 26: 6 x 6 tiles do not fit
        refused(mosaic(tellTale, up,
                       csaHeader({{"NumberOfImagesInMosaic", {count}},
                                  {"SliceNormalVector", {"0", "0", "1"}}},
                                 2)),
                "can't be cut into tiles");
    }
}

TEST(SiemensMosaic, ACutCsaHeaderIsRefusedWhereverItEnds) {
    const TempFolder folder;
    for (const int version : {1, 2}) {
        const std::string whole = csaOf({0, 0, 1}, version);
        for (std::size_t length = 0; length < whole.size() - 12; length += 6) {
            expectRefusal(writeFile(folder / "x",
                                    mosaic(tellTale, {0, 0, 1}, whole.substr(0, length)).file()),
                          "is a Siemens mosaic");
        }
    }
}

}  // namespace
}  // namespace adaptiso::testing
