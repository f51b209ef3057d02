#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

// headers hold float32: 24 bits, so 1e-5 mm for coordinates below 100 mm
constexpr double kFloatMm = 1e-5;

ReadVolume read(const NiftiFile& file, std::string_view name = "x.nii") {
    const TempFolder folder;
    return readVolume(writeFile(folder / name, file.bytes()));
}

void expectRefusedNifti(const NiftiFile& file, std::string_view fault) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.nii", file.bytes()), fault);
}

NiftiFile withSform() {
    NiftiFile file;
    file.sformCode = 1;
    file.sform = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    return file;
}

template <class T>
struct NiftiCode;
template <>
struct NiftiCode<std::uint8_t> {
    static constexpr std::int16_t value = 2;
};
template <>
struct NiftiCode<std::int8_t> {
    static constexpr std::int16_t value = 256;
};
template <>
struct NiftiCode<std::uint16_t> {
    static constexpr std::int16_t value = 512;
};
template <>
struct NiftiCode<std::int16_t> {
    static constexpr std::int16_t value = 4;
};
template <>
struct NiftiCode<std::uint32_t> {
    static constexpr std::int16_t value = 768;
};
template <>
struct NiftiCode<std::int32_t> {
    static constexpr std::int16_t value = 8;
};
template <>
struct NiftiCode<std::uint64_t> {
    static constexpr std::int16_t value = 1280;
};
template <>
struct NiftiCode<std::int64_t> {
    static constexpr std::int16_t value = 1024;
};
template <>
struct NiftiCode<float> {
    static constexpr std::int16_t value = 16;
};
template <>
struct NiftiCode<double> {
    static constexpr std::int16_t value = 64;
};

template <class T>
class NiftiPixels : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(NiftiPixels, PixelTypes);

TYPED_TEST(NiftiPixels, KeepTypeAndEverySampleInBothByteOrders) {
    const auto samples = countingSamples<TypeParam>(24);
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        NiftiFile file = withSform();
        file.pixdim = {1, 2, 3, 4, 0, 0, 0, 0};
        file.order = order;
        file.datatype = NiftiCode<TypeParam>::value;
        file.bitpix = 8 * sizeof(TypeParam);
        file.data = samplesOf(samples, order);
        const ReadVolume result = read(file);
        ASSERT_EQ(result.volume.view().pixelType(), pixelTypeOf<TypeParam>());
        EXPECT_EQ(samplesIn<TypeParam>(result.volume), samples);
        EXPECT_EQ(result.format, "NIfTI-1");
        // the samples hold the smallest and largest values of their type
        const bool isBeyondDoubles = std::is_integral_v<TypeParam> && sizeof(TypeParam) == 8;
        EXPECT_EQ(result.warnings.size(), isBeyondDoubles ? 1U : 0U);
    }
}

TEST(NiftiSamples, SurviveTheReadersEnd) {
    const Volume copy = [] { return read(withSform()).volume; }();
    EXPECT_EQ(samplesIn<std::int16_t>(copy), countingSamples<std::int16_t>(24));
}

TEST(NiftiGeometry, TakesSformFromRasToLps) {
    const ImageGeometry g = read(withSform()).volume.view().geometry();
    EXPECT_EQ(g.size, (Index3{4, 3, 2}));
    expectNear(g.toPhysical({0, 0, 0}), {-10, -20, 30}, 0);  // whole numbers: exact
    expectNear(g.toPhysical({3, 2, 1}), {-16, -26, 34}, 0);
}

TEST(NiftiGeometry, KeepsShearedSform) {
    NiftiFile file = withSform();
    file.sform = {2, 0.5, 0, 10, 0, 3, 1, 20, 0, 0, 4, 30};  // ITK 5.2.1 throws or takes the qform
    const ImageGeometry g = read(file).volume.view().geometry();
    // RAS: x = 2 i + j / 2 + 10, y = 3 j + k + 20, z = 4 k + 30; (3, 2, 1) -> (17, 27, 34)
    expectNear(g.toPhysical({3, 2, 1}), {-17, -27, 34}, 0);
    EXPECT_EQ(g.indexToPhysical.column[2], (Vec3{0, -1, 4}));
}

