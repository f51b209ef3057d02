// Decompression bombs are refused by their size.
#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

constexpr std::int16_t kSide = 256;

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
