// Files of values at the points of a surface in another file. What nibabel makes of them is tested
// by clients.py.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso {
namespace {

using testing::bytesOf;
using testing::messageOf;
using testing::temporaryFile;

std::string big32(std::int32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFF);
    return bytes;
}

std::string text32(const std::string& text) {
    return big32(static_cast<std::int32_t>(text.size())) + text;
}

/// Version 2, with one entry.
std::string smallTable() {
    return big32(1) + big32(-2) + big32(2) + text32("colors.txt") + big32(1) + big32(1) +
           text32("cortex") + big32(25) + big32(5) + big32(25) + big32(0);
}

PointData curv() {
    return {PointDataFormat::FreeSurferCurv,
            3,
            {{{}, std::vector<float>{1.5f, -2, 1e-30f}, 1, {}}},
            {},
            {},
            {}};
}

PointData annot() {
    return {PointDataFormat::FreeSurferAnnot,
            3,
            {{{}, std::vector<std::int32_t>{1639705, 0, -1}, 1, {}}},
            {},
            smallTable(),
            {}};
}

PointData gifti() {
    PointData data{PointDataFormat::Gifti, 3, {}, {}, {}, {}};
    data.metadata = {{"AnatomicalStructurePrimary", "CortexLeft"}};
    data.labels = {{0, "???", std::array<double, 4>{1, 1, 1, 0}}, {7, "a < b & \"c\"", {}}};
    data.arrays = {{"NIFTI_INTENT_SHAPE", std::vector<float>{1, NAN, 3}, 1, {{"Name", "depth"}}},
                   {"NIFTI_INTENT_LABEL", std::vector<std::int32_t>{7, 0, 7}, 1, {}},
                   {"NIFTI_INTENT_VECTOR", std::vector<float>{1, 2, 3, 4, 5, 6}, 2, {}}};
    return data;
}

PointData mgh() {
    PointData data{PointDataFormat::FreeSurferMgh, 3, {}, {}, {}, {}};
    data.arrays = {{{}, std::vector<float>{1, -2, NAN}, 1, {}},
                   {{}, std::vector<float>{0.5f, 0, 1e30f}, 1, {}}};
    return data;
}

/// A header of .mgh.
std::string mghHeader(std::int32_t width, std::int32_t height, std::int32_t depth,
                      std::int32_t frames, std::int32_t type) {
    return big32(1) + big32(width) + big32(height) + big32(depth) + big32(frames) + big32(type) +
           std::string(260, '\0');
}

PointData roundTrip(const PointData& data, const std::string& name) {
    const auto path = temporaryFile(name);
    writePointData(data, 5, path);
    return readPointData(path);
}

template <class T>
std::vector<T> valuesOf(const PointData& data, std::size_t array = 0) {
    return std::get<std::vector<T>>(data.arrays.at(array).values);
}

TEST(PointData, FormatsFollowFromNames) {
    EXPECT_EQ(findPointDataFormat("a/lh.thickness"), PointDataFormat::FreeSurferCurv);
    EXPECT_EQ(findPointDataFormat("rh.aparc.a2009s.annot"), PointDataFormat::FreeSurferAnnot);
    EXPECT_EQ(findPointDataFormat("x.shape.GII"), PointDataFormat::Gifti);
    EXPECT_EQ(findPointDataFormat("lh.area.fsaverage.mgh"), PointDataFormat::FreeSurferMgh);
}

TEST(PointData, CurvComesBack) {
    const PointData back = roundTrip(curv(), "lh.thickness");
    EXPECT_EQ(back.points, 3);
    EXPECT_EQ(valuesOf<float>(back), valuesOf<float>(curv()));
    const std::string bytes = bytesOf(std::filesystem::path(::testing::TempDir()) /
                                      "meshio_PointData_CurvComesBack" / "lh.thickness");
    EXPECT_EQ(bytes.substr(0, 15), "\xFF\xFF\xFF" + big32(3) + big32(5) + big32(1));
}

