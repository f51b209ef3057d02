// Each format as its program writes it, what tells formats apart, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "Support/Pages.h"
#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso {
namespace {

constexpr LabelColor kRed{255, 0, 0}, kOrange{255, 128, 0};

LabelTable decoded(const std::string& text) {
    return decodeLabelTable(text, "x");
}

const LabelEntry& entryOf(const LabelTable& table, std::int32_t value) {
    static const LabelEntry none;
    const LabelEntry* const entry = table.find(value);
    EXPECT_NE(entry, nullptr) << value;
    return entry == nullptr ? none : *entry;
}

std::string refusalOf(const std::string& text) {
    try {
        decoded(text);
    } catch (const FileError& error) {
        return error.what();
    }
    return "taken";
}

TEST(LabelTable, ReadsBids) {
    const LabelTable table = decoded(
        "index\tname\tabbreviation\tcolor\tmapping\n"
        "1\tGray Matter\tGM\t#ff0000\t1\n"
        "2\tWhite/Matter\tn/a\tn/a\t2\n");
    EXPECT_EQ(table.format, "BIDS");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "Gray Matter", "GM", kRed}));
    EXPECT_EQ(entryOf(table, 2), (LabelEntry{2, "White/Matter", "", {}}));
    EXPECT_EQ(table.find(3), nullptr);
}

// Ids of connectomes: more digits than a double has.
TEST(LabelTable, ReadsIndicesOf64Bits) {
    const LabelTable table =
        decoded("index\tname\n720575940621039145\tneuron\n-9007199254740993\tfar\n");
    ASSERT_EQ(table.entries.size(), 2U);
    EXPECT_EQ(table.find(720575940621039145)->name, "neuron");
    EXPECT_EQ(table.find(-9007199254740993)->name, "far");
    EXPECT_EQ(table.find(720575940621039144), nullptr);
    EXPECT_THROW(decoded("index\tname\n9223372036854775808\tbeyond\n"), FileError);
}

TEST(LabelTable, ReadsFreeSurfer) {
    const LabelTable table = decoded(
        "#$Id: FreeSurferColorLUT.txt\n\n#No. Label Name: R G B A\n"
        "0   Unknown                 0   0   0   0\n"
        "1001    ctx-lh-bankssts     255 128 0   0\r\n");
    EXPECT_EQ(table.format, "FreeSurfer");
    EXPECT_EQ(entryOf(table, 1001), (LabelEntry{1001, "ctx-lh-bankssts", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 a_b 255 0 0\n2 c 1 2 3\n"), 1), (LabelEntry{1, "a_b", "", kRed}));
}

TEST(LabelTable, ReadsSlicersColorTablesWithBlanksForUnderscores) {
    const LabelTable table = decoded(
        "# Color table file /tmp/GenericColors.txt\n# 2 values\n"
        "0 background 0 0 0 0\n1 left_ventricle 255 0 0 255\n");
    EXPECT_EQ(table.format, "3D Slicer");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "left ventricle", "", kRed}));
}

TEST(LabelTable, ReadsSlicersCommas) {
    const LabelTable table = decoded(
        "LabelValue,Name,Color_R,Color_G,Color_B,Color_A\n"
        "1,\"lobe, \"\"left\"\"\",255,128,0,255\n2,right,,,,\n");
    EXPECT_EQ(table.format, "3D Slicer");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "lobe, \"left\"", "", kOrange}));
    EXPECT_EQ(entryOf(table, 2).color, std::nullopt);
}

TEST(LabelTable, ReadsItkSnap) {
    const LabelTable table = decoded(
        "################################################\n# ITK-SnAP Label Description File\n"
        "    0     0    0    0        0  0  0    \"Clear Label\"\n"
        "    1   255    0    0        1  1  1    \"Label 1\"\n");
    EXPECT_EQ(table.format, "ITK-SNAP");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "Label 1", "", kRed}));
    EXPECT_EQ(entryOf(table, 0).name, "Clear Label");
}