TEST(NiftiGeometry, KeepsMirroredSform) {
    NiftiFile file = withSform();
    file.sform = {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    const ReadVolume mirrored = read(file);
    EXPECT_TRUE(mirrored.volume.view().geometry().isMirrored());
    EXPECT_FALSE(read(withSform()).volume.view().geometry().isMirrored());
}

TEST(NiftiGeometry, SformWinsOverQformWithAWarning) {
    NiftiFile file = withSform();
    file.qformCode = 1;
    file.pixdim = {1, 2, 3, 4, 0, 0, 0, 0};
    file.qoffset = {15, 20, 30};
    const ReadVolume result = read(file);
    expectNear(result.volume.view().geometry().originMm, {-10, -20, 30}, 0);
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_NE(result.warnings[0].text.find("differ by up to 5 mm"), std::string::npos);

    file.qoffset = {10, 20, 30};  // now both agree
    EXPECT_TRUE(read(file).warnings.empty());
}

TEST(NiftiGeometry, FormsAreComparedToATenthOfAVoxel) {
    NiftiFile file = withSform();
    file.qformCode = 1;
    file.pixdim = {1, 2, 3, 4, 0, 0, 0, 0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float spacing = file.pixdim[axis + 1];
        file.qoffset = {10, 20, 30};
        file.qoffset[axis] += 0.09F * spacing;
        EXPECT_TRUE(read(file).warnings.empty()) << axis;
        file.qoffset[axis] += 0.02F * spacing;
        EXPECT_EQ(read(file).warnings.size(), 1U) << axis;
    }
    // the origins agree, the far corners do not: 3 voxels are 6.75 mm and 6 mm long
    file.qoffset = {10, 20, 30};
    file.pixdim[1] = 2.25F;
    EXPECT_NE(read(file).warnings.back().text.find("differ by up to 0.75 mm; the sform"),
              std::string::npos);
}

TEST(NiftiGeometry, SidesThatFormsExchangeAreNamed) {
    struct Case {
        std::array<float, 3> quaternion;  ///< about x, y or z by half a turn
        float qfac;
        std::vector<std::string> exchanged;
    };
    const std::string sides[] = {"left and right", "front and back", "top and bottom"};
    for (const Case& c :
         {Case{{0, 0, 0}, 1, {}}, Case{{0, 0, 0}, -1, {sides[2]}}, Case{{1, 0, 0}, -1, {sides[1]}},
          Case{{0, 1, 0}, -1, {sides[0]}}, Case{{0, 0, 1}, 1, {sides[0], sides[1]}}}) {
        NiftiFile file = withSform();
        file.qformCode = 1;
        file.pixdim = {c.qfac, 2, 3, 4, 0, 0, 0, 0};
        file.quaternion = c.quaternion;
        file.qoffset = {15, 20, 30};
        const std::vector<Warning> warnings = read(file).warnings;
        ASSERT_EQ(warnings.size(), 1U);
        for (const std::string& side : sides) {
            const bool isNamed =
                warnings[0].text.find(side + " are exchanged") != std::string::npos;
            EXPECT_EQ(isNamed, std::ranges::count(c.exchanged, side) == 1) << warnings[0].text;
        }
    }
}

TEST(NiftiGeometry, TakesObliqueQform) {
    NiftiFile file;
    file.qformCode = 1;
    file.pixdim = {1, 2, 3, 4, 0, 0, 0, 0};
    // 30 degrees about z: quaternion (cos 15, 0, 0, sin 15)
    file.quaternion = {0, 0, static_cast<float>(std::sin(std::acos(-1.0) / 12))};
    file.qoffset = {10, 20, 30};
    const ImageGeometry g = read(file).volume.view().geometry();
    const double c = std::sqrt(0.75), s = 0.5;
    // RAS: i -> 2 (c, s, 0), j -> 3 (-s, c, 0), k -> (0, 0, 4)
    expectNear(g.toPhysical({3, 0, 0}), {-(10 + 6 * c), -(20 + 6 * s), 30}, kFloatMm);
    expectNear(g.toPhysical({0, 2, 0}), {-(10 - 6 * s), -(20 + 6 * c), 30}, kFloatMm);
    expectNear(g.toPhysical({0, 0, 1}), {-10, -20, 34}, kFloatMm);
}

TEST(NiftiGeometry, QfacMinusOneTurnsTheThirdAxis) {
    NiftiFile file;
    file.qformCode = 1;
    file.pixdim = {-1, 2, 3, 4, 0, 0, 0, 0};
    const ImageGeometry g = read(file).volume.view().geometry();
    expectNear(g.toPhysical({0, 0, 1}), {0, 0, -4}, kFloatMm);
}

TEST(NiftiGeometry, HalfTurnQuaternionIsNormalised) {
    NiftiFile file;
    file.qformCode = 1;
    file.quaternion = {0, 0, 1.0000001F};  // rounding beyond 1; half a turn about z
    const ImageGeometry g = read(file).volume.view().geometry();
    expectNear(g.toPhysical({1, 1, 1}), {1, 1, 1}, kFloatMm);  // RAS (-1, -1, 1)
}

TEST(NiftiGeometry, WithoutFormsIsCentredAsNibabelDoesAndWarned) {
    NiftiFile file;
    file.pixdim = {1, 2, 3, 4, 0, 0, 0, 0};
    const ReadVolume result = read(file);
    // nibabel: RAS affine diag(-2, 3, 4), origin +3, -3, -2: half of (size - 1) * spacing
    expectNear(result.volume.view().geometry().originMm, {-3, 3, -2}, 0);
    EXPECT_EQ(result.volume.view().geometry().indexToPhysical, Mat3::diagonal(2, -3, 4));
    ASSERT_EQ(result.warnings.size(), 1U);
    EXPECT_NE(result.warnings[0].text.find("neither sform nor qform"), std::string::npos);
}

TEST(NiftiGeometry, TurnsMetresAndMicronsIntoMillimetres) {
    NiftiFile file = withSform();
    file.units = 1;
    expectNear(read(file).volume.view().geometry().originMm, {-10000, -20000, 30000}, 0);
    file.units = 3 | 8;  // microns, seconds
    expectNear(read(file).volume.view().geometry().originMm, {-0.01, -0.02, 0.03}, 1e-12);
    file.units = 5;
    expectRefusedNifti(file, "unknown unit");
}

TEST(NiftiGeometry, RefusesUnusableAffines) {
    NiftiFile file = withSform();
    file.sform = {2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0};
    expectRefusedNifti(file, "singular");
    file.sform = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0};
    expectRefusedNifti(file, "not finite");

    NiftiFile spacing;
    spacing.qformCode = 1;
    spacing.pixdim[2] = 0;
    expectRefusedNifti(spacing, "pixdim[2]");
    spacing.pixdim[2] = std::numeric_limits<float>::quiet_NaN();
    expectRefusedNifti(spacing, "pixdim[2]");
    spacing.pixdim[2] = 1e-30F;
    expectRefusedNifti(spacing, "implausible voxel spacing");
    spacing.pixdim[2] = 1;
    spacing.quaternion = {1, 1, 0};
    expectRefusedNifti(spacing, "quaternion");
}

