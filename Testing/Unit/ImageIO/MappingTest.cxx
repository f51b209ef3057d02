// Large files: mapped where that is safe, else read; decompression bombs are told by their size.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "Fixtures.h"
#include "MappedFile.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/MappedInput.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr std::int16_t kSide = 256;  // 256^3 bytes are just enough to be mapped
static_assert(std::uint64_t{kSide} * kSide * kSide == detail::kLeastMappedBytes);

NiftiFile bigFile() {
    NiftiFile file;
    file.sformCode = 1;
    file.sform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    file.dim = {3, kSide, kSide, kSide, 1, 1, 1, 1};
    file.datatype = 2, file.bitpix = 8;
    file.data.resize(std::size_t{kSide} * kSide * kSide);
    for (std::size_t i = 0; i < file.data.size(); ++i) {
        file.data[i] = static_cast<char>(i * 7 + i / 999);
    }
    return file;
}

ReadOptions mapping() {
    ReadOptions options;
    options.mapFiles = true;
    return options;
}

bool isMapped(const ReadVolume& read) {
    return mappedFileAt(read.volume.view().samples()) != nullptr;
}

bool sameSamples(const VolumeView& a, const VolumeView& b) {
    return a.byteCount() == b.byteCount() &&
           std::memcmp(a.samples(), b.samples(), a.byteCount()) == 0;
}

/// Whether this file system grants leases at all.
bool canLease(const TempFolder& folder) {
    const auto file = writeFile(folder / "lease", "x");
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const bool can = ::fcntl(descriptor, F_SETLEASE, F_RDLCK) == 0;
    ::close(descriptor);
    return can;
}

TEST(Mapping, GivesTheSamplesThatReadingGives) {
    const TempFolder folder;
    if (!canLease(folder)) GTEST_SKIP() << "this file system grants no leases";
    const auto file = writeFile(folder / "x.nii", bigFile().bytes());
    const ReadVolume read = readVolume(file);
    EXPECT_FALSE(isMapped(read));
    const void* samples = nullptr;
    {
        const ReadVolume mapped = readVolume(file, mapping());
        ASSERT_TRUE(isMapped(mapped));
        samples = mapped.volume.view().samples();
        EXPECT_STREQ(mappedFileAt(samples), file.c_str());
        EXPECT_TRUE(sameSamples(mapped.volume, read.volume));
        EXPECT_EQ(mapped.volume.view().geometry(), read.volume.view().geometry());
    }
    EXPECT_EQ(mappedFileAt(samples), nullptr);
}

TEST(Mapping, LeavesWhatMustBeChangedToReading) {
    const TempFolder folder;
    const auto expectRead = [&](NiftiFile file, const char* why) {
        const auto path = writeFile(folder / "x.nii", file.bytes());
        const ReadVolume result = readVolume(path, mapping());
        EXPECT_FALSE(isMapped(result)) << why;
        EXPECT_TRUE(sameSamples(result.volume, readVolume(path).volume)) << why;
    };
    NiftiFile file = bigFile();
    file.slope = 2;
    expectRead(file, "scaled");
    file = bigFile();
    file.dim[3] = kSide / 2, file.datatype = 4, file.bitpix = 16;
    file.order = std::endian::big;
    expectRead(file, "of the other byte order");
    file.order = std::endian::little;
    file.dataOffset = 353, file.data += "x";
    expectRead(file, "int16 at an odd address");
    file = bigFile();
    file.dim[3] = kSide - 1;
    file.data.resize(std::size_t{kSide} * kSide * (kSide - 1));
    expectRead(file, "small");
    const auto zipped = writeFile(folder / "x.nii.gz", gzipped(bigFile().bytes()));
    EXPECT_FALSE(isMapped(readVolume(zipped, mapping())));
}

TEST(Mapping, LeavesFilesThatAreBeingWrittenToReading) {
    const TempFolder folder;
    const auto file = writeFile(folder / "x.nii", bigFile().bytes());
    const std::ofstream writer(file, std::ios::app);
    EXPECT_FALSE(isMapped(readVolume(file, mapping())));
}

TEST(Mapping, HoldsWritersBackWhileTheVolumeLives) {
    const TempFolder folder;
    if (!canLease(folder)) GTEST_SKIP() << "this file system grants no leases";
    const auto file = writeFile(folder / "x.nii", bigFile().bytes());
    const auto canBeWritten = [&] {
        const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
        if (descriptor >= 0) ::close(descriptor);
        return descriptor >= 0;
    };
    {
        const ReadVolume mapped = readVolume(file, mapping());
        ASSERT_TRUE(isMapped(mapped));
        EXPECT_FALSE(canBeWritten());
    }
    EXPECT_TRUE(canBeWritten());
}

TEST(Mapping, WorksForDetachedMetaImageAndNrrd) {
    const TempFolder folder;
    if (!canLease(folder)) GTEST_SKIP() << "this file system grants no leases";
    writeFile(folder / "x.raw", bigFile().data);
    const auto meta = writeFile(
        folder / "x.mhd",
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
        "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 1\n"
        "DimSize = 256 256 256\nElementType = MET_UCHAR\nElementDataFile = x.raw\n");
    const auto nrrd =
        writeFile(folder / "x.nhdr",
                  "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 256 256 256\n"
                  "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\ndata file: x.raw\n");
    const ReadVolume expected = readVolume(meta);
    for (const auto& file : {meta, nrrd}) {
        const ReadVolume mapped = readVolume(file, mapping());
        EXPECT_TRUE(isMapped(mapped)) << file;
        EXPECT_TRUE(sameSamples(mapped.volume, expected.volume));
    }
}

TEST(Mapping, RefusesTruncation) {
    const TempFolder folder;
    const std::string bytes = bigFile().bytes();
    const auto file = writeFile(folder / "x.nii", bytes.substr(0, bytes.size() - 1));
    EXPECT_THROW(readVolume(file, mapping()), FileError);
}

/// `head`, then `zeros` zeros, gzipped as one member each so that neither is ever whole in memory.
std::string bomb(const std::string& head, std::size_t zeros) {
    constexpr std::size_t kPiece = std::size_t{16} << 20;
    const std::string piece = gzipped(std::string(kPiece, '\0'));
    std::string bytes = gzipped(head);
    for (std::size_t done = 0; done < zeros; done += kPiece) bytes += piece;
    return bytes;
}

TEST(DecompressionBomb, IsToldByItsSizeBeforeItIsInflated) {
    const TempFolder folder;
    NiftiFile file = bigFile();
    file.dim = {3, 2048, 1024, 1024, 1, 1, 1, 1};  // 2 GiB of uint8
    file.data.clear();
    const std::string nifti = bomb(file.bytes(), std::size_t{2} << 30);
    expectRefusal(writeFile(folder / "x.nii.gz", nifti), "decompression bomb");
    const std::string nrrd =
        "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 2048 1024 1024\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: gzip\n\n";
    expectRefusal(writeFile(folder / "x.nrrd", nrrd + bomb("", std::size_t{2} << 30)),
                  "decompression bomb");
}

TEST(DecompressionBomb, IsNoSmallEmptyMask) {
    const TempFolder folder;
    NiftiFile file = bigFile();
    file.data.assign(file.data.size(), '\0');  // compresses about a thousandfold
    EXPECT_EQ(valueRange(readVolume(writeFile(folder / "x.nii.gz", gzipped(file.bytes()))).volume)
                  .maximum,
              0);
}

}  // namespace
}  // namespace adaptiso::testing