TEST(LabelTable, ReadsMricronsNamesWithAndWithoutCodes) {
    EXPECT_EQ(entryOf(decoded("1 Precentral_L 2001\r\n2 Precentral_R 2002\r\n\r\n"), 2).name,
              "Precentral_R");
    EXPECT_EQ(entryOf(decoded("0\tUnclassified\r\n1\tMiddle cerebellar\r\n"), 1).name,
              "Middle cerebellar");
    // the number is what tells these apart, so it is no code
    EXPECT_EQ(entryOf(decoded("1 Area 1\n2 Area 2\n4 Area 4\n"), 4).name, "Area 4");
}

TEST(LabelTable, ReadsMricronsColors) {
    std::string bytes(768, '\0');
    bytes[7] = '\xff';
    bytes[256 + 7] = '\x80';
    const LabelTable table = decoded(bytes);
    EXPECT_EQ(entryOf(table, 7), (LabelEntry{7, "", "", kOrange}));
    EXPECT_EQ(table.entries.size(), 1U) << "black is no colour";
    EXPECT_THROW(decoded(std::string(768, '\0')), NoLabelTable);
}

TEST(LabelTable, ReadsFreeSurfersTypesOfTissue) {
    // FreeSurferColorLUT.txt of 8.0.0 has them in some rows, gtmseg.ctab in all
    const LabelTable some = decoded(
        "#No. Label Name:                            R   G   B   A\n"
        "17  Left-Hippocampus                220 216  20 0\n18 Left-Amygdala 103 255 255 0\n"
        "819 Left-HypoThal-noMB           0  80   0 0 2\n820 Right-HypoThal-noMB  15 165 15 0 0\n");
    EXPECT_EQ(some.format, "FreeSurfer");
    EXPECT_EQ(entryOf(some, 17),
              (LabelEntry{17, "Left-Hippocampus", "", LabelColor{220, 216, 20}}));
    EXPECT_EQ(entryOf(some, 819),
              (LabelEntry{819, "Left-HypoThal-noMB", "", LabelColor{0, 80, 0}}));
    EXPECT_EQ(entryOf(some, 820).name, "Right-HypoThal-noMB");
    const LabelTable all = decoded("0 Unknown 0 0 0 0 0\n17 Left-Hippocampus 220 216 20 0 2\n");
    EXPECT_EQ(entryOf(all, 17), (LabelEntry{17, "Left-Hippocampus", "", LabelColor{220, 216, 20}}));
    EXPECT_EQ(entryOf(all, 0).name, "Unknown");
    // the name ends in a number, and opacity is the same in all rows
    for (const char* const opacity : {"0", "255"}) {
        const std::string o = opacity;
        const LabelTable areas = decoded("1 Area 44 200 30 40 " + o + "\n2 Area 45 10 20 0 " + o +
                                         "\n3 Insula 1 2 3 " + o + "\n");
        EXPECT_EQ(entryOf(areas, 1), (LabelEntry{1, "Area 44", "", LabelColor{200, 30, 40}}));
        EXPECT_EQ(entryOf(areas, 2), (LabelEntry{2, "Area 45", "", LabelColor{10, 20, 0}}));
    }
}

