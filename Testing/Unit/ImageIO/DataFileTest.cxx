// Which files a header may open: its own folder's, and what honest links lead to.
#include <gtest/gtest.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

namespace fs = std::filesystem;

const std::string kMeta =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 1\n"
    "DimSize = 4 3 2\nElementType = MET_SHORT\nElementDataFile = x.raw\n";
const std::string kNrrd =
    "NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: 4 3 2\n"
    "space directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\nencoding: raw\n"
    "data file: x.raw\n";

std::string pairedNiftiHeader() {
    NiftiFile file;
    file.sformCode = 1;
    file.sform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    file.magic = std::string("ni1\0", 4);
    file.dataOffset = 0;
    return file.header();
}

struct Pair {
    const char* headerName;
    std::string header;
    const char* dataName;
};

std::vector<Pair> pairs() {
    return {{"x.mhd", kMeta, "x.raw"},
            {"x.nhdr", kNrrd, "x.raw"},
            {"x.hdr", pairedNiftiHeader(), "x.img"}};
}

void expectSamples(const fs::path& header) {
    EXPECT_EQ(samplesIn<std::int16_t>(readVolume(header).volume), countingSamples<std::int16_t>(24))
        << header;
}

TEST(DataFile, MayBeALinkWithinTheFolder) {
    for (const Pair& pair : pairs()) {
        const TempFolder folder;
        fs::create_directory(folder / "sub");
        writeFile(folder / "sub/real", kSamples);
        fs::create_symlink("sub/real", folder / pair.dataName);
        expectSamples(writeFile(folder / pair.headerName, pair.header));
    }
}

TEST(DataFile, MustNotBeALinkToOutside) {
    for (const Pair& pair : pairs()) {
        const TempFolder folder;
        fs::create_directory(folder / "in");
        writeFile(folder / "secret", kSamples);
        fs::create_symlink("../secret", folder / "in" / pair.dataName);
        expectRefusal(writeFile(folder / "in" / pair.headerName, pair.header),
                      "a link to outside the header's own folder");
        // a folder whose name begins alike is outside too
        fs::create_directory(folder / "in2");
        writeFile(folder / "in2/secret", kSamples);
        fs::remove(folder / "in" / pair.dataName);
        fs::create_symlink("../in2/secret", folder / "in" / pair.dataName);
        expectRefusal(folder / "in" / pair.headerName, "outside");
    }
}

TEST(DataFile, MustBeARegularFile) {
    const TempFolder folder;
    for (const Pair& pair : pairs()) {
        fs::create_symlink("/dev/zero", folder / pair.dataName);
        const std::string message = refusalOf(writeFile(folder / pair.headerName, pair.header));
        EXPECT_NE(message.find("device"), std::string::npos) << message;
        fs::remove(folder / pair.dataName);
    }
}

TEST(DataFile, IsFoundThroughALinkedFolderAndBothFilesLinked) {
    for (const Pair& pair : pairs()) {
        const TempFolder folder;
        fs::create_directories(folder / "store/subject");
        writeFile(folder / "store/subject" / std::string(pair.headerName), pair.header);
        writeFile(folder / "store/subject" / std::string(pair.dataName), kSamples);
        fs::create_directory_symlink("store/subject",
                                     folder / "subject");  // as FreeSurfer's fsaverage
        expectSamples(folder / "subject" / pair.headerName);
        fs::create_directory(folder / "bids");  // each file a link into the store
        for (const std::string name : {pair.headerName, pair.dataName}) {
            fs::create_symlink("../store/subject/" + name, folder / "bids" / name);
        }
        expectSamples(folder / "bids" / pair.headerName);
    }
}

TEST(DataFile, IsFoundInAnAnnexAboveTheHeader) {
    for (const Pair& pair : pairs()) {
        const TempFolder folder;
        const fs::path objects = folder / ".git/annex/objects";
        fs::create_directories(objects / "Aa/K1");
        fs::create_directories(objects / "Bb/K2");
        fs::create_directories(folder / "sub-01/anat");
        writeFile(objects / "Aa/K1/K1", pair.header);
        writeFile(objects / "Bb/K2/K2", kSamples);
        const fs::path anat = folder / "sub-01/anat";
        fs::create_symlink("../../.git/annex/objects/Aa/K1/K1", anat / pair.headerName);
        fs::create_symlink("../../.git/annex/objects/Bb/K2/K2", anat / pair.dataName);
        expectSamples(anat / pair.headerName);
        // another repository's annex is none of this header's
        const TempFolder other;
        fs::create_directories(other / ".git/annex/objects");
        writeFile(other / ".git/annex/objects/K3", kSamples);
        fs::remove(anat / pair.dataName);
        fs::create_symlink(other / ".git/annex/objects/K3", anat / pair.dataName);
        expectRefusal(anat / pair.headerName, "outside");
    }
}

}  // namespace
}  // namespace adaptiso::testing
