#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "Common/BatchRecord.h"
#include "Common/BatchSummary.h"
#include "Common/Sha256.h"
#include "FolderTest.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class BatchRecordTest : public FolderTest {};
class RecordedFilesTest : public FolderTest {};

RunRecord recordOfRun(const std::string& program) {
    RunRecord record{program, program + " 1.0"};
    record.hasEnded = true;
    record.name = "a";
    record.files = {"a.nii"};
    record.date = recordDate();
    return record;
}

TEST_F(BatchRecordTest, IsNamedAfterItsSurface) {
    EXPECT_EQ(recordFile("out", "out/a.stl", "adaptiso-mesh"), "out/a.stl.adaptiso-mesh.json");
    EXPECT_EQ(recordFile("", "a.stl", "adaptiso-mesh"), "a.stl.adaptiso-mesh.json");
    EXPECT_EQ(recordFile("out/", "out/./a.stl", "adaptiso-mesh"), "out/a.stl.adaptiso-mesh.json");
    const fs::path x = recordFile("out", "out/x/a.stl", "adaptiso-mesh");
    EXPECT_EQ(x.parent_path(), "out");
    EXPECT_NE(x, recordFile("out", "out/y/a.stl", "adaptiso-mesh"));
    EXPECT_NE(x, recordFile("out", "out/a.stl", "adaptiso-mesh"));
    constexpr std::size_t kLongestName = 255;
    const std::string stem(kLongestName - 4, 'n');
    const fs::path longest = recordFile("", stem + ".stl", "adaptiso-mesh");
    EXPECT_EQ(longest.native().size(), kLongestName);
    EXPECT_NE(longest, recordFile("", stem + ".ply", "adaptiso-mesh"));
}

TEST_F(BatchRecordTest, ComesBackAsItWasWritten) {
    const fs::path file = folder_ / "a.stl.adaptiso-mesh.json";
    RunRecord record = recordOfRun("adaptiso-mesh");
    record.exitCode = 1;
    record.outputs = {"a.stl"};
    record.says = "fine";
    record.options = {{"--iso", "12ab"}};
    record.inputs = {{"a.nii", 1, 2, "34cd", 5, 6, "", "in/a.nii"}};
    record.recordedOutputs = {{"a.stl", 1, 7, "89ef", 10, 11, "--output"}};
    writeRecord(file, record);
    RunRecord again;
    ASSERT_EQ(readRecord(file, again), RecordFault::None);
    EXPECT_TRUE(again.hasEnded);
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_EQ(again.outputs, record.outputs);
    EXPECT_EQ(again.options, record.options);
    EXPECT_EQ(again.inputs.at(0).place, "in/a.nii");
    EXPECT_EQ(again.inputs.at(0).sha256, "34cd");
    EXPECT_EQ(again.recordedOutputs.at(0).bytes, 7u);
    EXPECT_EQ(again.recordedOutputs.at(0).option, "--output");
}

TEST_F(BatchRecordTest, WhateverAFileHoldsNothingIsThrown) {
    const fs::path file = folder_ / "a.stl.adaptiso-mesh.json";
    writeRecord(file, recordOfRun("adaptiso-mesh"));
    std::ifstream in(file);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    RunRecord record;
    for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
        put(file.filename().string(), whole.substr(0, length));
        EXPECT_EQ(readRecord(file, record), RecordFault::Damaged) << length;
    }
    for (const char* key : {"schema", "program", "build", "ended", "name", "exitCode", "outputs",
                            "seconds", "options", "inputs", "keptOutputs"}) {
        Json json = Json::parse(whole);
        json[key] = Json::array({Json::array()});
        put(file.filename().string(), json.dump());
        EXPECT_NE(readRecord(file, record), RecordFault::None) << key;
    }
    fs::remove(file);
    EXPECT_EQ(readRecord(file, record), RecordFault::Missing);
}

TEST_F(BatchRecordTest, ThatNamesAFileElsewhereIsDamaged) {
    const fs::path file = folder_ / "in/a.stl.adaptiso-mesh.json";
    fs::create_directories(folder_ / "in");
    put("victim", "x");
    fs::create_symlink("../victim", folder_ / "in/link");
    for (const std::string& place :
         {std::string("../victim"), (folder_ / "victim").string(), std::string("a/../../victim"),
          std::string("link"), std::string()}) {
        for (int key = 0; key < 3; ++key) {
            RunRecord record = recordOfRun("adaptiso-mesh"), read;
            if (key == 0) record.outputs = {place};
            if (key == 1) record.recordedOutputs = {{place, 1, 1, "0", 1, 1, "--output"}};
            if (key == 2) record.inputs = {{"a.nii", 1, 1, "0", 1, 1, "", place}};
            writeRecord(file, record);
            const bool isFine = key == 2 && place.empty();  // an input elsewhere has no place
            EXPECT_EQ(readRecord(file, read), isFine ? RecordFault::None : RecordFault::Damaged)
                << place << key;
        }
    }
}