TEST(LabelTable, ReadsColoursBeforeNames) {
    const LabelTable parts = decoded(
        "1 0.47059 0.070588 0.51373 7Networks_LH_Vis_1\n2 0 1 0 3rd Ventricle\n3 0 0 1 44\n");
    EXPECT_EQ(parts.format, "FSLeyes");
    EXPECT_EQ(entryOf(parts, 1),
              (LabelEntry{1, "7Networks_LH_Vis_1", "", LabelColor{120, 18, 131}}));
    EXPECT_EQ(entryOf(parts, 2), (LabelEntry{2, "3rd Ventricle", "", LabelColor{0, 255, 0}}));
    EXPECT_EQ(entryOf(parts, 3).name, "44");
    EXPECT_EQ(entryOf(decoded("1 1 0 0 Left\n2 0 0 1 Right\n"), 1).color, kRed);
    EXPECT_EQ(entryOf(decoded("1 255 128 0 Left Femur\n2 0 0 1 b\n"), 1),
              (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 255 128 0 255 Left Femur\n2 0 0 1 255 b\n"), 1),
              (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1;255;128;0;Left Femur\n2;0;0;1;b\n"), 1),
              (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_NE(refusalOf("1 0.1 0.2 0.3 a\n2 0.1 0.2 b\n3 0 0 0 c\n").find("line 2"),
              std::string::npos);
}

TEST(LabelTable, ReadsTablesWithoutAHeaderByTheirColumns) {
    for (const char separator : {' ', '\t', ',', ';'}) {
        const auto row = [&](std::string text) {
            std::ranges::replace(text, ' ', separator);
            return text;
        };
        const LabelTable table = decoded(row("1 Femur_L 255 128 0\n2 Femur_R 1 2 3\n"));
        EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "Femur_L", "", kOrange})) << separator;
        EXPECT_EQ(entryOf(decoded(row("1 Femur_L\n2 Femur_R\n")), 2),
                  (LabelEntry{2, "Femur_R", "", {}}))
            << separator;
    }
    EXPECT_EQ(entryOf(decoded("1\tArea 44\t255\t128\t0\n2\tArea 45\t1\t2\t3\n"), 1),
              (LabelEntry{1, "Area 44", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 \"Left Femur\" 255 128 0 255\n2 b 1 2 3 255\n"), 1),
              (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 Femur 1 0.502 0\n2 b 0 0.25 1\n"), 1).color, kOrange);
    EXPECT_EQ(entryOf(decoded("1 Left Femur #ff8000\n2 b #000000\n"), 1),
              (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 Femur 255 128 0 0  # the thigh\n2 b 1 2 3 0 #shin\n"), 2),
              (LabelEntry{2, "b", "", LabelColor{1, 2, 3}}));
    EXPECT_EQ(entryOf(decoded("1 Lesion #1\n2 Lesion #2\n"), 2).name, "Lesion #2");
}

TEST(LabelTable, ReadsMrtrixAndAalAndWorkbench) {
    const LabelTable mrtrix = decoded(
        "#ROI  short  long  R G B A\n1  L.BSTS  ctx-lh-bankssts  255 128 0 255\n"
        "2  L.CACG  ctx-lh-caudalanteriorcingulate  125 100 160 255\n");
    EXPECT_EQ(entryOf(mrtrix, 1), (LabelEntry{1, "ctx-lh-bankssts", "L.BSTS", kOrange}));
    EXPECT_EQ(entryOf(decoded("FAG\tPrecentral_L\t2001\nFAD\tPrecentral_R\t2002\n"), 2001),
              (LabelEntry{2001, "Precentral_L", "FAG", {}}));
    const LabelTable workbench = decoded("Left Femur\n1 255 128 0 255\nPelvis\n7 0 0 255 255\n");
    EXPECT_EQ(workbench.format, "Connectome Workbench");
    EXPECT_EQ(entryOf(workbench, 1), (LabelEntry{1, "Left Femur", "", kOrange}));
    EXPECT_EQ(entryOf(workbench, 7).name, "Pelvis");
}

TEST(LabelTable, ReadsHeadersOfOtherPrograms) {
    // CAT12's atlases, ANTs' and TotalSegmentator's lists
    EXPECT_EQ(entryOf(decoded("ROIid;ROIabbr;ROIname\n3;l3thVen;Left 3th Ventricle\n"), 3),
              (LabelEntry{3, "Left 3th Ventricle", "l3thVen", {}}));
    EXPECT_EQ(entryOf(decoded("Label,Name\n3,\"Femur, left\"\n"), 3).name, "Femur, left");
    EXPECT_EQ(entryOf(decoded("Index,TotalSegmentator name\n1,spleen\n"), 1).name, "spleen");
    EXPECT_EQ(entryOf(decoded("index;name;r;g;b\n1;a;1,0;0,502;0,0\n2;b;0;0,5;0\n;;;;\n"), 1).color,
              kOrange)
        << "decimal commas";
    EXPECT_EQ(entryOf(decoded("\"index\"\t\"name\"\n1\t\"Left Femur\"\n"), 1).name, "Left Femur");
    EXPECT_EQ(entryOf(decoded("index\tname\n1\t'=HYPERLINK(\"x\")\n"), 1).name,
              "=HYPERLINK(\"x\")");
}

// Numbers that stand beside a name are no part of it.
TEST(LabelTable, RefusesColumnsThatItDoesNotKnow) {
    for (const char* const text :
         {"1 4 Left-Lateral-Ventricle\n2 5 Left-Inf-Lat-Vent\n",
          "1 Precentral_L 2001 155\n2 Precentral_R 2002 172\n",
          "1 4 7000 7000.0 Ventricle 20 4 1 40 39\n2 5 80 81.0 Vent 21 4 1 40 39\n",
          "1 a 1 2 3 4 5 6 7\n2 b 1 2 3 4 5 6 7\n"}) {
        EXPECT_NE(refusalOf(text).find("columns are those of no table"), std::string::npos) << text;
    }
}

TEST(LabelTable, KeepsNamesWhoseColourCannotBeRead) {
    const LabelTable table = decoded(
        "index\tname\tcolor\n1\ta\tred\n2\tb\t#f80\n3\tc\trgb(255, 128, 0)\n4\td\treddish\n"
        "5\te\t#ff8000\n6\tf\t#ff800080\n7\tg\t\n8\th\tn/a\n");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "a", "", kRed}));
    EXPECT_EQ(entryOf(table, 2).color, (LabelColor{255, 136, 0}));
    for (const int value : {3, 5, 6}) EXPECT_EQ(entryOf(table, value).color, kOrange) << value;
    for (const int value : {4, 7, 8}) EXPECT_EQ(entryOf(table, value).color, std::nullopt) << value;
    EXPECT_EQ(entryOf(table, 4).name, "d");
    ASSERT_EQ(table.warnings.size(), 1U);
    EXPECT_EQ(table.warnings[0].code, "colors-not-read");
    EXPECT_NE(table.warnings[0].text.find("that of line 5 is 'reddish'"), std::string::npos)
        << table.warnings[0].text;
    for (const char* const text :
         {"1 a 255 0 0 0\n2 b 1 2 300 0\n3 c 1 2 3 0\n", "1 255 0 0 a\n2 1 2 300 b\n3 1 2 3 c\n",
          "LabelValue,Name,Color_R,Color_G,Color_B\n1,a,255,0,0\n2,b,1,x,2\n3,c,1,2,3\n",
          "1 255 0 0 1 1 1 \"a\"\n2 1 -2 3 1 1 1 \"b\"\n3 1 2 3 1 1 1 \"c\"\n",
          R"({"1": {"name": "a", "color": "red"}, "2": {"name": "b", "color": "no"}})",
          R"([{"index": 1, "name": "a", "rgb": [255, 0, 0]},
              {"index": 2, "name": "b", "rgb": [1, 2, 300]}])",
          R"({"R": [255, 1], "G": [0, "x"], "B": [0, 2], "I": [1, 2], "labels": ["a", "b"]})",
          "<GIFTI><LabelTable><Label Key=\"1\" Red=\"1\" Green=\"0\" Blue=\"0\">a</Label>"
          "<Label Key=\"2\" Red=\"1\" Green=\"2\" Blue=\"0\">b</Label></LabelTable></GIFTI>"}) {
        const LabelTable kept = decoded(text);
        EXPECT_EQ(entryOf(kept, 1), (LabelEntry{1, "a", "", kRed})) << text;
        EXPECT_EQ(entryOf(kept, 2), (LabelEntry{2, "b", "", {}})) << text;
        ASSERT_EQ(kept.warnings.size(), 1U) << text;
        EXPECT_EQ(kept.warnings[0].code, "colors-not-read");
    }
    // places in mm rather than colours
    const LabelTable places = decoded("1 a -38.6 -5.6 50.9\n2 b 41.4 8.2 52.1\n3 c -18 35 -42\n");
    EXPECT_EQ(entryOf(places, 2), (LabelEntry{2, "b", "", {}}));
}

