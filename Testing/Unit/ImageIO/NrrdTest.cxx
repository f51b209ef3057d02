#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

struct NrrdFile {
    std::string type = "short", dimension = "3", sizes = "4 3 2";
    std::string space = "space: left-posterior-superior\n";
    std::string directions = "space directions: (2,0,0) (0.5,3,0) (0,1,4)\n";
    std::string origin = "space origin: (10,20,30)\n";
    std::string encoding = "raw", extra;

    std::string header() const {
        return "NRRD0004\n# a comment\ntype: " + type + "\ndimension: " + dimension + "\n" + space +
               "sizes: " + sizes + "\n" + directions + origin +
               "endian: little\nkinds: domain domain domain\nencoding: " + encoding + "\n" + extra;
    }
};

ReadVolume read(const NrrdFile& file, const std::string& data = kSamples,
                const ReadOptions& options = {}) {
    const TempFolder folder;
    return readVolume(writeFile(folder / "x.nrrd", file.header() + "\n" + data), options);
}

void expectRefusedNrrd(const NrrdFile& file, std::string_view fault,
                       const std::string& data = kSamples) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.nrrd", file.header() + "\n" + data), fault);
}

TEST(NrrdGeometry, KeepsShearInEverySpace) {
    struct Case {
        const char* space;
        double signX, signY;
    };
    // the last corner in the file's own space: x = 2 * 3 + 0.5 * 2 + 10 = 17, y = 27, z = 34
    for (const Case& c : {Case{"left-posterior-superior", 1, 1}, Case{"LPS", 1, 1},
                          Case{"right-anterior-superior", -1, -1}, Case{"RAS", -1, -1},
                          Case{"left-anterior-superior", 1, -1}, Case{"LAS", 1, -1}}) {
        NrrdFile file;
        file.space = std::string("space: ") + c.space + "\n";
        const ReadVolume result = read(file);
        const ImageGeometry& g = result.volume.view().geometry();
        expectNear(g.toPhysical({0, 0, 0}), {c.signX * 10, c.signY * 20, 30}, 0);
        expectNear(g.toPhysical({3, 2, 1}), {c.signX * 17, c.signY * 27, 34}, 0);
        EXPECT_EQ(samplesIn<std::int16_t>(result.volume), countingSamples<std::int16_t>(24));
        EXPECT_TRUE(result.warnings.empty());
    }
}

TEST(NrrdGeometry, UnitsBecomeMillimetres) {
    NrrdFile file;
    file.extra = "space units: \"cm\" \"cm\" \"cm\"\n";
    expectNear(read(file).volume.view().geometry().originMm, {100, 200, 300}, 0);
    file.extra = "space units: \"parsec\" \"parsec\" \"parsec\"\n";
    expectRefusedNrrd(file, "unit 'parsec'");
    file.extra = "space units: \"mm\" \"cm\" \"mm\"\n";
    expectRefusedNrrd(file, "differ");
}

std::vector<std::string> codesOf(const ReadVolume& read) {
    std::vector<std::string> codes;
    for (const Warning& warning : read.warnings) codes.push_back(warning.code);
    return codes;
}

TEST(NrrdGeometry, UnitsOfSpacingsBecomeMillimetres) {
    NrrdFile file;
    file.space = file.directions = file.origin = "";
    const std::string spacings = "spacings: 2 3 4\n";
    file.extra = spacings + "units: \"microns\" \"um\" \"micrometer\"\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {0.002, 0.003, 0.004}, 1e-12);
    EXPECT_EQ(codesOf(read(file)),
              (std::vector<std::string>{"unit-converted", "guessed-orientation"}));
    file.extra = spacings + "space units: \"um\" \"um\" \"um\"\n";  // without a space
    expectNear(read(file).volume.view().geometry().spacingMm(), {0.002, 0.003, 0.004}, 1e-12);
    // each axis has its own
    file.extra = spacings + "units: \"mm\" \"cm\" \"um\"\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 30, 0.004}, 1e-12);
    file.extra = spacings + "units: \"mm\" \"mm\" \"mm\"\n";
    EXPECT_EQ(codesOf(read(file)), std::vector<std::string>{"guessed-orientation"});
    file.extra = spacings + "units: \"\" \" \" \"\"\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 3, 4}, 0);
    file.extra = spacings + "units: \"um\" \"\" \"\"\n";
    expectRefusedNrrd(file, "some of its axes in space have a unit, others none");
    file.extra = spacings + "units: \"mm\" \"\" \"mm\"\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 3, 4}, 0);
    file.extra = spacings + "units: \"um\" \"um\"\n";
    expectRefusedNrrd(file, "2 units for 3 axes");
    file.extra = spacings + "units: \"um\" \"um\" \"a b\"\n";
    expectRefusedNrrd(file, "unit 'a b'");
    file.extra = "";
    EXPECT_EQ(codesOf(read(file)),
              (std::vector<std::string>{"guessed-spacing", "guessed-orientation"}));
}

