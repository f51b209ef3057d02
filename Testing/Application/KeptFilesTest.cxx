#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "Common/KeptFiles.h"
#include "Common/Sha256.h"
#include "FolderTest.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class KeptFilesTest : public FolderTest {};

// FIPS 180-4's examples, as sha256sum prints them
constexpr const char* kOfNothing =
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST_F(KeptFilesTest, ChecksumIsSha256) {
    EXPECT_EQ(sha256Of(""), kOfNothing);
    EXPECT_EQ(sha256Of("abc"), kOfAbc);
    EXPECT_EQ(sha256OfFile(put("a", "abc")), kOfAbc);
    const std::string large(3 << 20, 'x');  // three pieces, as the file is read
    EXPECT_EQ(sha256OfFile(put("large", large)), sha256Of(large));
    EXPECT_THROW(sha256OfFile(folder_ / "missing"), FileError);
    EXPECT_THROW(sha256OfFile(folder_), FileError);
}

TEST_F(KeptFilesTest, TellsGoneFromChanged) {
    const fs::path file = put("a", "abc");
    const KeptFile kept = keptFile("a", file);
    EXPECT_EQ(kept.bytes, 3u);
    EXPECT_EQ(kept.sha256, kOfAbc);
    EXPECT_EQ(changeOf(kept, file, false), FileChange::None);
    put("a", "abd");
    EXPECT_EQ(changeOf(kept, file, false), FileChange::Changed);
    EXPECT_EQ(changeOf(kept, file, true), FileChange::Changed);
    fs::remove(file);
    EXPECT_EQ(changeOf(kept, file, false), FileChange::Gone);
    fs::create_directory(file);
    EXPECT_EQ(changeOf(kept, file, false), FileChange::Changed);
}

TEST_F(KeptFilesTest, NoticesAChangeThatPutsTheTimeBack) {
    const fs::path file = put("a", "abc");
    const auto time = fs::last_write_time(file);
    const KeptFile kept = keptFile("a", file);
    put("a", "abd");
    fs::last_write_time(file, time);
    EXPECT_EQ(changeOf(kept, file, true), FileChange::Changed);
}

TEST_F(KeptFilesTest, TakesACopyForTheSame) {
    const KeptFile kept = keptFile("a", put("a", "abc"));
    EXPECT_EQ(changeOf(kept, put("b", "abc"), true), FileChange::None);
}

TEST_F(KeptFilesTest, SurvivesJson) {
    const KeptFile kept = keptFile("a", put("a", "abc"));
    const KeptFile again = keptFileOf(toJson(kept));
    EXPECT_EQ(changeOf(kept, again), FileChange::None);
    EXPECT_EQ(again.modifiedNs, kept.modifiedNs);
    EXPECT_THROW(keptFileOf(Json::array()), Json::exception);
}

TEST_F(KeptFilesTest, AFolderOfZarrIsItsHiddenMetadataToo) {
    put("scan.zarr/.zarray", "{}");
    put("scan.zarr/0.0.0", "chunk");
    const fs::path scan = folder_ / "scan.zarr";
    const KeptFile kept = keptInput(scan, {});
    EXPECT_EQ(kept.files, 2u);
    put("scan.zarr/.zarray", "[]");  // of another shape, say
    EXPECT_EQ(changeOf(kept, keptInput(scan, {})), FileChange::Changed);
}

TEST_F(KeptFilesTest, AFolderIsAllThatIsSeenInIt) {
    put("scan/1", "one");
    put("scan/sub/2", "two");
    put("scan/.hidden", "x");
    put("scan/out/surface.stl", "x");
    const fs::path scan = folder_ / "scan", output = folder_ / "scan" / "out" / "";
    EXPECT_EQ(filesOfInput(scan, output).size(), 2u);
    const KeptFile kept = keptInput(scan, output);
    EXPECT_EQ(kept.files, 2u);
    EXPECT_EQ(kept.bytes, 6u);
    fs::rename(scan / "1", scan / "3");  // the name tells slices apart that hold the same
    EXPECT_EQ(changeOf(kept, keptInput(scan, output)), FileChange::Changed);
    fs::rename(scan / "3", scan / "1");
    EXPECT_EQ(changeOf(kept, keptInput(scan, output)), FileChange::None);
    fs::rename(scan, folder_ / "moved");
    EXPECT_EQ(changeOf(kept, keptInput(folder_ / "moved", folder_ / "moved" / "out")),
              FileChange::None);
}

TEST_F(KeptFilesTest, AHeaderHasItsData) {
    using Paths = std::vector<fs::path>;
    const fs::path raw = put("a.raw", "data");
    const fs::path meta = put("a.mhd", "NDims = 3\nElementDataFile = a.raw\n");
    EXPECT_EQ(filesOfInput(meta, {}), (Paths{meta, raw}));
    const fs::path local = put("a.mha", "NDims = 3\nElementDataFile = LOCAL\ndata");
    EXPECT_EQ(filesOfInput(local, {}), Paths{local});
    const fs::path nrrd = put("b.nhdr", "NRRD0004\ndata file: a.raw\n\n");
    EXPECT_EQ(filesOfInput(nrrd, {}), (Paths{nrrd, raw}));
    const fs::path list = put("list/c.nhdr", "NRRD0004\ndata file: %d.raw 1 2 1\n\n");
    put("list/1.raw", "");
    put("list/2.raw", "");
    EXPECT_EQ(filesOfInput(list, {}).size(), 3u);
    const fs::path header = put("d.hdr", "x"), image = put("d.img.gz", "x");
    put("e.img", "x");
    EXPECT_EQ(filesOfInput(header, {}), (Paths{header, image}));
    EXPECT_EQ(filesOfInput(image, {}), (Paths{image, header}));
    put("disk/IMAGES/1", "x");
    EXPECT_EQ(filesOfInput(put("disk/DICOMDIR", "x"), {}).size(), 2u);
}

}  // namespace
}  // namespace adaptiso