TEST(LabelTable, ReadsGifti) {
    const LabelTable table = decoded(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<GIFTI Version=\"1.0\"><MetaData/>\n"
        "<LabelTable><Label Key=\"0\" Red=\"1\" Green=\"1\" Blue=\"1\" Alpha=\"0\">none</Label>\n"
        "<Label Key=\"-3\" Red=\"1\" Green=\"0.502\" Blue=\"0\"><![CDATA[a < b]]></Label>"
        "</LabelTable></GIFTI>");
    EXPECT_EQ(table.format, "GIFTI");
    EXPECT_EQ(entryOf(table, -3), (LabelEntry{-3, "a < b", "", kOrange}));
}

TEST(LabelTable, ReadsFslsAtlases) {
    const std::string labels =
        "<data><label index=\"0\" x=\"48\" y=\"94\" z=\"35\">Frontal Pole</label>"
        "<label index=\"1\" x=\"1\" y=\"2\" z=\"3\">Insular</label></data></atlas>";
    const std::string head = "<?xml version=\"1.0\"?><atlas version=\"1.0\"><header><name>x</name>";
    // a probabilistic atlas's summary image counts from 1
    EXPECT_EQ(entryOf(decoded(head + "<type>Probabilistic</type></header>" + labels), 1).name,
              "Frontal Pole");
    EXPECT_EQ(entryOf(decoded(head + "<type>Label</type></header>" + labels), 1).name, "Insular");
}