TEST(PointData, CurvOfBefore2000IsInHundredths) {
    const std::string bytes{"\0\0\2\0\0\1\x00\x96\xFF\x38", 10};
    const PointData data = decodePointData(bytes, PointDataFormat::FreeSurferCurv, "lh.curv");
    EXPECT_EQ(valuesOf<float>(data), (std::vector<float>{1.5f, -2}));
}

TEST(PointData, AnnotKeepsItsTableToTheByte) {
    const PointData back = roundTrip(annot(), "lh.aparc.annot");
    EXPECT_EQ(valuesOf<std::int32_t>(back), valuesOf<std::int32_t>(annot()));
    EXPECT_EQ(back.annotTable, smallTable());
}

TEST(PointData, AnnotsOfTheOldVersionAndWithoutTableAreRead) {
    const std::string labels = big32(2) + big32(1) + big32(11) + big32(0) + big32(10);
    const std::string old = big32(1) + big32(1) + text32("table") + text32("one") + big32(1) +
                            big32(2) + big32(3) + big32(0);
    for (const std::string& table : {std::string(), big32(0), old}) {
        const PointData data =
            decodePointData(labels + table, PointDataFormat::FreeSurferAnnot, "lh.annot");
        EXPECT_EQ(valuesOf<std::int32_t>(data), (std::vector<std::int32_t>{10, 11}));
        EXPECT_EQ(data.annotTable, table);
    }
}

TEST(PointData, MghComesBackFrameByFrame) {
    const PointData back = roundTrip(mgh(), "lh.thickness.mgh");
    EXPECT_EQ(back.points, 3);
    ASSERT_EQ(back.arrays.size(), 2u);
    EXPECT_TRUE(std::isnan(valuesOf<float>(back)[2]));
    EXPECT_EQ(valuesOf<float>(back, 1), valuesOf<float>(mgh(), 1));
    PointData labels = annot();
    labels.format = PointDataFormat::FreeSurferMgh;
    EXPECT_EQ(valuesOf<std::int32_t>(roundTrip(labels, "lh.labels.mgh")),
              valuesOf<std::int32_t>(labels));
}

TEST(PointData, MghOfAnyShapeAndWholeNumbersIsRead) {
    const auto Mgh = PointDataFormat::FreeSurferMgh;
    const std::string shorts("\x00\x07\xFF\xFE\x01\x00", 6);
    const std::string tags = "whatever follows";
    EXPECT_EQ(valuesOf<std::int32_t>(
                  decodePointData(mghHeader(1, 3, 1, 1, 4) + shorts + tags, Mgh, "a.mgh")),
              (std::vector<std::int32_t>{7, -2, 256}));
    const PointData bytes = decodePointData(mghHeader(1, 1, 3, 2, 0) + shorts, Mgh, "a.mgh");
    EXPECT_EQ(bytes.points, 3);
    EXPECT_EQ(valuesOf<std::int32_t>(bytes, 1), (std::vector<std::int32_t>{254, 1, 0}));
}

TEST(PointData, ItsKindsThatAreNotReadAreToldByName) {
    for (const auto& [name, words] : {std::pair{"lh.thickness.mgz", "unpack it"},
                                      std::pair{"lh.cortex.label", "mris_label2annot"},
                                      std::pair{"S.dscalar.nii", "wb_command"}}) {
        const std::string message = messageOf<FileError>([name = name] { readPointData(name); });
        EXPECT_TRUE(message.starts_with(std::string(name) + ": ")) << message;
        EXPECT_NE(message.find(words), std::string::npos) << message;
    }
}

