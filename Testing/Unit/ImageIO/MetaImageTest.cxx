#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

struct MetaFile {
    std::string dimensions = "3", sizes = "4 3 2";
    std::string matrix = "TransformMatrix = 0 1 0 -1 0 0 0 0 1\n";
    std::string offset = "Offset = 10 20 30\n";
    std::string spacing = "ElementSpacing = 2 3 4\n";
    std::string type = "MET_SHORT", extra = "", dataFile = "LOCAL";

    std::string header() const {
        return "ObjectType = Image\nNDims = " + dimensions +
               "\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + matrix + offset + spacing +
               extra + "DimSize = " + sizes + "\nElementType = " + type +
               "\nElementDataFile = " + dataFile + "\n";
    }
};

ReadVolume read(const MetaFile& file, const std::string& data = kSamples) {
    const TempFolder folder;
    return readVolume(writeFile(folder / "x.mha", file.header() + data));
}

void expectRefusedMeta(const MetaFile& file, std::string_view fault,
                       const std::string& data = kSamples) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.mha", file.header() + data), fault);
}

TEST(MetaImageGeometry, RowsOfTheMatrixAreTheAxes) {
    const ReadVolume result = read(MetaFile());
    const ImageGeometry& g = result.volume.view().geometry();
    expectNear(g.originMm, {10, 20, 30}, 0);
    EXPECT_EQ(g.indexToPhysical.column[0], (Vec3{0, 2, 0}));
    EXPECT_EQ(g.indexToPhysical.column[1], (Vec3{-3, 0, 0}));
    EXPECT_EQ(g.indexToPhysical.column[2], (Vec3{0, 0, 4}));
    EXPECT_EQ(samplesIn<std::int16_t>(result.volume), countingSamples<std::int16_t>(24));
    EXPECT_EQ(result.format, "MetaImage");
    EXPECT_TRUE(result.warnings.empty());
}

TEST(MetaImageGeometry, FourthDimensionOfOneKeepsTheGeometry) {
    MetaFile file;
    file.dimensions = "4";
    file.sizes = "4 3 2 1";
    file.matrix = "TransformMatrix = 0 1 0 0 -1 0 0 0 0 0 1 0 0 0 0 1\n";
    file.offset = "Offset = 10 20 30 0\n";
    file.spacing = "ElementSpacing = 2 3 4 1\n";
    EXPECT_EQ(read(file).volume.view().geometry(), read(MetaFile()).volume.view().geometry());
    file.sizes = "2 3 2 2";
    expectRefusedMeta(file, "holds 2 volumes");
}

TEST(MetaImageHeader, RefusesDamage) {
    const auto refused = [](auto change, std::string_view fault) {
        MetaFile file;
        change(file);
        expectRefusedMeta(file, fault);
    };
    refused([](MetaFile& f) { f.dimensions = "0"; }, "NDims");
    refused([](MetaFile& f) { f.dimensions = "-3"; }, "NDims");
    refused([](MetaFile& f) { f.dimensions = "100000"; }, "NDims");
    refused([](MetaFile& f) { f.type = "MET_ODD"; }, "ElementType");
    refused([](MetaFile& f) { f.extra = "ElementNumberOfChannels = 3\n"; }, "3 channels");
    refused([](MetaFile& f) { f.spacing = "ElementSpacing = 2 0 4\n"; }, "spacing 0");
    refused([](MetaFile& f) { f.spacing = "ElementSpacing = 2 -3 4\n"; }, "spacing -3");
    refused([](MetaFile& f) { f.spacing = "ElementSpacing = 2 nan 4\n"; }, "nan");
    refused([](MetaFile& f) { f.offset = "Offset = 1 inf 3\n"; }, "inf");
    refused([](MetaFile& f) { f.matrix = "TransformMatrix = 1 0 0 1 0 0 0 0 1\n"; }, "singular");
    refused([](MetaFile& f) { f.extra = "DistanceUnits = cm\n"; }, "DistanceUnits");
    refused([](MetaFile& f) { f.dataFile = "/etc/passwd"; }, "outside its own folder");
    refused([](MetaFile& f) { f.dataFile = "../x.raw"; }, "outside its own folder");
    refused([](MetaFile& f) { f.dataFile = "x.mha"; }, "itself");
    refused([](MetaFile& f) { f.dataFile = "LIST"; }, "list or pattern");
    refused([](MetaFile& f) { f.dataFile = "x%03d.raw 1 2 1"; }, "list or pattern");
}