TEST(LabelTable, ReadsJson) {
    EXPECT_EQ(entryOf(decoded(R"({"1": "left", "2": {"name": "right", "color": "#ff0000"}})"), 2),
              (LabelEntry{2, "right", "", kRed}));
    EXPECT_EQ(
        entryOf(decoded(R"([{"id": 8, "acronym": "grey", "name": "Grey", "rgb_triplet": [255, 128,
                           0]}])"),
                8),
        (LabelEntry{8, "Grey", "grey", kOrange}));
    EXPECT_EQ(entryOf(decoded(R"({"labels": [{"key": 4, "label": "x", "red": 1.0, "green": 0.502,
                                 "blue": 0}]})"),
                      4),
              (LabelEntry{4, "x", "", kOrange}));
    EXPECT_EQ(entryOf(decoded(R"({"R": [0, 255], "G": [0, 128], "B": [0, 0], "I": [0, 9],
                                 "labels": ["", "nine"]})"),
                      9),
              (LabelEntry{9, "nine", "", kOrange}));
}

TEST(LabelTable, TakesOtherTextThanUtf8ForLatin1) {
    EXPECT_EQ(entryOf(decoded("1 c\xf4t\xe9\n2 x\n"), 1).name, "c\u00f4t\u00e9");
    EXPECT_EQ(entryOf(decoded("\xef\xbb\xbf"
                              "1 c\u00f4t\u00e9\n2 x\n"),
                      1)
                  .name,
              "c\u00f4t\u00e9");
}

TEST(LabelTable, TellsOfValuesListedTwice) {
    const LabelTable table = decoded("1 a\n1 b\n2 c\n2 c\n");
    EXPECT_EQ(entryOf(table, 1).name, "a");
    ASSERT_EQ(table.warnings.size(), 1U);
    EXPECT_NE(table.warnings[0].text.find("label 1 is listed twice"), std::string::npos);
}

TEST(LabelTable, NamesTheLineThatIsWrong) {
    EXPECT_NE(refusalOf("index\tname\n1\ta\nx\tb\n").find("x: line 3: the index is 'x'"),
              std::string::npos);
    EXPECT_NE(
        refusalOf("1 a 1 2 3 0\n1.5 b 1 2 3 0\n3 c 1 2 3 0\n").find("line 2: the index is '1.5'"),
        std::string::npos);
    EXPECT_NE(refusalOf("index\tname\nn/a\ta\n").find("line 2: the index is ''"),
              std::string::npos);
    EXPECT_NE(refusalOf("index\tname\n1e19\ta\n").find("64 bits"), std::string::npos);
    EXPECT_NE(refusalOf("index\tname\n").find("lists no label"), std::string::npos);
    EXPECT_NE(refusalOf("LabelValue,Name\n1,\"a\n").find("quote is not closed"), std::string::npos);
}

