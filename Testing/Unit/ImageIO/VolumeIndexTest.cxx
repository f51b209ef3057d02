// Files of several volumes: one of them is read, in every format that can hold them.
#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

/// Volume v of 4 x 3 x 2 voxels holds 100 v + 0 ... 23.
std::vector<std::int16_t> volume(int v) {
    std::vector<std::int16_t> samples;
    for (int i = 0; i < 24; ++i) samples.push_back(static_cast<std::int16_t>(100 * v + i));
    return samples;
}

std::vector<std::int16_t> threeVolumes() {
    std::vector<std::int16_t> samples;
    for (int v = 0; v < 3; ++v) {
        for (const auto sample : volume(v)) samples.push_back(sample);
    }
    return samples;
}

std::string nifti(std::endian order = std::endian::little) {
    NiftiFile file;
    file.order = order;
    file.sformCode = 1;
    file.sform = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    file.dim = {4, 4, 3, 2, 3, 1, 1, 1};
    file.data = samplesOf(threeVolumes(), order);
    return file.bytes();
}

std::string mgh() {
    constexpr std::endian kBig = std::endian::big;
    std::string h(284, '\0');
    const std::int32_t numbers[] = {1, 4, 3, 2, 3, 4};
    for (std::size_t i = 0; i < 6; ++i) put(h, 4 * i, numbers[i], kBig);
    put<std::int16_t>(h, 28, 1, kBig);
    const float geometry[] = {2, 3, 4, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
    for (std::size_t i = 0; i < 15; ++i) put(h, 30 + 4 * i, geometry[i], kBig);
    return h + samplesOf(threeVolumes(), kBig);
}

std::string metaImage() {
    return "ObjectType = Image\nNDims = 4\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nOffset = 10 20 30 0\n"
           "ElementSpacing = 2 3 4 1\nDimSize = 4 3 2 3\nElementType = MET_SHORT\n"
           "ElementDataFile = LOCAL\n" +
           samplesOf(threeVolumes());
}

std::string nrrd(const std::string& sizes, const std::string& directions, const std::string& kinds,
                 const std::vector<std::int16_t>& samples, bool isZipped = false) {
    return "NRRD0004\ntype: short\ndimension: 4\nspace: LPS\nsizes: " + sizes +
           "\nspace directions: " + directions + "\nkinds: " + kinds +
           "\nspace origin: (10,20,30)\nendian: little\nencoding: " + (isZipped ? "gzip" : "raw") +
           "\n\n" + (isZipped ? gzipped(samplesOf(samples)) : samplesOf(samples));
}

std::string nrrdVolumesLast(bool isZipped = false) {
    return nrrd("4 3 2 3", "(2,0,0) (0,3,0) (0,0,4) none", "domain domain domain list",
                threeVolumes(), isZipped);
}

/// As 3D Slicer stores sequences: all volumes' samples of a voxel side by side.
std::string nrrdVolumesFirst(bool isZipped = false) {
    std::vector<std::int16_t> samples;
    for (std::size_t i = 0; i < 24; ++i) {
        for (int v = 0; v < 3; ++v) samples.push_back(volume(v)[i]);
    }
    return nrrd("3 4 3 2", "none (2,0,0) (0,3,0) (0,0,4)", "list domain domain domain", samples,
                isZipped);
}

ReadOptions indexed(std::int64_t index) {
    ReadOptions options;
    options.volumeIndex = index;
    return options;
}

struct Case {
    const char* name;
    std::string bytes;
};

std::vector<Case> allCases() {
    return {{"x.nii", nifti()},
            {"big.nii", nifti(std::endian::big)},
            {"x.nii.gz", gzipped(nifti())},
            {"x.mgh", mgh()},
            {"x.mgz", gzipped(mgh())},
            {"x.mha", metaImage()},
            {"last.nrrd", nrrdVolumesLast()},
            {"last-gz.nrrd", nrrdVolumesLast(true)},
            {"first.nrrd", nrrdVolumesFirst()},
            {"first-gz.nrrd", nrrdVolumesFirst(true)}};
}

TEST(VolumeIndex, PicksEachVolumeInEveryFormat) {
    const TempFolder folder;
    for (const Case& c : allCases()) {
        const auto file = writeFile(folder / c.name, c.bytes);
        for (int v = 0; v < 3; ++v) {
            const ReadVolume result = readVolume(file, indexed(v));
            EXPECT_EQ(samplesIn<std::int16_t>(result.volume), volume(v)) << c.name << " " << v;
            EXPECT_NEAR(result.volume.view().geometry().voxelVolumeMm3(), 24, 1e-12) << c.name;
        }
    }
}

TEST(VolumeIndex, MustBeGivenAndBeThere) {
    const TempFolder folder;
    for (const Case& c : allCases()) {
        const auto file = writeFile(folder / c.name, c.bytes);
        expectRefusal(file, "is 4-D: it holds 3 volumes");
        for (const std::int64_t index : {std::int64_t{-1}, std::int64_t{3}, INT64_MAX, INT64_MIN}) {
            EXPECT_THROW(readVolume(file, indexed(index)), FileError) << c.name << " " << index;
        }
    }
    NiftiFile single;
    single.sformCode = 1;
    single.sform = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    const auto file = writeFile(folder / "single.nii", single.bytes());
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(file, indexed(0)).volume),
              countingSamples<std::int16_t>(24));
    EXPECT_THROW(readVolume(file, indexed(1)), FileError);
}