TEST(NrrdGeometry, SpacingsThatContradictTheDirectionsAreRefused) {
    NrrdFile file;
    file.directions = "space directions: (2,0,0) (0,3,0) (0,0,4)\n";
    file.extra = "spacings: 2 3 4\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 3, 4}, 0);
    file.extra = "spacings: nan nan NaN\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 3, 4}, 0);
    file.extra = "spacings: 1.99 3 4\n";
    expectNear(read(file).volume.view().geometry().spacingMm(), {2, 3, 4}, 0);
    file.extra = "spacings: 2 3 5\n";
    expectRefusedNrrd(file, "spacing of axis 2 is 5, and its space direction is 4 long");
    file.extra = "units: \"um\" \"um\" \"um\"\n";
    expectRefusedNrrd(file, "units and space units differ");
}

TEST(NrrdGeometry, RefusesSpacesThatDoNotNameTheSides) {
    NrrdFile file;
    file.space = "space: scanner-xyz\n";
    expectRefusedNrrd(file, "space 'scanner-xyz'");
    file.space = "space dimension: 3\n";
    expectRefusedNrrd(file, "no named space");
    expectRefusedNrrd(file, "--image-space lps or ras");
}

TEST(NrrdGeometry, TakesTheGivenSpaceWhereItNamesNone) {
    for (const char* const space : {"space: scanner-xyz\n", "space dimension: 3\n"}) {
        NrrdFile file;
        file.space = space;
        const ReadVolume lps = read(file, kSamples, {.space = ImageSpace::Lps});
        expectNear(lps.volume.view().geometry().toPhysical({3, 2, 1}), {17, 27, 34}, 0);
        const ReadVolume ras = read(file, kSamples, {.space = ImageSpace::Ras});
        expectNear(ras.volume.view().geometry().toPhysical({3, 2, 1}), {-17, -27, 34}, 0);
        EXPECT_TRUE(ras.warnings.empty());
    }
    NrrdFile file;
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.nrrd", file.header() + "\n" + kSamples),
                  "leave --image-space out", {.space = ImageSpace::Ras});
    file.space = file.directions = file.origin = "";
    file.extra = "spacings: 2 3 4\n";
    const ReadVolume spaced = read(file, kSamples, {.space = ImageSpace::Ras});
    EXPECT_EQ(spaced.volume.view().geometry().indexToPhysical, Mat3::diagonal(-2, -3, 4));
    ASSERT_EQ(spaced.warnings.size(), 1U);
    EXPECT_EQ(spaced.warnings[0].code, "guessed-position");
}

TEST(NrrdGeometry, WithoutSpaceTakesSpacingsAndWarns) {
    NrrdFile file;
    file.space = file.directions = file.origin = "";
    file.extra = "spacings: 2 3 4\n";
    const ReadVolume result = read(file);
    EXPECT_EQ(result.volume.view().geometry().indexToPhysical, Mat3::diagonal(2, 3, 4));
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_NE(result.warnings[0].text.find("no space field"), std::string::npos);
    file.extra = "spacings: 2 nan 4\n";
    expectRefusedNrrd(file, "spacing 'nan'");
}