TEST(LabelTable, RefusesRowsWithOtherCellsThanTheHeader) {
    for (const auto& [text, line] :
         {std::pair{"index,name\n1,\"Cortex, left\"\n2,Cortex, right\n", "line 3: it has 3 fields"},
          {"index,name,color\n1,Alpha,#ff0000\n2,Cortex, right,#00ff00\n", "line 3"},
          {"index\tname\tabbreviation\tcolor\n1\tAlpha\t#ff0000\n", "line 2: it has 3 fields"},
          {"index\tname\n1\tAlpha\tfoo\n2\tBeta\n", "line 2"}}) {
        EXPECT_NE(refusalOf(text).find(line), std::string::npos) << text << refusalOf(text);
    }
    // cells that lack, or are empty, at the end
    EXPECT_EQ(entryOf(decoded("index\tname\tcolor\n1\tAlpha\t\t\t\n2\tBeta\n"), 2).name, "Beta");
}

TEST(LabelTable, TakesNumbersOfNamesForNoColour) {
    const LabelTable areas =
        decoded("1 Area 44 255 10 20\n2 Area 45 0 255 30\n3 Area 46 40 0 255\n");
    EXPECT_EQ(entryOf(areas, 1), (LabelEntry{1, "Area 44", "", LabelColor{255, 10, 20}}));
    EXPECT_EQ(entryOf(areas, 3), (LabelEntry{3, "Area 46", "", LabelColor{40, 0, 255}}));
    EXPECT_EQ(entryOf(decoded("1 a 255 128 0 100\n2 b 1 2 3 50\n"), 1),
              (LabelEntry{1, "a", "", kOrange}));
    EXPECT_EQ(entryOf(decoded("1 a 255 128 0 255\n2 a 1 2 3 255\n"), 1),
              (LabelEntry{1, "a", "", kOrange}));
    const LabelTable lobules = decoded("1 Crus 1\n2 Lobule 5\n3 Vermis 6\n");
    EXPECT_EQ(entryOf(lobules, 2).name, "Lobule 5");
    EXPECT_EQ(entryOf(decoded("1 Precentral_L 1\n2 Precentral_R 2\n"), 2).name, "Precentral_R");
}

TEST(LabelTable, TakesAMeasureForNoIndex) {
    const LabelTable measured = decoded("label\tname\tvalue\n1\tAlpha\t3\n3\tGamma\t1\n");
    EXPECT_EQ(entryOf(measured, 1).name, "Alpha");
    EXPECT_EQ(entryOf(measured, 3).name, "Gamma");
    for (const char* const text :
         {"id\tname\tindex\n1\tAlpha\t0\n2\tBeta\t1\n", "id,name,value\n1,Alpha,2\n2,Beta,1\n"}) {
        EXPECT_NE(refusalOf(text).find("may both be the labels"), std::string::npos) << text;
    }
    EXPECT_EQ(entryOf(decoded("index\tname\tid\n1\tAlpha\t2001\n2\tBeta\t2002\n"), 2).name, "Beta");
    EXPECT_EQ(entryOf(decoded("value,label\n3,Alpha\n1,Beta\n"), 3).name, "Alpha");
}

TEST(LabelTable, ScalesJsonsColoursTogether) {
    const LabelTable whole = decoded(
        R"([{"index": 1, "name": "a", "color": [1, 1, 1]},
            {"index": 2, "name": "b", "color": [255, 128, 0]}])");
    EXPECT_EQ(entryOf(whole, 1).color, (LabelColor{1, 1, 1}));
    EXPECT_EQ(entryOf(whole, 2).color, kOrange);
    EXPECT_EQ(entryOf(decoded(R"([{"index": 1, "name": "a", "color": [1, 0, 0]}])"), 1).color,
              kRed);
}

TEST(LabelTable, RefusesKeysThatJsonHasTwice) {
    for (const char* const text :
         {R"({"1": "a", "1": "b"})", R"({"1": {"name": "a", "n\u0061me": "b"}})"}) {
        EXPECT_NE(refusalOf(text).find("a key twice"), std::string::npos) << text;
    }
}