TEST(PointData, GiftiComesBack) {
    const PointData back = roundTrip(gifti(), "lh.label.gii");
    ASSERT_EQ(back.arrays.size(), 3u);
    EXPECT_EQ(back.points, 3);
    EXPECT_TRUE(std::isnan(valuesOf<float>(back)[1]));
    EXPECT_EQ(valuesOf<std::int32_t>(back, 1), (std::vector<std::int32_t>{7, 0, 7}));
    EXPECT_EQ(back.arrays[2].columns, 2);
    EXPECT_EQ(valuesOf<float>(back, 2), (std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(back.arrays[0].intent, "NIFTI_INTENT_SHAPE");
    EXPECT_EQ(back.arrays[0].metadata, gifti().arrays[0].metadata);
    EXPECT_EQ(back.metadata, gifti().metadata);
    ASSERT_EQ(back.labels.size(), 2u);
    EXPECT_EQ(back.labels[1].name, "a < b & \"c\"");
    EXPECT_FALSE(back.labels[1].rgba);
    EXPECT_EQ(back.labels[0].rgba, gifti().labels[0].rgba);
}

std::string giftiText(const std::string& array, const std::string& before = "") {
    return "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"1\">" + before +
           "<DataArray Intent=\"NIFTI_INTENT_NONE\" Encoding=\"ASCII\" " + array +
           "</Data></DataArray></GIFTI>";
}

TEST(PointData, ForeignGiftiIsRead) {
    const std::string text = giftiText(
        "DataType=\"NIFTI_TYPE_UINT8\" Dimensionality=\"2\" Dim0=\"3\" Dim1=\"2\" "
        "ArrayIndexingOrder=\"ColumnMajorOrder\"><Data>1 2 3 4 5 6",
        "<MetaData><MD><Name>UserName</Name><Value>jane</Value></MD>"
        "<MD><Name><![CDATA[AnatomicalStructurePrimary]]></Name><Value>CortexRight</Value></MD>"
        "</MetaData><LabelTable><Label Index=\"3\">old</Label></LabelTable>");
    const PointData data = decodePointData(text, PointDataFormat::Gifti, "a.gii");
    EXPECT_EQ(valuesOf<std::int32_t>(data), (std::vector<std::int32_t>{1, 4, 2, 5, 3, 6}));
    ASSERT_EQ(data.metadata.size(), 1u);  // who made it is nobody's business
    EXPECT_EQ(data.metadata[0].second, "CortexRight");
    EXPECT_EQ(data.labels.at(0).key, 3);
}

PointData withLabels(const std::string& labels) {
    return decodePointData(giftiText("DataType=\"NIFTI_TYPE_INT32\" Dim0=\"2\"><Data>1 2",
                                     "<LabelTable>" + labels + "</LabelTable>"),
                           PointDataFormat::Gifti, "a.gii");
}

std::string labelText(int key, const std::string& name, const std::string& rgba) {
    std::string text = "<Label Key=\"" + std::to_string(key) + "\"";
    static constexpr const char* kChannels[] = {"Red", "Green", "Blue", "Alpha"};
    std::size_t at = 0;
    for (const char* const channel : kChannels) {
        const std::size_t end = std::min(rgba.find(' ', at), rgba.size());
        text += " " + std::string(channel) + "=\"" + rgba.substr(at, end - at) + "\"";
        at = end + 1;
    }
    return text + ">" + name + "</Label>";
}

TEST(PointData, LabelColoursOf0To255AreReadAsSuch) {
    using Rgba = std::array<double, 4>;
    const PointData bytes =
        withLabels(labelText(1, "a", "255 0 51 1") + labelText(2, "b", "1 1 0 1"));
    EXPECT_EQ(bytes.labels.at(0).rgba, (Rgba{1, 0, 0.2, 1}));
    EXPECT_EQ(bytes.labels.at(1).rgba, (Rgba{1 / 255., 1 / 255., 0, 1}));
    EXPECT_EQ(withLabels(labelText(1, "a", "0 0 2 255")).labels.at(0).rgba,
              (Rgba{0, 0, 2 / 255., 1}));
    EXPECT_TRUE(bytes.warnings.empty());
    const PointData parts = withLabels(labelText(1, "a", "1 0 0.5 0.25"));
    EXPECT_EQ(parts.labels.at(0).rgba, (Rgba{1, 0, 0.5, 0.25}));
    EXPECT_TRUE(parts.warnings.empty());
    for (const char* const bad : {"256 0 0 1", "-1 0 0 1", "0 0 0 65535"}) {
        const PointData odd = withLabels(labelText(1, "a", bad) + labelText(2, "b", "1 0 0 1"));
        EXPECT_FALSE(odd.labels.at(0).rgba);
        EXPECT_EQ(odd.labels.at(0).name, "a");
        EXPECT_EQ(odd.labels.at(1).rgba, (Rgba{1, 0, 0, 1}));
        ASSERT_EQ(odd.warnings.size(), 1U);
        EXPECT_EQ(odd.warnings[0].code, "colors-not-read");
    }
}

TEST(PointData, OfLabelsThatAreListedTwiceTheFirstCounts) {
    const std::string first = labelText(1, "a", "1 0 0 1");
    const PointData twice =
        withLabels(first + labelText(2, "c", "0 0 1 1") + labelText(1, "b", "1 0 0 1"));
    ASSERT_EQ(twice.labels.size(), 2U);
    EXPECT_EQ(twice.labels[0].name, "a");
    EXPECT_EQ(twice.labels[1].name, "c");
    ASSERT_EQ(twice.warnings.size(), 1U);
    EXPECT_EQ(twice.warnings[0].code, "label-listed-twice");
    EXPECT_NE(twice.warnings[0].text.find("label 1 is listed twice"), std::string::npos);
    EXPECT_EQ(withLabels(first + labelText(1, "a", "0 1 0 1")).warnings.size(), 1U);
    const PointData same = withLabels(first + first);
    EXPECT_EQ(same.labels.size(), 1U);
    EXPECT_TRUE(same.warnings.empty());
}

TEST(PointData, WhatIsNotReadIsRefusedInALine) {
    const std::string two = big32(2) + big32(0) + big32(1) + big32(1) + big32(1);
    struct Case {
        std::string bytes;
        PointDataFormat format;
        std::string words;
    };
    const auto Curv = PointDataFormat::FreeSurferCurv;
    const auto Annot = PointDataFormat::FreeSurferAnnot;
    const auto Mgh = PointDataFormat::FreeSurferMgh;
    const auto Gifti = PointDataFormat::Gifti;
    const std::string float3 = "DataType=\"NIFTI_TYPE_FLOAT32\" Dim0=\"3\"><Data>";
    const Case cases[] = {
        {"", Curv, "ends after 0 bytes"},
        {"solid a\nfacet", Curv, "does not begin with FF FF FF"},
        {"\xFF\xFF\xFF" + big32(3) + big32(1) + big32(2) + big32(0), Curv, "2 values for each"},
        {"\xFF\xFF\xFF" + big32(2000000000) + big32(1) + big32(1) + big32(0), Curv, "2000000000"},
        {"\xFF\xFF\xFF" + big32(-3) + big32(1) + big32(1) + big32(0), Curv, "-3 values"},
        {"\xFF\xFF\xFF" + big32(0) + big32(1) + big32(1), Curv, "holds no values"},
        {big32(2) + big32(5) + big32(1) + big32(1) + big32(1), Annot, "the point 5 of 2"},
        {big32(2) + big32(1) + big32(1) + big32(1) + big32(1), Annot, "two labels for the point 1"},
        {big32(900000000), Annot, "900000000"},
        {two + big32(1) + big32(-3), Annot, "unknown version"},
        {two + big32(1) + big32(-2) + big32(1) + text32("x") + big32(400000000), Annot, "labels"},
        {two + big32(1) + big32(1) + big32(70000), Annot, "characters"},
        {big32(2) + big32(3), Mgh, "begin"},
        {mghHeader(3, 1, 1, 1, 3) + big32(0), Mgh, "3 values"},
        {mghHeader(1, 1, 1, 900000000, 3) + big32(0), Mgh, "900000000 frames"},
        {mghHeader(2000000000, 2000000000, 2000000000, 1, 0), Mgh, "values"},
        {mghHeader(-1, -1, 1, 1, 3), Mgh, "values"},
        {mghHeader(0, 1, 1, 1, 3), Mgh, "no values"},
        {mghHeader(1, 1, 1, 0, 3) + big32(0), Mgh, "no values"},
        {mghHeader(1, 1, 1, 1, 2) + big32(0), Mgh, "type 2"},
        {"<x/>", Gifti, "must be GIFTI"},
        {"<GIFTI/>", Gifti, "no values"},
        {giftiText(float3 + "1 2"), Gifti, "values"},
        {giftiText("DataType=\"NIFTI_TYPE_FLOAT64\" Dim0=\"1\"><Data>1"), Gifti, "FLOAT64"},
        {giftiText("DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"2\" Dim0=\"1\" "
                   "Dim1=\"9000000000000000000\"><Data>1"),
         Gifti, "columns"},
        {giftiText("DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"2\" Dim0=\"1\" "
                   "Dim1=\"0\"><Data>1"),
         Gifti, "no values"},
        {giftiText("DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"3\" Dim0=\"1\"><Data>1"), Gifti,
         "dimensions"},
    };
    for (const auto& [bytes, format, words] : cases) {
        const std::string message = messageOf<FileError>(
            [&, &data = bytes, kind = format] { decodePointData(data, kind, "file"); });
        EXPECT_TRUE(message.starts_with("file: ")) << message << " / " << words;
        EXPECT_NE(message.find(words), std::string::npos) << message << " / " << words;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    const std::string sparse = "<GIFTI><DataArray Intent=\"NIFTI_INTENT_NODE_INDEX\"/></GIFTI>";
    EXPECT_THROW(decodePointData(sparse, Gifti, "file"), FileError);
    EXPECT_THROW(readPointData(temporaryFile("none.annot")), FileError);
}

TEST(PointData, ThatDoesNotFitIsNotWritten) {
    const auto path = temporaryFile("lh.thickness");
    PointData two = curv();
    two.arrays.push_back(two.arrays.front());
    PointData few = curv();
    few.points = 4;
    PointData kind = curv();
    kind.format = PointDataFormat::FreeSurferAnnot;
    PointData table = annot();
    table.annotTable.resize(20);
    PointData mixed = mgh(), columns = mgh();
    mixed.arrays.push_back({{}, std::vector<std::int32_t>{1, 2, 3}, 1, {}});
    columns.arrays[0] = {{}, std::vector<float>(6), 2, {}};
    for (const PointData& bad : {PointData{}, two, few, kind, table, mixed, columns}) {
        EXPECT_THROW(writePointData(bad, 1, path), InvalidInput);
        EXPECT_FALSE(std::filesystem::exists(path));
    }
    EXPECT_THROW(writePointData(curv(), 1, path / "x"), FileError);
}

TEST(PointData, DamagedAtRandomIsAnErrorOrData) {
    std::mt19937 random(5u);
    const std::pair<PointData, std::string> sources[] = {{curv(), "lh.curv"},
                                                         {annot(), "lh.annot"},
                                                         {mgh(), "lh.area.mgh"},
                                                         {gifti(), "lh.shape.gii"}};
    for (const auto& [data, name] : sources) {
        const auto path = temporaryFile(name);
        writePointData(data, 1, path);
        const std::string sound = bytesOf(path);
        for (int round = 0; round < 3000; ++round) {
            std::string bytes = sound;
            bytes[random() % bytes.size()] ^= static_cast<char>(1u << (random() % 8));
            if (round % 3 == 0) bytes.resize(random() % bytes.size());
            try {
                const PointData read = decodePointData(bytes, data.format, name);
                writePointData(read, 1, path);  // what is read can be written
            } catch (const FileError& error) {
                EXPECT_TRUE(std::string(error.what()).starts_with(name + ": ")) << error.what();
            }
        }
    }
}

}  // namespace
}  // namespace adaptiso