TEST(NiftiScaling, MakesFloatOfSmallAndDoubleOfLargeIntegers) {
    NiftiFile file = withSform();
    file.slope = 0.5;
    file.intercept = -3;
    const ReadVolume small = read(file);
    ASSERT_EQ(small.volume.view().pixelType(), PixelType::Float32);
    EXPECT_EQ(samplesIn<float>(small.volume)[7], 0.5F);  // 7 / 2 - 3

    file.datatype = 8;
    file.bitpix = 32;
    file.data = samplesOf(countingSamples<std::int32_t>(24));
    const ReadVolume large = read(file);
    ASSERT_EQ(large.volume.view().pixelType(), PixelType::Float64);
    // 2^31 - 1 needs 31 bits: float32 would round it
    EXPECT_EQ(samplesIn<double>(large.volume).back(), 2147483647 * 0.5 - 3);
}

TEST(NiftiScaling, SlopeZeroOneOrNanKeepsTheStoredType) {
    for (const float slope : {0.F, 1.F, std::numeric_limits<float>::quiet_NaN()}) {
        NiftiFile file = withSform();
        file.slope = slope;
        EXPECT_EQ(read(file).volume.view().pixelType(), PixelType::Int16) << slope;
    }
    NiftiFile file = withSform();
    file.slope = std::numeric_limits<float>::infinity();
    expectRefusedNifti(file, "scl_slope");
}