TEST(LabelTable, LeavesAColourOutThatMayBeCutOff) {
    for (const char* const text : {"index\tname\tcolor\n1\ta\t#ff0000\n2\tb\t#0000",
                                   "1 a #ff0000\n2 b #0000ff\n3 c #0000"}) {
        const LabelTable table = decoded(text);
        EXPECT_EQ(table.entries.back().color, std::nullopt) << text;
        ASSERT_EQ(table.warnings.size(), 1U) << text;
        EXPECT_EQ(table.warnings[0].code, "colors-not-read");
    }
    EXPECT_EQ(entryOf(decoded("index\tname\tcolor\n1\ta\t#f00\n2\tb\t#00f"), 2).color,
              (LabelColor{0, 0, 255}));
}

TEST(LabelTable, ReadsHexColoursBeforeNames) {
    const LabelTable table = decoded("1 #ff8000 Left Femur\n2 #00ff00 Beta\n");
    EXPECT_EQ(entryOf(table, 1), (LabelEntry{1, "Left Femur", "", kOrange}));
}

TEST(LabelTable, RefusesWhatIsNoTable) {
    for (const std::string& text :
         {std::string(), std::string("   \n"), std::string("hello\nworld\n"), std::string("{}"),
          std::string("{\"Manufacturer\": \"x\"}"), std::string("{\"a\""), std::string("[1, 2]"),
          std::string("<svg/>"), std::string("# only\n"), std::string("0 1000\n5 1000\n"),
          std::string("1 0.5 0.5 0.5\n2 0.1 0.2 0.3\n"), std::string("0 0 0 0 255\n"),
          std::string(1000, '\0')}) {
        EXPECT_THROW(decoded(text), NoLabelTable) << text;
    }
    EXPECT_THROW(decoded("<!DOCTYPE GIFTI [<!ENTITY a \"b\">]><GIFTI/>"), FileError);
    EXPECT_THROW(decoded("<GIFTI><LabelTable><Label Key=\"1\">a"), FileError);
}

TEST(LabelTable, NamesHoldNoControlCharacters) {
    const LabelTable table = decoded("{\"1\": \" a\\u0000\\n\\u001b[2Jb\\u0085 \"}");
    for (const char c : entryOf(table, 1).name) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
}

/// Whatever is done to a table's bytes, it is read or refused in one line.
TEST(LabelTable, SurvivesDamage) {
    const std::string good = "index\tname\tcolor\n1\tleft\t#ff0000\n2\tright\tn/a\n" +
                             std::string(3, '\n') +
                             "7 name 1 2 3 4\n<label index=\"1\">{\"1\": [2, \"x\"]}";
    std::mt19937 random(7);
    for (int round = 0; round < 3000; ++round) {
        std::string bytes = good;
        for (int n = 0; n < 4; ++n) {
            bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
        }
        bytes.resize(random() % (bytes.size() + 1));
        const std::string said = refusalOf(bytes);
        EXPECT_EQ(said.find('\n'), std::string::npos);
        EXPECT_LT(said.size(), 1000U);
    }
}

TEST(LabelColor, NeighboursAreToldApart) {
    const auto distance = [](const LabelColor& a, const LabelColor& b) {
        int sum = 0;
        for (std::size_t n = 0; n < 3; ++n) sum += std::abs(a[n] - b[n]);
        return sum;
    };
    std::set<LabelColor> all;
    for (std::int32_t value = 1; value < 256; ++value) {
        all.insert(labelColor(value));
        for (std::int32_t step = 1; step <= 3; ++step) {
            // 60 of 765: as far as two neighbouring hues of a dozen lie
            EXPECT_GE(distance(labelColor(value), labelColor(value + step)), 60) << value;
        }
    }
    EXPECT_GT(all.size(), 250U);
    EXPECT_EQ(hexText(kOrange), "#ff8000");
}