TEST(NrrdHeader, RefusesDamage) {
    const auto refused = [](auto change, std::string_view fault) {
        NrrdFile file;
        change(file);
        expectRefusedNrrd(file, fault);
    };
    refused([](NrrdFile& f) { f.directions = "space directions: (1,0,0) (0,1,0)\n"; },
            "2 space directions");
    refused([](NrrdFile& f) { f.directions = "space directions: (1,0,0) (0,1,0) none\n"; },
            "space directions");
    refused([](NrrdFile& f) { f.directions = "space directions: (1,0,0) (0,nan,0) (0,0,1)\n"; },
            "space directions");
    refused([](NrrdFile& f) { f.sizes = "4 3"; }, "2 sizes");
    refused([](NrrdFile& f) { f.sizes = "4 x 2"; }, "size 'x'");
    refused([](NrrdFile& f) { f.sizes = "4 0 2"; }, "4 x 0 x 2");
    refused([](NrrdFile& f) { f.sizes = "4000000000 4000000000 4000000000"; }, "memory");
    refused([](NrrdFile& f) { f.dimension = "4", f.sizes = "3 4 3 2"; }, "4 dimensions");
    refused([](NrrdFile& f) { f.type = "block"; }, "type 'block'");
    refused([](NrrdFile& f) { f.encoding = "bzip2"; }, "encoding 'bzip2'");
    refused([](NrrdFile& f) { f.extra = "type: short\n"; }, "twice");
    refused([](NrrdFile& f) { f.extra = "byte skip: -5\n"; }, "byte skip");
    refused([](NrrdFile& f) { f.extra = "byte skip: 99999999999\n"; }, "truncated");
}

TEST(NrrdHeader, NeverEchoesControlCharacters) {
    NrrdFile file;
    file.type = "\x1b[31mred";
    expectRefusedNrrd(file, "\\x1b[31mred");
}

TEST(NrrdData, RefusesTruncationInEveryEncoding) {
    NrrdFile file;
    expectRefusedNrrd(file, "truncated", kSamples.substr(1));
    file.encoding = "gzip";
    EXPECT_EQ(samplesIn<std::int16_t>(read(file, gzipped(kSamples)).volume),
              countingSamples<std::int16_t>(24));
    expectRefusedNrrd(file, "truncated", gzipped(kSamples.substr(2)));
    const std::string zipped = gzipped(kSamples);
    expectRefusedNrrd(file, "truncated", zipped.substr(0, zipped.size() - 4));
    file.encoding = "ascii";
    std::string text;
    for (int i = 0; i < 24; ++i) text += std::to_string(i) + " ";
    EXPECT_EQ(samplesIn<std::int16_t>(read(file, text).volume)[23], 23);
    expectRefusedNrrd(file, "23 of 24 numbers", text.substr(2));
}

TEST(NrrdData, DetachedDataMustLieBesideTheHeader) {
    const TempFolder folder;
    writeFile(folder / "x.raw", kSamples);
    std::filesystem::create_directory(folder / "sub");
    const auto header = [&](const std::string& dataFile) {
        NrrdFile file;
        file.extra = "data file: " + dataFile + "\n";
        return file.header();
    };
    EXPECT_EQ(
        samplesIn<std::int16_t>(readVolume(writeFile(folder / "x.nhdr", header("x.raw"))).volume),
        countingSamples<std::int16_t>(24));
    const auto inner = folder.path() / "sub" / "x.nhdr";
    expectRefusal(writeFile(inner, header("../x.raw")), "outside its own folder");
    expectRefusal(writeFile(inner, header((folder / "x.raw").native())), "outside its own folder");
    expectRefusal(writeFile(inner, header("x.nhdr")), "itself");
    expectRefusal(writeFile(inner, header("x%03d.raw 1 2 1")), "list or pattern");
    writeFile(folder / "x.raw", kSamples.substr(1));
    EXPECT_NE(refusalOf(folder / "x.nhdr").find("truncated"), std::string::npos);
}

TEST(NrrdData, ByteSkipMinusOneCountsFromTheEnd) {
    NrrdFile file;
    file.extra = "byte skip: -1\n";
    const TempFolder folder;
    writeFile(folder / "x.raw", "a header to skip" + kSamples);
    file.extra += "data file: x.raw\n";
    EXPECT_EQ(
        samplesIn<std::int16_t>(readVolume(writeFile(folder / "x.nhdr", file.header())).volume),
        countingSamples<std::int16_t>(24));
}

}  // namespace
}  // namespace adaptiso::testing