TEST(NiftiScaling, WorksAcrossReadingPieces) {
    NiftiFile file = withSform();
    file.dim = {3, 100, 100, 50, 1, 1, 1, 1};  // 500000 samples: several pieces
    std::vector<std::int16_t> samples(500000);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = static_cast<std::int16_t>(i % 30011);
    file.data = samplesOf(samples);
    file.slope = 2;
    const auto scaled = samplesIn<float>(read(file).volume);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(scaled[i], 2.F * samples[i]) << i;
    }
}

TEST(NiftiDimensions, FourthDimensionOfOneKeepsTheGeometry) {
    NiftiFile file = withSform();
    file.sform = {2, 0.5, 0, 10, 0, 3, 1, 20, 0, 0, 4, 30};
    const ImageGeometry threeD = read(file).volume.view().geometry();
    file.dim[0] = 4;
    EXPECT_EQ(read(file).volume.view().geometry(), threeD);
}

TEST(NiftiDimensions, RefusesMoreThanOneVolumeVectorsSlicesAndNonsense) {
    NiftiFile file = withSform();
    file.dim = {4, 4, 3, 2, 7, 1, 1, 1};
    expectRefusedNifti(file, "holds 7 volumes");
    file.dim = {5, 4, 3, 2, 1, 3, 1, 1};
    expectRefusedNifti(file, "vectors of 3 components");
    file.dim = {2, 4, 6, 1, 1, 1, 1, 1};
    expectRefusedNifti(file, "2-D image or a single slice");
    file.dim = {0, 4, 3, 2, 1, 1, 1, 1};
    expectRefusedNifti(file, "dim[0]");
    file.dim = {3, 4, -3, 2, 1, 1, 1, 1};
    expectRefusedNifti(file, "dim[2]");
}

TEST(NiftiPixelKinds, RefusesColourComplexAndContradictions) {
    NiftiFile file = withSform();
    file.datatype = 128, file.bitpix = 24;
    expectRefusedNifti(file, "RGB colour");
    file.datatype = 32, file.bitpix = 64;
    expectRefusedNifti(file, "complex");
    file.datatype = 4, file.bitpix = 8;
    expectRefusedNifti(file, "bitpix");
}

TEST(NiftiTruncation, IsRefusedWhereverTheFileEnds) {
    const TempFolder folder;
    const std::string whole = withSform().bytes();
    for (const std::size_t length :
         {1UL, 4UL, 100UL, 347UL, 348UL, 352UL, 353UL, whole.size() - 1}) {
        expectRefusal(writeFile(folder / "x.nii", whole.substr(0, length)), "truncated");
    }
    expectRefusal(writeFile(folder / "x.nii", ""), "empty");
}