TEST(LabelColors, OfFewLabelsAreFarApart) {
    const auto distance = [](const LabelColor& a, const LabelColor& b) {
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    };
    for (const std::vector<std::int32_t>& labels :
         {std::vector<std::int32_t>{1, 2, 7},
          {3, 24, 58},
          {2, 41, 77, 251},
          {10, 11, 12, 13, 17, 18, 26, 49, 50, 51, 52, 53}}) {
        const std::vector<std::optional<LabelColor>> none(labels.size());
        const std::vector<LabelColor> colors = labelColors(labels, none);
        for (std::size_t n = 0; n < colors.size(); ++n) {
            for (std::size_t k = 0; k < n; ++k) {
                // of 442 from black to white
                EXPECT_GE(distance(colors[n], colors[k]), 60) << labels[n] << ' ' << labels[k];
            }
        }
        EXPECT_EQ(colors[0], labelColor(labels[0]));
    }
}

TEST(LabelColors, KeepAwayFromThoseOfTheTable) {
    const LabelColor green = labelColor(7);
    const std::vector<std::int32_t> labels{7, 9};
    const std::vector<LabelColor> colors =
        labelColors(labels, std::vector<std::optional<LabelColor>>{std::nullopt, green});
    EXPECT_EQ(colors[1], green);
    EXPECT_NE(colors[0], green);
    // of many each has its own, whatever the others are
    std::vector<std::int32_t> many(100);
    std::iota(many.begin(), many.end(), 1);
    EXPECT_EQ(labelColors(many, std::vector<std::optional<LabelColor>>(100))[6], green);
}

TEST(LabelTableKinds, AreThoseOfTheirPage) {
    const std::string header = "| kind | ending beside an image | what it looks like |\n";
    std::string table = header + "|---|---|---|\n";
    for (const LabelTableKind& kind : labelTableKinds()) {
        table += "| " + std::string(kind.name) + " | " + testing::quotedList(kind.endings) + " | " +
                 std::string(kind.looks) + " |\n";
    }
    testing::expectOnPage(LABELS_PAGE, header, "| in a NRRD", table);
}

/// Debian's mricron-data and python3-mne, where they are installed.
class RealTables : public ::testing::Test {
protected:
    static LabelTable read(const std::string& file) {
        if (!std::filesystem::exists(file)) return {};
        return readLabelTable(file);
    }
    static constexpr const char* kFolder = "/usr/share/mricron/templates/";
};

TEST_F(RealTables, MricronsAtlases) {
    const LabelTable aal = read(std::string(kFolder) + "aal.nii.txt");
    if (aal.entries.empty()) GTEST_SKIP() << "mricron-data is not installed";
    EXPECT_EQ(aal.entries.size(), 116U);
    EXPECT_EQ(entryOf(aal, 1).name, "Precentral_L");
    EXPECT_EQ(entryOf(aal, 116).name, "Vermis_10");
    const LabelTable aicha = read(std::string(kFolder) + "AICHAmc.nii.txt");
    EXPECT_EQ(aicha.entries.size(), 192U);
    EXPECT_EQ(entryOf(aicha, 192).name, "N_Thalamus-9");
    const LabelTable jhu = read(std::string(kFolder) + "JHU-WhiteMatter-labels-1mm.nii.txt");
    EXPECT_EQ(entryOf(jhu, 2).name, "Pontine_crossing_tract_(a_part_of_MCP)");
    const LabelTable colors = read(std::string(kFolder) + "aal.nii.lut");
    EXPECT_EQ(entryOf(colors, 1).color, (LabelColor{0xcc, 0xcc, 0xcc}));
}

TEST_F(RealTables, FreeSurfersOwn) {
    const LabelTable table = read("/usr/lib/python3/dist-packages/mne/data/FreeSurferColorLUT.txt");
    if (table.entries.empty()) GTEST_SKIP() << "python3-mne is not installed";
    EXPECT_GT(table.entries.size(), 1000U);
    EXPECT_EQ(entryOf(table, 17),
              (LabelEntry{17, "Left-Hippocampus", "", LabelColor{220, 216, 20}}));
    EXPECT_EQ(table.format, "FreeSurfer");
}

}  // namespace
}  // namespace adaptiso
