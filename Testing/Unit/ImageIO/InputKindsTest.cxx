#include <gtest/gtest.h>
#include <sys/stat.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

TEST(InputKinds, RefusesNamedPipes) {
#ifdef __EMSCRIPTEN__
    GTEST_SKIP() << "Emscripten makes a regular file of mkfifo()'s";
#endif
    const TempFolder folder;
    ASSERT_EQ(::mkfifo((folder / "x.nii").c_str(), 0600), 0);
    expectRefusal(folder / "x.nii", "named pipe");
}

TEST(InputKinds, RefusesWhatIsNoRegularFile) {
    const TempFolder folder;
    expectRefusal(folder / "missing.nii", "no such file");
    expectRefusal("/dev/zero", "device");
    std::filesystem::create_symlink("nowhere", folder / "link.nii");
    expectRefusal(folder / "link.nii", "points to no existing file");
}

TEST(InputKinds, FollowsLinksToRegularFiles) {
    const TempFolder folder;
    NiftiFile file;
    file.sformCode = 1;
    file.sform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    writeFile(folder / "target", file.bytes());
    std::filesystem::create_symlink("target", folder / "x.nii");
    EXPECT_EQ(readVolume(folder / "x.nii").format, "NIfTI-1");
}

TEST(InputKinds, RefusesUnknownFormats) {
    const TempFolder folder;
    expectRefusal(writeFile(folder / "x.txt", "some text that is no image"),
                  "not a format that is read here");
    expectRefusal(writeFile(folder / "x.gz", gzipped("some text that is no image")),
                  "not a format that is read here");
}

TEST(InputKinds, NamesContentThatStandsInThePlaceOfAnImage) {
    const TempFolder folder;
    const std::string pointer =
        "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 1234\n";
    for (const char* const name : {"x.nii.gz", "x.nii", "x.nrrd", "x.mha", "x.mgz", "x.dcm", "x"}) {
        expectRefusal(writeFile(folder / name, pointer),
                      "is a git-lfs pointer, its 1234 bytes of data are not here; fetch them: git "
                      "lfs pull");
        expectRefusal(writeFile(folder / name, "<!DOCTYPE html><html>"), "is a web page");
        expectRefusal(writeFile(folder / name, "PK\3\4"),
                      "is a zip archive, not a format that is read here; unpack it");
        expectRefusal(writeFile(folder / name, "BZh91AY&SY"), "unpack it: bunzip2 -k x");
        expectRefusal(writeFile(folder / name, std::string(2000, '\0')), "holds zeros alone");
        expectRefusal(writeFile(folder / name, ""), "is an empty file");
        expectRefusal(writeFile(folder / name, gzipped("PK\3\4 and more")),
                      "is packed with gzip, and what is inside is a zip archive");
    }
    std::filesystem::create_symlink("../.git/annex/objects/a/MD5E-s12--c.nii", folder / "link.nii");
    expectRefusal(folder / "link.nii", "git annex get link.nii");
}

TEST(InputKinds, TakesDicomWhosePreambleIsATiffHeaderForDicom) {
    const TempFolder folder;
    std::string bytes = DicomSlice().bytes();
    bytes.replace(0, 4, std::string("II*\0", 4));
    expectRefusal(writeFile(folder / "x.dcm", bytes), "is a single DICOM slice");
}

TEST(InputKinds, EscapesControlCharactersOfPaths) {
    const TempFolder folder;
    const std::string message = refusalOf(folder / "a\x1b[31m\nb.nii");
    EXPECT_NE(message.find("a\\x1b[31m\\x0ab.nii"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace adaptiso::testing