TEST(NiftiTruncation, OfGzipIsRefusedWhereverTheFileEnds) {
    const TempFolder folder;
    const std::string whole = gzipped(withSform().bytes());
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(writeFile(folder / "whole.nii.gz", whole)).volume),
              countingSamples<std::int16_t>(24));
    // the last 8 bytes are the checksum and the length: all samples are there, yet unproven
    for (std::size_t length = 3; length < whole.size(); ++length) {
        expectRefusal(writeFile(folder / "x.nii.gz", whole.substr(0, length)), "truncated");
    }
}

TEST(NiftiTruncation, ShortDataInsideWholeGzipIsRefused) {
    const TempFolder folder;
    const std::string bytes = withSform().bytes();
    expectRefusal(writeFile(folder / "x.nii.gz", gzipped(bytes.substr(0, bytes.size() - 2))),
                  "truncated");
}

TEST(NiftiGzip, DamagedChecksumIsRefused) {
    const TempFolder folder;
    std::string bytes = gzipped(withSform().bytes());
    bytes[bytes.size() - 8] = static_cast<char>(bytes[bytes.size() - 8] ^ 1);
    expectRefusal(writeFile(folder / "x.nii.gz", bytes), "damaged");
}

TEST(NiftiGzip, ContentCountsNotTheName) {
    const TempFolder folder;
    const std::string bytes = withSform().bytes();
    EXPECT_EQ(readVolume(writeFile(folder / "plain.gz", bytes)).format, "NIfTI-1");
    EXPECT_EQ(readVolume(writeFile(folder / "zipped.dat", gzipped(bytes))).format, "NIfTI-1");
    const std::string twoMembers = gzipped(bytes.substr(0, 360)) + gzipped(bytes.substr(360));
    EXPECT_EQ(
        samplesIn<std::int16_t>(readVolume(writeFile(folder / "x.nii.gz", twoMembers)).volume),
        countingSamples<std::int16_t>(24));
}

TEST(NiftiDataOffset, IsHonouredAndChecked) {
    NiftiFile file = withSform();
    file.dataOffset = 368;
    file.data = std::string(16, '\x7f') + file.data;
    EXPECT_EQ(samplesIn<std::int16_t>(read(file).volume), countingSamples<std::int16_t>(24));
    for (const float bad :
         {-16.F, 0.F, 348.F, 352.5F, 1e20F, std::numeric_limits<float>::quiet_NaN()}) {
        file.dataOffset = bad;
        expectRefusedNifti(file, "vox_offset");
    }
    file.dataOffset = 1e6F;
    expectRefusedNifti(file, "truncated");
}

TEST(NiftiMagic, MustBeThere) {
    NiftiFile file = withSform();
    file.magic = std::string("n+9\0", 4);
    expectRefusedNifti(file, "magic");
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.nii", std::string(1000, 'x')), "not a NIfTI file");
}

TEST(NiftiPair, ReadsFromEitherHalfAndRefusesOneAlone) {
    const TempFolder folder;
    NiftiFile file = withSform();
    file.magic = std::string("ni1\0", 4);
    file.dataOffset = 0;
    const auto header = writeFile(folder / "x.hdr", file.header());
    expectRefusal(header, "x.img");
    const auto data = writeFile(folder / "x.img", file.data);
    for (const auto& input : {header, data}) {
        EXPECT_EQ(samplesIn<std::int16_t>(readVolume(input).volume),
                  countingSamples<std::int16_t>(24));
    }
    writeFile(data, file.data.substr(1));
    EXPECT_NE(refusalOf(header).find("truncated"), std::string::npos);
}

TEST(Nifti2, IsReadWithItsDoubles) {
    std::string h(544, '\0');
    put<std::int32_t>(h, 0, 540);
    h.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
    put<std::int16_t>(h, 12, 4);
    put<std::int16_t>(h, 14, 16);
    const std::int64_t dim[] = {3, 4, 3, 2, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) put(h, 16 + 8 * i, dim[i]);
    put<std::int64_t>(h, 168, 544);
    put<std::int32_t>(h, 348, 1);
    const double sform[] = {2, 0, 0, 0.1, 0, 3, 0, 0.2, 0, 0, 4, 0.3};
    for (std::size_t i = 0; i < 12; ++i) put(h, 400 + 8 * i, sform[i]);
    put<std::int32_t>(h, 500, 2);
    const TempFolder folder;
    const ReadVolume result =
        readVolume(writeFile(folder / "x.nii", h + samplesOf(countingSamples<std::int16_t>(24))));
    EXPECT_EQ(result.format, "NIfTI-2");
    expectNear(result.volume.view().geometry().originMm, {-0.1, -0.2, 0.3}, 0);  // kept as doubles
    EXPECT_EQ(samplesIn<std::int16_t>(result.volume), countingSamples<std::int16_t>(24));
}

