// Tables inside label images: 3D Slicer's NRRD headers, NIfTI extensions.
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;

using Entries = std::vector<LabelEntry>;

const std::string kSlicer =
    "NRRD0004\ntype: uchar\ndimension: 4\nSegment0_ID:=Segment_1\r\nSegment0_LabelValue:=3\n"
    "Segment0_Layer:=0\nSegment0_Name:=right lung\nSegment0_Color:=0.8 0.4 0.0862745\n"
    "Segment0_Tags:=TerminologyEntry:a~b^c|Segment9_Name:=no\nSegment1_Name:=gro\xC3\x9F\\n\n"
    "Segment1_LabelValue:=12\nSegment1_Layer:=1\nSegment2_ID:=only\nSegment2_LabelValue:=1\n"
    "Segment2_Layer:=0\nSegmentation_Name:=no\n\nSegment5_Name:=data\n";

TEST(SlicersSegments, GiveNamesAndColoursOfALayer) {
    const LabelTable table = decodeEmbeddedTable(kSlicer);
    EXPECT_EQ(table.format, "3D Slicer segmentation");
    // 255 * (0.8, 0.4, 0.0862745) rounded
    EXPECT_EQ(table.entries,
              (Entries{{1, "only", "", {}}, {3, "right lung", "", LabelColor{204, 102, 22}}}));
    EXPECT_EQ(decodeEmbeddedTable(kSlicer, 1).entries, (Entries{{12, "gro\xC3\x9F", "", {}}}));
    EXPECT_TRUE(decodeEmbeddedTable(kSlicer, 2).entries.empty());
}

TEST(SlicersSegments, OfOldFilesAreALayerEach) {
    const std::string old = "NRRD0004\nSegment0_Name:=a\nSegment1_Name:=b\n\n";
    EXPECT_EQ(decodeEmbeddedTable(old, 1).entries, (Entries{{1, "b", "", {}}}));
    EXPECT_TRUE(decodeEmbeddedTable("NRRD0004\ntype: uchar\n\n").entries.empty());
}

template <class T>
std::string raw(T value, bool isSwapped) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return isSwapped ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

/// NIfTI-1 with extensions; big endian if swapped.
std::string niftiWith(const std::string& texts, bool isSwapped = false, float offset = 0) {
    std::string bytes(348, '\0');
    bytes.replace(0, 4, raw(std::int32_t{348}, isSwapped)).replace(108, 4, raw(offset, isSwapped));
    bytes.replace(344, 4, "n+1\0"s);
    bytes += "\1\0\0\0"s;
    const auto add = [&](std::string text, std::int32_t code) {
        text.resize((text.size() + 8 + 15) / 16 * 16 - 8, '\0');
        bytes += raw(static_cast<std::int32_t>(text.size() + 8), isSwapped) + raw(code, isSwapped) +
                 text;
    };
    add("another program's", 6);
    add(texts, 30);
    return bytes;
}

const std::string kConnectome =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><CaretExtension><VolumeInformation Index=\"0\">"
    "<LabelTable><Label Key=\"0\" Red=\"1\" Green=\"1\" Blue=\"1\" Alpha=\"0\">Unknown</Label>"
    "<Label Key=\"50\" Red=\"0\" Green=\"0.5\" Blue=\"1\" "
    "Alpha=\"1\"><![CDATA[vertebrae_C1]]></Label>"
    "</LabelTable></VolumeInformation><VolumeInformation Index=\"1\"><LabelTable><Label "
    "Key=\"7\">x</Label>"
    "</LabelTable></VolumeInformation></CaretExtension>";

TEST(NiftiExtensions, GiveConnectomesLabelTable) {
    for (const bool isSwapped : {false, true}) {
        const LabelTable table = decodeEmbeddedTable(niftiWith(kConnectome, isSwapped));
        EXPECT_EQ(table.format, "NIfTI extension");
        ASSERT_EQ(table.entries.size(), 2u);
        EXPECT_EQ(table.entries[1], (LabelEntry{50, "vertebrae_C1", "", LabelColor{0, 128, 255}}));
        EXPECT_EQ(decodeEmbeddedTable(niftiWith(kConnectome, isSwapped), 1).entries,
                  (Entries{{7, "x", "", {}}}));
    }
    std::string none = niftiWith(kConnectome);
    none[348] = 0;  // says that no extension follows
    EXPECT_TRUE(decodeEmbeddedTable(none).entries.empty());
    EXPECT_TRUE(decodeEmbeddedTable(niftiWith(kConnectome, false, 380)).entries.empty());
}

TEST(NiftiExtensions, CutOffOrWildAreErrorsOrNothing) {
    const std::string sound = niftiWith(kConnectome);
    for (std::size_t length = 0; length < sound.size(); ++length) {
        try {
            decodeEmbeddedTable(std::string_view(sound).substr(0, length));
        } catch (const FileError&) {
        }
    }
    std::string wild = sound;
    wild.replace(352, 4, "\xFF\xFF\xFF\x7F");
    EXPECT_TRUE(decodeEmbeddedTable(wild).entries.empty());
    wild.replace(352, 4, "\0\0\0\0"s);
    EXPECT_TRUE(decodeEmbeddedTable(wild).entries.empty());
    EXPECT_THROW(
        decodeEmbeddedTable(niftiWith("<LabelTable><Label Key=\"x\">a</Label></LabelTable>")),
        FileError);
}

TEST(EmbeddedTables, ComeAfterThoseBesideTheImage) {
    const fs::path folder = fs::temp_directory_path() / ("inside-" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "a.seg.nrrd", std::ios::binary) << kSlicer;
    const std::string nifti = niftiWith(kConnectome);
    gzFile stream = gzopen((folder / "b.nii.gz").c_str(), "wb");
    gzwrite(stream, nifti.data(), static_cast<unsigned>(nifti.size()));
    gzclose(stream);
    const FoundLabelTables slicer = findLabelTables(folder / "a.seg.nrrd");
    EXPECT_EQ(slicer.files, (std::vector<fs::path>{folder / "a.seg.nrrd"}));
    EXPECT_EQ(slicer.table.find(3)->name, "right lung");
    EXPECT_EQ(findLabelTables(folder / "a.seg.nrrd", 1).table.find(12)->name, "gro\xC3\x9F");
    EXPECT_EQ(findLabelTables(folder / "b.nii.gz").table.find(50)->name, "vertebrae_C1");
    std::ofstream(folder / "a.txt") << "3 given\n";
    EXPECT_EQ(findLabelTables(folder / "a.seg.nrrd").table.find(3)->name, "given");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace adaptiso
