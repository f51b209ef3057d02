#include <gtest/gtest.h>
#include <sys/stat.h>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

TEST(InputKinds, RefusesWhatIsNoRegularFile) {
    const TempFolder folder;
    expectRefusal(folder / "missing.nii", "no such file");
    ASSERT_EQ(::mkfifo((folder / "x.nii").c_str(), 0600), 0);
    expectRefusal(folder / "x.nii", "named pipe");
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

TEST(InputKinds, EscapesControlCharactersOfPaths) {
    const TempFolder folder;
    const std::string message = refusalOf(folder / "a\x1b[31m\nb.nii");
    EXPECT_NE(message.find("a\\x1b[31m\\x0ab.nii"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace adaptiso::testing