TEST_F(BatchRecordTest, HeadersOfInputsLeadToNoFileElsewhere) {
    put("victim", "x");
    fs::create_directories(folder_ / "in");
    fs::create_symlink("../victim", folder_ / "in/link.raw");
    for (const std::string& name :
         {std::string("../victim"), (folder_ / "victim").string(), std::string("link.raw")}) {
        put("in/a.mhd", "ObjectType = Image\nElementDataFile = " + name + "\n");
        EXPECT_EQ(filesOfInput(folder_ / "in/a.mhd", {}).size(), 1u) << name;
    }
    EXPECT_EQ(filesOfInput(folder_ / "in", {}).size(), 1u);
}

TEST_F(BatchRecordTest, RowsAreThoseOfAllProgramsTheWorstFirst) {
    RunRecord failed = recordOfRun("adaptiso-mesh"), done = recordOfRun("adaptiso-check");
    failed.exitCode = 3;
    failed.error = "no image";
    writeRecord(folder_ / "b.adaptiso-mesh.json", failed);
    writeRecord(folder_ / "a.adaptiso-check.json", done);
    put("notes.json", "{}");
    put("deeper/c.adaptiso-mesh.json", "{}");  // not of this folder
    const auto rows = summaryRows(folder_, {});
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].state, RunState::Failed);
    EXPECT_EQ(rows[0].says, "no image");
    EXPECT_EQ(rows[1].program, "adaptiso-check");
}

// FIPS 180-4's examples, as sha256sum prints them
constexpr const char* kOfNothing =
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST_F(RecordedFilesTest, ChecksumIsSha256) {
    EXPECT_EQ(sha256Of(""), kOfNothing);
    EXPECT_EQ(sha256Of("abc"), kOfAbc);
    EXPECT_EQ(sha256OfFile(put("a", "abc")), kOfAbc);
    const std::string large(3 << 20, 'x');  // three pieces, as the file is read
    EXPECT_EQ(sha256OfFile(put("large", large)), sha256Of(large));
    EXPECT_THROW(sha256OfFile(folder_ / "missing"), FileError);
    EXPECT_THROW(sha256OfFile(folder_), FileError);
}

TEST_F(RecordedFilesTest, TellsGoneFromChanged) {
    const fs::path file = put("a", "abc");
    const RecordedFile recorded = describeFile("a", file);
    EXPECT_EQ(recorded.bytes, 3u);
    EXPECT_EQ(recorded.sha256, kOfAbc);
    EXPECT_EQ(changeOf(recorded, file), FileChange::None);
    put("a", "abcd");
    EXPECT_EQ(changeOf(recorded, file), FileChange::Changed);
    fs::remove(file);
    EXPECT_EQ(changeOf(recorded, file), FileChange::Gone);
    fs::create_directory(file);
    EXPECT_EQ(changeOf(recorded, file), FileChange::Changed);
}

TEST_F(RecordedFilesTest, NoticesAChangeThatPutsTheTimeBack) {
    const fs::path file = put("a", "abc");
    const auto time = fs::last_write_time(file);
    const RecordedFile recorded = describeFile("a", file);
    put("a", "abd");
    fs::last_write_time(file, time);
    EXPECT_EQ(changeOf(recorded, file), FileChange::Changed);
}

TEST_F(RecordedFilesTest, TakesACopyForTheSame) {
    const RecordedFile recorded = describeFile("a", put("a", "abc"));
    EXPECT_EQ(changeOf(recorded, put("b", "abc")), FileChange::None);
}

TEST_F(RecordedFilesTest, AFolderOfZarrIsItsHiddenMetadataToo) {
    put("scan.zarr/.zarray", "{}");
    put("scan.zarr/0.0.0", "chunk");
    const fs::path scan = folder_ / "scan.zarr";
    const RecordedFile recorded = describeInput(scan, {});
    EXPECT_EQ(recorded.files, 2u);
    put("scan.zarr/.zarray", "[]");  // of another shape, say
    EXPECT_FALSE(isSameContent(recorded, describeInput(scan, {})));
}

TEST_F(RecordedFilesTest, AFolderIsAllThatIsSeenInIt) {
    put("scan/1", "one");
    put("scan/sub/2", "two");
    put("scan/.hidden", "x");
    put("scan/out/surface.stl", "x");
    const fs::path scan = folder_ / "scan", output = folder_ / "scan" / "out" / "";
    EXPECT_EQ(filesOfInput(scan, output).size(), 2u);
    const RecordedFile recorded = describeInput(scan, output);
    EXPECT_EQ(recorded.files, 2u);
    EXPECT_EQ(recorded.bytes, 6u);
    fs::rename(scan / "1", scan / "3");  // the name tells slices apart that hold the same
    EXPECT_FALSE(isSameContent(recorded, describeInput(scan, output)));
    fs::rename(scan / "3", scan / "1");
    EXPECT_TRUE(isSameContent(recorded, describeInput(scan, output)));
    fs::rename(scan, folder_ / "moved");
    EXPECT_TRUE(
        isSameContent(recorded, describeInput(folder_ / "moved", folder_ / "moved" / "out")));
}

TEST_F(RecordedFilesTest, AHeaderHasItsData) {
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
