#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "Common/BatchRecord.h"
#include "Common/BatchRows.h"
#include "FolderTest.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class BatchRecordTest : public FolderTest {};

KeptRecord recordOfRun(const std::string& program) {
    KeptRecord record{program, program + " 1.0"};
    record.hasEnded = true;
    record.run.name = "a";
    record.run.files = {"a.nii"};
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
    EXPECT_TRUE(isRecordFile(longest));
    EXPECT_FALSE(isRecordFile("report.json"));
}

TEST_F(BatchRecordTest, ComesBackAsItWasWritten) {
    const fs::path file = folder_ / "a.stl.adaptiso-mesh.json";
    KeptRecord record = recordOfRun("adaptiso-mesh");
    record.run.exitCode = 1;
    record.run.outputs = {"a.stl"};
    record.says = "fine";
    record.options = {{"--iso", "12ab"}};
    record.inputs = {{{"a.nii", 1, 2, "34cd", 5, 6}, "../a.nii"}};
    record.outputs = {{"--output", {"a.stl", 1, 7, "89ef", 10, 11}}};
    writeRecord(file, record);
    RecordFault fault = RecordFault::Damaged;
    const std::optional<KeptRecord> again = readRecord(file, fault);
    EXPECT_EQ(fault, RecordFault::None);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->hasEnded);
    EXPECT_EQ(again->run.exitCode, 1);
    EXPECT_EQ(again->run.outputs, record.run.outputs);
    EXPECT_EQ(again->options, record.options);
    EXPECT_EQ(again->inputs.at(0).place, "../a.nii");
    EXPECT_EQ(again->inputs.at(0).file.sha256, "34cd");
    EXPECT_EQ(again->outputs.at(0).file.bytes, 7u);
}

TEST_F(BatchRecordTest, WhateverAFileHoldsNothingIsThrown) {
    const fs::path file = folder_ / "a.stl.adaptiso-mesh.json";
    writeRecord(file, recordOfRun("adaptiso-mesh"));
    std::ifstream in(file);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    RecordFault fault = RecordFault::None;
    for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
        put(file.filename().string(), whole.substr(0, length));
        EXPECT_FALSE(readRecord(file, fault)) << length;
        EXPECT_EQ(fault, RecordFault::Damaged);
    }
    for (const char* key : {"schema", "program", "build", "ended", "name", "exitCode", "outputs",
                            "seconds", "options", "inputs", "keptOutputs"}) {
        Json json = Json::parse(whole);
        json[key] = Json::array({Json::array()});
        put(file.filename().string(), json.dump());
        EXPECT_FALSE(readRecord(file, fault)) << key;
    }
    fs::remove(file);
    EXPECT_FALSE(readRecord(file, fault));
    EXPECT_EQ(fault, RecordFault::Missing);
}

TEST_F(BatchRecordTest, RowsAreThoseOfAllProgramsTheWorstFirst) {
    KeptRecord failed = recordOfRun("adaptiso-mesh"), done = recordOfRun("adaptiso-check");
    failed.run.exitCode = 3;
    failed.run.error = "no image";
    writeRecord(folder_ / "b.adaptiso-mesh.json", failed);
    writeRecord(folder_ / "a.adaptiso-check.json", done);
    put("notes.json", "{}");
    put("deeper/c.adaptiso-mesh.json", "{}");  // not of this folder
    const auto rows = summaryRows({folder_, true}, {}, {});
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].state, RunState::Failed);
    EXPECT_EQ(rows[0].says, "no image");
    EXPECT_EQ(rows[1].program, "adaptiso-check");
}

TEST_F(BatchRecordTest, ExpectedOnesCountOnlyWhereOthersAreKnown) {
    const fs::path anat = folder_ / "sub-1" / "anat";
    fs::create_directories(anat);
    const std::vector<BatchItem> expected{{"a", {"a.nii"}, anat}, {"b", {"b.nii"}, anat}};
    EXPECT_TRUE(summaryRows({folder_, true}, {}, expected).empty());
    writeRecord(anat / "a.stl.adaptiso-mesh.json", recordOfRun("adaptiso-mesh"));
    const auto rows = summaryRows({folder_, true}, {}, expected);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].state, RunState::NotRun);
    EXPECT_EQ(rows[0].name, "b");
    EXPECT_EQ(rows[1].state, RunState::Done);
}

}  // namespace
}  // namespace adaptiso