TEST(VolumeIndex, ARefusalSaysHowManyThereAre) {
    const TempFolder folder;
    for (const Case& c : allCases()) {
        const auto file = writeFile(folder / c.name, c.bytes);
        for (const ReadOptions& options : {ReadOptions{}, indexed(3)}) {
            try {
                readVolume(file, options);
                ADD_FAILURE() << c.name;
            } catch (const ChoiceNeeded& choice) {
                EXPECT_EQ(choice.among(), ChoiceNeeded::Among::Volumes) << c.name;
                EXPECT_EQ(choice.count(), 3) << c.name;
            }
        }
    }
}

TEST(VolumeIndex, LayersOfSegmentsAreNamed) {
    std::string bytes = nrrdVolumesFirst();
    bytes.insert(
        bytes.find("\n\n") + 1,
        "Segment0_Layer:=0\nSegment0_Name:=liver\nSegment1_Layer:=2\nSegment1_Name:=vessel\n"
        "Segment2_Layer:=0\nSegment2_Name:=tumour\n");
    const TempFolder folder;
    const auto file = writeFile(folder / "x.seg.nrrd", bytes);
    expectRefusal(file,
                  "holds 3 layers of segments that overlap (0: liver, tumour; 2: vessel); choose "
                  "one: --volume-index 0 to 2");
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(file, indexed(2)).volume), volume(2));
}

TEST(VolumeIndex, RefusesFilesThatMissPartOfAnotherVolume) {
    const TempFolder folder;
    for (const Case& c : allCases()) {
        const auto file =
            writeFile(folder / c.name, std::string_view(c.bytes).substr(0, c.bytes.size() - 1));
        try {
            readVolume(file, indexed(0));
            ADD_FAILURE() << c.name << " was read";
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find("truncated"), std::string::npos)
                << error.what();
        }
    }
}

TEST(VolumeIndex, ScalesTheVolumeAskedFor) {
    const TempFolder folder;
    std::string bytes = nifti();
    put(bytes, 112, 2.F);
    put(bytes, 116, 1.F);
    const ReadVolume result = readVolume(writeFile(folder / "x.nii", bytes), indexed(2));
    ASSERT_EQ(result.volume.view().pixelType(), PixelType::Float32);
    EXPECT_EQ(samplesIn<float>(result.volume)[5], 2 * 205 + 1);
}

TEST(VolumeIndex, DoesNotTakeComponentsForVolumes) {
    const TempFolder folder;
    for (const std::string kind : {"vector", "RGB-color", "complex", "3D-gradient", "quaternion"}) {
        const auto file =
            writeFile(folder / "x.nrrd", nrrd("3 4 3 2", "none (2,0,0) (0,3,0) (0,0,4)",
                                              kind + " domain domain domain", threeVolumes()));
        EXPECT_THROW(readVolume(file, indexed(0)), FileError) << kind;
        expectRefusal(file, "components");
    }
    const auto middle =
        writeFile(folder / "x.nrrd", nrrd("4 3 3 2", "(2,0,0) none (0,3,0) (0,0,4)",
                                          "domain list domain domain", threeVolumes()));
    expectRefusal(middle, "4 dimensions");
}

TEST(VolumeIndex, RefusesNonsenseCounts) {
    const TempFolder folder;
    std::string bytes = mgh();
    for (const std::int32_t count : {0, -5}) {
        put(bytes, 16, count, std::endian::big);
        expectRefusal(writeFile(folder / "x.mgh", bytes), "nframes");
    }
    std::string huge = metaImage();
    huge.replace(huge.find("DimSize = 4 3 2 3"), 17, "DimSize = 4 3 2 4611686018427387904");
    EXPECT_THROW(readVolume(writeFile(folder / "x.mha", huge), indexed(0)), FileError);
}

TEST(VolumeIndex, IsNotAskedForWhereVolumesAreSingleSlices) {
    const TempFolder folder;
    NiftiFile file;
    file.dim = {4, 4, 3, 1, 6, 1, 1, 1};
    file.data = samplesOf(threeVolumes());
    expectRefusal(writeFile(folder / "x.nii", file.bytes()), "is a 2-D image or a single slice");
}

}  // namespace
}  // namespace adaptiso::testing