TEST(Nifti2, CiftiIsCalledByItsName) {
    std::string h(544, '\0');
    put<std::int32_t>(h, 0, 540);
    h.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
    put<std::int16_t>(h, 12, 16);
    put<std::int16_t>(h, 14, 32);
    const std::int64_t dim[] = {6, 1, 1, 1, 1, 3, 50, 1};
    for (std::size_t i = 0; i < 8; ++i) put(h, 16 + 8 * i, dim[i]);
    put<std::int64_t>(h, 168, 544);
    put<std::int32_t>(h, 504, 3006);  // ConnDenseScalar
    const TempFolder folder;
    h += std::string(600, '\1');
    for (const auto& [name, bytes] : {std::pair{"x.dscalar.nii", h}, {"x.nii.gz", gzipped(h)}}) {
        expectRefusal(writeFile(folder / name, bytes), "is CIFTI");
        expectRefusal(folder / name, "wb_command -cifti-separate");
    }
}

TEST(NiftiIntent, NamesComponents) {
    NiftiFile file = withSform();
    file.dim = {5, 4, 3, 2, 1, 3, 1, 1};
    const auto header = [&](std::int16_t intent) {
        std::string bytes = file.header();
        put<std::int16_t>(bytes, 68, intent);
        return bytes + file.data + file.data + file.data;
    };
    const TempFolder folder;
    const auto path = folder / "x.nii";
    expectRefusal(writeFile(path, header(0)), "vectors of 3 components (dimension 5)");
    expectRefusal(writeFile(path, header(1006)), "displacements of 3 components (dimension 5)");
    expectRefusal(path, "save one component as a 3-D image");
    file.dim = {4, 4, 3, 2, 3, 1, 1, 1};
    expectRefusal(writeFile(path, header(0)), "holds 3 volumes; choose one: --volume-index 0 to 2");
    expectRefusal(writeFile(path, header(2006)), "holds 3 components of displacements; choose one");
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(path, {.volumeIndex = 2}).volume),
              countingSamples<std::int16_t>(24));
}

TEST(NiftiRealData, MniBrainAgreesWithNibabel) {
    const std::filesystem::path file = "/usr/share/mricron/templates/ch2.nii.gz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "Debian's mricron-data is not installed";
    const ReadVolume result = readVolume(file);
    const VolumeView& volume = result.volume;
    // nibabel 5.0.0 (Debian 12): affine diag(1, 1, 1), origin -90, -125, -71 (RAS); sum of samples
    EXPECT_EQ(volume.geometry().size, (Index3{181, 217, 181}));
    expectNear(volume.geometry().originMm, {90, 125, -71}, 0);
    EXPECT_EQ(volume.geometry().indexToPhysical, Mat3::diagonal(-1, -1, 1));
    ASSERT_EQ(volume.pixelType(), PixelType::UInt8);
    const auto view = volume.as<std::uint8_t>();
    EXPECT_EQ(view.at(90, 108, 90), 33);
    EXPECT_EQ(view.at(45, 80, 60), 101);
    EXPECT_EQ(view.at(120, 150, 100), 103);
    std::int64_t sum = 0;
    for (const auto sample : samplesIn<std::uint8_t>(volume)) sum += sample;
    EXPECT_EQ(sum, 317151210);
}

}  // namespace
}  // namespace adaptiso::testing