TEST(MetaImageData, RefusesTruncationPlainAndCompressed) {
    expectRefusedMeta(MetaFile(), "truncated", kSamples.substr(1));
    MetaFile file;
    const std::string zipped = zlibbed(kSamples);
    file.extra =
        "CompressedData = True\nCompressedDataSize = " + std::to_string(zipped.size()) + "\n";
    EXPECT_EQ(samplesIn<std::int16_t>(read(file, zipped).volume),
              countingSamples<std::int16_t>(24));
    expectRefusedMeta(file, "truncated", zipped.substr(0, zipped.size() / 2));
    expectRefusedMeta(file, "truncated", zlibbed(kSamples.substr(2)));
    expectRefusedMeta(file, "damaged", "not zlib at all" + kSamples);
}

TEST(MetaImageData, ReadsBigEndianAndDetachedData) {
    const TempFolder folder;
    std::string header = MetaFile{.dataFile = "x.raw"}.header();
    header.replace(header.find("MSB = False"), 11, "MSB = True");
    writeFile(folder / "x.raw", samplesOf(countingSamples<std::int16_t>(24), std::endian::big));
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(writeFile(folder / "x.mhd", header)).volume),
              countingSamples<std::int16_t>(24));
}

TEST(MetaImageData, NamesAreTheRestOfTheLine) {
    const TempFolder folder;
    for (const std::string name :
         {"CT Head.raw", "two  blanks.raw", "tab\tin it.raw", "My Scan (2).raw", "100% done.raw",
          "50%done 1 2 3.raw", "LISTED.raw", "local.raw", "a=b:c.raw", "sub dir/x.raw"}) {
        const auto data = folder.path() / name;
        std::filesystem::create_directories(data.parent_path());
        writeFile(data, kSamples);
        const auto header = writeFile(folder / "CT Head.mhd", MetaFile{.dataFile = name}.header());
        EXPECT_EQ(samplesIn<std::int16_t>(readVolume(header).volume),
                  countingSamples<std::int16_t>(24))
            << name;
        const auto nrrd = writeFile(folder / "CT Head.nhdr",
                                    "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: "
                                    "little\nencoding: raw\nspacings: 1 1 1\ndata file: " +
                                        name + "\n");
        EXPECT_EQ(samplesIn<std::int16_t>(readVolume(nrrd).volume),
                  countingSamples<std::int16_t>(24))
            << name;
    }
}

TEST(MetaImageData, NamesAreNoFormatStrings) {
    const TempFolder folder;
    const auto header = writeFile(folder / "x.mhd", MetaFile{.dataFile = "x%n%n.raw"}.header());
    EXPECT_NE(refusalOf(header).find("x%n%n.raw: no such file"), std::string::npos);
}

TEST(MetaImageGeometry, AListOfImagesIsRefused) {
    MetaFile file;
    file.extra = "Kinds = domain domain domain\n";
    EXPECT_TRUE(read(file).warnings.empty());
    for (const char* const kinds :
         {"domain domain list", "vector domain domain", "domain time ???"}) {
        file.extra = std::string("Kinds = ") + kinds + "\n";
        expectRefusedMeta(file, "not a direction in space");
    }
    file.extra = "Seq_Frame0000_ImageStatus = OK\n";
    expectRefusedMeta(file, "sequence of frames");
}

TEST(MetaImageGeometry, AnOriginBeyondEveryScannerIsRefused) {
    // its square is no double, nor do voxels of mm differ there
    expectRefusedMeta({.offset = "Offset = 10 -1e200 30\n"}, "implausible origin -1e+200 mm");
    expectRefusedMeta({.offset = "Offset = 1.1e9 0 0\n"}, "implausible origin 1.1e+09 mm");
    EXPECT_EQ(read({.offset = "Offset = 0 0 -1e9\n"}).volume.view().geometry().originMm,
              (Vec3{0, 0, -1e9}));
}

TEST(MetaImageData, LongIsFourBytesOnEveryMachine) {
    const ReadVolume result =
        read({.type = "MET_LONG"}, samplesOf(countingSamples<std::int32_t>(24)));
    ASSERT_EQ(result.volume.view().pixelType(), PixelType::Int32);
    EXPECT_EQ(samplesIn<std::int32_t>(result.volume), countingSamples<std::int32_t>(24));
}

TEST(MetaImageData, HonoursHeaderSize) {
    const TempFolder folder;
    writeFile(folder / "x.raw", std::string(16, 'h') + kSamples);
    for (const char* size : {"16", "-1"}) {
        MetaFile file{.dataFile = "x.raw"};
        file.extra = std::string("HeaderSize = ") + size + "\n";
        EXPECT_EQ(
            samplesIn<std::int16_t>(readVolume(writeFile(folder / "x.mhd", file.header())).volume),
            countingSamples<std::int16_t>(24))
            << size;
    }
    MetaFile file{.dataFile = "x.raw"};
    file.extra = "HeaderSize = 20\n";
    EXPECT_NE(refusalOf(writeFile(folder / "x.mhd", file.header())).find("truncated"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso::testing
