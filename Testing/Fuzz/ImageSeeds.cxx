// NIfTI, MGH, NRRD and MetaImage. 4 x 3 x 2 samples, so that mutations hit headers.

#include "Seeds.h"
#include "Unit/ImageIO/Fixtures.h"

namespace adaptiso::fuzz {
namespace {

using testing::bytesOf;
using testing::gzipped;
using testing::NiftiFile;
using testing::put;
using testing::zlibbed;

constexpr std::endian kBig = std::endian::big;

std::string shortSamples(std::endian order = std::endian::little) {
    return testing::samplesOf(testing::countingSamples<std::int16_t>(24), order);
}

std::string nifti2() {
    std::string h(544, '\0');
    put<std::int32_t>(h, 0, 540);
    h.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
    put<std::int16_t>(h, 12, 4);
    put<std::int16_t>(h, 14, 16);
    const std::int64_t dim[] = {3, 4, 3, 2, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) {
        put(h, 16 + 8 * i, dim[i]);
        put(h, 104 + 8 * i, 1.5);
    }
    put<std::int64_t>(h, 168, 544);
    put(h, 176, 2.0);
    put<std::int32_t>(h, 344, 1);
    put<std::int32_t>(h, 500, 2);
    return h + shortSamples();
}

void addNiftiSeeds(Seeds& seeds) {
    NiftiFile plain;
    seeds.add("nii", plain.bytes());
    NiftiFile placed;
    placed.sformCode = placed.qformCode = 1;
    placed.sform = {2, 0, 0, -9, 0, 2, 0, 5, 0, 0, 3, 1};
    placed.quaternion = {0, 0, 0.5};
    placed.slope = 2;
    placed.units = 10;
    seeds.add("nii", placed.bytes());
    seeds.add("nii", gzipped(placed.bytes()));
    NiftiFile big;
    big.order = kBig;
    big.data = shortSamples(kBig);
    seeds.add("nii", big.bytes());
    NiftiFile several;
    several.dim = {4, 4, 3, 2, 2, 1, 1, 1};
    several.data += several.data;
    seeds.add("nii", several.bytes());
    NiftiFile header;  // of a pair: FuzzImage.cxx puts x.img beside it
    header.magic = std::string("ni1\0", 4);
    header.dataOffset = 0;
    seeds.add("nii", header.header());
    seeds.add("nii", nifti2());
    std::string mangled = nifti2();
    mangled.erase(8, 1);  // "\r\n" to "\n"
    seeds.add("nii", mangled);
    NiftiFile steep = placed;
    steep.slope = 1e37F;
    seeds.add("nii", steep.bytes());
    seeds.add("nii", plain.bytes() + plain.data);  // another volume
    seeds.add("nii", plain.bytes() + "a note");
    seeds.add("nii", gzipped(plain.bytes()) + zlibbed(plain.data));
}

void addMghSeeds(Seeds& seeds) {
    std::string h(284, '\0');
    const std::int32_t numbers[] = {1, 4, 3, 2, 1, 4};
    for (std::size_t i = 0; i < 6; ++i) put(h, 4 * i, numbers[i], kBig);
    put<std::int16_t>(h, 28, 1, kBig);
    const float geometry[] = {2, 3, 4, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
    for (std::size_t i = 0; i < 15; ++i) put(h, 30 + 4 * i, geometry[i], kBig);
    const std::string file = h + shortSamples(kBig);
    seeds.add("mgh", file);
    seeds.add("mgh", gzipped(file));
    // the footer: five numbers, then tags with their lengths
    const std::string tag = bytesOf<std::int32_t>(3, kBig) + bytesOf<std::int64_t>(11, kBig);
    const std::string footer = std::string(20, 'A') + tag + "mri_convert";
    const std::string xform = bytesOf<std::int32_t>(30, kBig) + bytesOf<std::int32_t>(4, kBig);
    seeds.add("mgh", file + footer);
    seeds.add("mgh", gzipped(file + footer + xform + "file"));
    seeds.add("mgh", file + footer + bytesOf<std::int32_t>(1, kBig) + "colours");
    seeds.add("mgh", file + shortSamples(kBig));
    put<std::int32_t>(h, 16, 2, kBig);
    seeds.add("mgh", h + shortSamples(kBig) + shortSamples(kBig));
    put<std::int16_t>(h, 28, 0, kBig);
    seeds.add("mgh", h + shortSamples(kBig) + shortSamples(kBig));
}

void addNrrdSeeds(Seeds& seeds) {
    const auto file = [](const std::string& fields, const std::string& data) {
        return "NRRD0004\n# a comment\nkey:=value\ntype: short\ndimension: 3\nsizes: 4 3 2\n" +
               fields + "\n" + data;
    };
    const std::string placed =
        "space: right-anterior-superior\nspace directions: (2,0,0) (0.5,3,0) (0,1,4)\nspace "
        "origin: (10,20,30)\nspace units: \"cm\" \"cm\" \"cm\"\nendian: little\nkinds: domain "
        "domain domain\n";
    seeds.add("nrrd", file(placed + "encoding: raw\n", shortSamples()));
    seeds.add("nrrd", file(placed + "encoding: gzip\n", gzipped(shortSamples())));
    std::string numbers;
    for (int n = 0; n < 24; ++n) numbers += std::to_string(n) + (n % 4 == 3 ? "\n" : " ");
    seeds.add("nrrd", file("encoding: ascii\nspacings: 1 2 3\n", numbers));
    seeds.add("nrrd", file("encoding: ascii\nspacings: 1 2 3\nunits: \"um\" \"mm\" cm\n", numbers));
    seeds.add("nrrd", file("encoding: text\nspacings: 1 2 3\n", numbers + "1.5e1, -7 nan 99999\n"));
    seeds.add("nrrd",
              "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: txt\n\n"
              "0 1e3 -0.5, inf nan 3.4e38 1e-40 7\n");
    seeds.add("nrrd", file("endian: big\nencoding: hex\n", std::string(96, 'a')));
    seeds.add("nrrd", file(placed + "encoding: raw\nline skip: 1\nbyte skip: 2\n",
                           "\n12" + shortSamples()));
    seeds.add("nrrd", file(placed + "encoding: raw\nbyte skip: -1\ndata file: x.raw\n", ""));
    seeds.add("nrrd", file(placed + "encoding: gzip\nbyte skip: -1\n",
                           gzipped("a header" + shortSamples())));
    // another image's file, and line ends of Windows, in the place of samples
    seeds.add("nrrd", file(placed + "encoding: raw\nbyte skip: -1\n",
                           file("encoding: raw\n", shortSamples())));
    seeds.add("nrrd", file(placed + "encoding: raw\n", "\r\n" + shortSamples()));
    seeds.add("nrrd",
              "NRRD0005\ntype: float\ndimension: 4\nspace: LPS\nsizes: 2 3 2 2\nspace directions: "
              "none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nendian: little\n"
              "encoding: raw\n\n" +
                  std::string(96, '\0'));
}

void addMetaImageSeeds(Seeds& seeds) {
    const auto header = [](const std::string& fields, const std::string& data) {
        return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
               "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\n"
               "DimSize = 4 3 2\n" +
               fields + "ElementType = MET_SHORT\nElementDataFile = " + data;
    };
    seeds.add("mha", header("", "LOCAL\n" + shortSamples()));
    const std::string packed = zlibbed(shortSamples());
    seeds.add("mha", header("CompressedData = True\nCompressedDataSize = " +
                                std::to_string(packed.size()) + "\n",
                            "LOCAL\n" + packed));
    seeds.add("mha", header("ElementToIntensityFunctionSlope = 2\n"
                            "ElementToIntensityFunctionOffset = -1\nPosition = 10 20 30\n",
                            "LOCAL\n" + shortSamples() + shortSamples()));
    seeds.add("mha", header("CompressedData = True\n", "LOCAL\n" + packed + packed));
    seeds.add("mha", header("HeaderSize = -1\nDistanceUnits = mm\n", "x.raw\n"));
    seeds.add("mha", header("Kinds = domain domain list\n", "a b%03d 100%.raw 1 2\n"));
    seeds.add("mha", header("Seq_Frame0000_ImageStatus = OK\n", "LIST 2\nx.raw\n"));
    seeds.add("mha", header("HeaderSize = 4\nElementNumberOfChannels = 1\n", "x.raw\n"));
    seeds.add(
        "mha",
        "NDims = 4\nDimSize = 4 3 2 1\nBinaryData = True\nElementByteOrderMSB = True\n"
        "Orientation = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nPosition = 1 2 3 4\nElementSize = 1 1 "
        "1 1\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
            shortSamples());
}

}  // namespace

void addImageSeeds(Seeds& seeds) {
    addNiftiSeeds(seeds);
    addMghSeeds(seeds);
    addNrrdSeeds(seeds);
    addMetaImageSeeds(seeds);
}

}  // namespace adaptiso::fuzz
