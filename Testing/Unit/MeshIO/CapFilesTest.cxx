// Electrodes' files of EEGLAB, BESA, Polhemus, MNE and BrainVision: places are those that
// MNE-Python 1.3 reads from the same text, but .ced, .pos and .bvct, known on paper.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <map>
#include <string>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso {
namespace {

using Places = std::map<std::string, Vec3>;

void expectPlaces(const char* extension, const std::string& text, const Places& places) {
    SCOPED_TRACE(extension);
    const PointFile file = decodePoints(text, extension, "a");
    Places found;
    for (const NamedPoint& p : file.points) {
        const std::string name = p.kind == PointKind::Nasion     ? "<nasion>"
                                 : p.kind == PointKind::LeftEar  ? "<left>"
                                 : p.kind == PointKind::RightEar ? "<right>"
                                 : p.kind == PointKind::Other    ? "<shape>"
                                                                 : p.name;
        EXPECT_TRUE(found.emplace(name, p.point).second) << name;
    }
    EXPECT_EQ(found.size(), places.size());
    for (const auto& [name, place] : places) {
        ASSERT_TRUE(found.contains(name)) << name;
        EXPECT_LE(norm(found[name] - place), 2e-5) << name;  // five digits of MNE's are given
    }
}

TEST(CapFiles, OfAnglesAreDirections) {
    expectPlaces(".loc", "1\t-18\t.511\tFp1.\n2\t90\t.25\tC4..\n3\t180\t.5\tOz\n",
                 {{"Fp1", {-0.30883, 0.95049, -0.03455}},
                  {"C4", {0.70711, 0, 0.70711}},
                  {"Oz", {0, -1, 0}}});
    const Places besa{{"Fz", {0, 0.71934, 0.69466}},
                      {"C3", {-0.71934, 0, 0.69466}},
                      {"Oz", {0, -0.99939, -0.0349}}};
    expectPlaces(".elp", "EEG Fz 46 90 100\nEEG C3 -46 0 100\nEEG Oz -92 90 100\n", besa);
    expectPlaces(".elp", "Fz 46 90\nC3 -46 0\nOz -92 90\n", besa);
    expectPlaces(".elp", "EEG Fz 46 90\nPOS C3 -46 0\nREF Oz -92 90\n", besa);
    const Places easycap{{"Fp1", {-0.30883, 0.95048, -0.0349}}, {"F3", {-0.54501, 0.67303, 0.5}}};
    expectPlaces(".txt", "Site\t Theta\tPhi\nFp1\t -92\t-72\nF3\t -60\t-51\n", easycap);
    expectPlaces(".txt", "Name   Theta  Phi\nFp1    -92  -72\nF3    -60  -51\n", easycap);
    expectPlaces(
        ".bvef",
        "<?xml "
        "version=\"1.0\"?><Electrodes><Electrode><Name>Fp1</Name><Theta>-90</Theta><Phi>-72</Phi>"
        "<Radius>1</Radius><Number>1</Number></Electrode><Electrode><Name>GND</Name><Theta>0</"
        "Theta>"
        "<Phi>0</Phi><Radius>0</Radius></Electrode></Electrodes>",
        {{"Fp1", {-0.30902, 0.95106, 0}}});
    expectPlaces(".ced", "Number\tlabels\ttheta\tradius\n1\tC4\t90\t.25\n",
                 {{"C4", {0.70711, 0, 0.70711}}});
}

TEST(CapFiles, OfPlacesKeepTheirNumbers) {
    expectPlaces(".csd",
                 "// MatLab   Sphere coordinates\n// Label Theta\n E1 37.7 -14 1 .7677 .5934 "
                 "-.2419 -0.0001\n",
                 {{"E1", {0.7677, 0.5934, -0.2419}}});
    expectPlaces(".xyz", "1\t1.5\t-2\t9.25\tCz\n2\t1\t2\t3\tOz\n",
                 {{"Cz", {1.5, -2, 9.25}}, {"Oz", {1, 2, 3}}});
    expectPlaces(".ced",
                 "Number\tlabels\ttheta\tradius\tX\tY\tZ\ttype\n1\tCz\t0\t0\t0\t1\t85\tEEG\n",
                 {{"Cz", {0, 1, 85}}});
    // as Localite and MNE-Python have them
    expectPlaces(".csv", "#,id,x,y,z\n1,Nasion,-2,6.25,34\n2,Cz,1,2,3\n",
                 {{"<nasion>", {-2, 6.25, 34}}, {"Cz", {1, 2, 3}}});
    expectPlaces(".csv", "label,x,y,z\nCz,1,2,3\n", {{"Cz", {1, 2, 3}}});
    expectPlaces(".txt", "name\tx\ty\tz\nCz\t1\t2\t3\n", {{"Cz", {1, 2, 3}}});
    expectPlaces(".txt", "Cz 1 2 3\n2 Oz 4 5 6\n", {{"Cz", {1, 2, 3}}, {"Oz", {4, 5, 6}}});
    expectPlaces(".txt", "% Polhemus FastSCAN\n% x y z\n1 2 3\n", {{"<shape>", {1, 2, 3}}});
    expectPlaces(".hpts",
                 "# a\ncardinal 2 0 100 0\ncardinal 1 -80 0 0\ncardinal 3 80 0 0\nhpi 1 1 2 3\neeg "
                 "FP1 -27 84 30\n"
                 "extra 1 0 0 99\n",
                 {{"<nasion>", {0, 100, 0}},
                  {"<left>", {-80, 0, 0}},
                  {"<right>", {80, 0, 0}},
                  {"FP1", {-27, 84, 30}},
                  {"<shape>", {0, 0, 99}}});
    expectPlaces(".pos", "3\n1 0 0 9.9\n2 Cz 0 1 9.2\nnasion 9 0 0\nleft 0 7 0\nright 0 -7 0\n",
                 {{"<shape>", {0, 0, 9.9}},
                  {"Cz", {0, 1, 9.2}},
                  {"<nasion>", {9, 0, 0}},
                  {"<left>", {0, 7, 0}},
                  {"<right>", {0, -7, 0}}});
    const std::string fiducials =
        "3\t2\n//Shape file\n2\n%N\tName    \n0\t2\n//Position of fiducials X+, Y+, Y- on the "
        "subject\n"
        "%F\t0.11\t-0.001\t0\n%F\t0\t0.08\t0\n%F\t0\t-0.08\t0\n//Sensor type\n";
    const Vec3 nasion{0.11, -0.001, 0}, left{0, 0.08, 0}, right{0, -0.08, 0};
    expectPlaces(
        ".elp", fiducials + "%S\t4000\n%N\t1-A\n0.1\t-0.03\t0.02\n",
        {{"<nasion>", nasion}, {"<left>", left}, {"<right>", right}, {"1-A", {0.1, -0.03, 0.02}}});
    expectPlaces(
        ".hsp",
        fiducials +
            "//No of rows, no of columns; position of digitized points\n1\t3\n0.1\t0\t0.02\n",
        {{"<nasion>", nasion}, {"<left>", left}, {"<right>", right}, {"<shape>", {0.1, 0, 0.02}}});
    expectPlaces(".bvct",
                 "<?xml version=\"1.0\" "
                 "encoding=\"UTF-8\"?><CapTrak><CapTrakElectrodeList><CapTrakElectrode>"
                 "<Name>LPA</Name><X>-80</X><Y>1</Y><Z>2</Z></"
                 "CapTrakElectrode><CapTrakElectrode><Name>Cz</Name>"
                 "<X>0</X><Y>0</Y><Z>95.5</Z></CapTrakElectrode></CapTrakElectrodeList></CapTrak>",
                 {{"<left>", {-80, 1, 2}}, {"Cz", {0, 0, 95.5}}});
}

std::string capRefusal(const char* extension, const std::string& text) {
    try {
        decodePoints(text, extension, "a");
    } catch (const FileError& error) {
        return error.what();
    }
    ADD_FAILURE() << extension << " was read: " << text;
    return {};
}

TEST(CapFiles, AreRefusedByLine) {
    EXPECT_EQ(capRefusal(".loc", "1 90 .25\n"),
              "a: line 1: a row has 3 words, must have 4; give each row the words of this format");
    EXPECT_NE(
        capRefusal(".loc", "1 left .25 C3\n").find("line 1: the coordinate t of 'C3' is 'left'"),
        std::string::npos);
    EXPECT_NE(capRefusal(".elp", "Fz 46\n").find("a row has 2 words"), std::string::npos);
    EXPECT_NE(capRefusal(".hpts", "coil 1 2 3 4\n").find("of the kind 'coil'"), std::string::npos);
    EXPECT_NE(capRefusal(".hpts", "cardinal 4 2 3 4\n").find("the name ''"), std::string::npos);
    EXPECT_NE(capRefusal(".bvef", "<Electrodes><Electrode><Name>Cz</Name></Electrode></Electrodes>")
                  .find("none of its 1 points has a place"),
              std::string::npos);
    EXPECT_NE(capRefusal(".bvef", "Cz 1 2 3").find("XML"), std::string::npos);
    EXPECT_NE(capRefusal(".pos", "2\nCz 1 2\n").find("a point has 2 coordinates"),
              std::string::npos);
    EXPECT_NE(
        capRefusal(".abc", "Cz 1 2 3\n").find("give .tsv, .csv, .ced, .elc, .sfp, .fif, .loc"),
        std::string::npos);
}

/// The bytes of a tag's struct, big-endian.
template <class T>
void append(std::string& bytes, T value) {
    auto word = std::bit_cast<std::uint32_t>(value);
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift);
}

TEST(CapFiles, OfRawFiffHaveTheChannelsNames) {
    const auto fif = testing::temporaryFile("names.fif");
    const NamedPoint points[] = {{"", PointKind::Electrode, {0, 0, 90}},
                                 {"", PointKind::Electrode, {0, 70, 50}},
                                 {"", PointKind::Electrode, {0, 70, 50}}};
    writeFiffPoints(points, fif);
    std::string bytes = testing::bytesOf(fif);
    EXPECT_EQ(decodePoints(bytes, ".fif", "a").points[1].name, "EEG002");
    // channels in front of the digitizer's block: tag, then its struct of 96 bytes
    std::string channel;
    for (const char* const name : {"T3", "T7"}) {  // at one place, as in MNE's standard_1020
        for (const std::int32_t word : {203, 30, 96, 0, 1, 1, 2}) append(channel, word);
        for (const float value : {1.0F, 1.0F}) append(channel, value);
        append(channel, std::int32_t{1});
        for (const float metres : {0.0F, 0.07F, 0.05F}) append(channel, metres);
        channel.append(9 * 4, '\0');
        append(channel, std::int32_t{107});
        append(channel, std::int32_t{0});
        channel += std::string(name) + std::string(14, '\0');
    }
    std::string block;
    for (const std::int32_t word : {104, 3, 4, 0, 107}) append(block, word);
    const std::size_t at = bytes.find(block);
    ASSERT_NE(at, bytes.npos);
    bytes.insert(at, channel);
    const PointFile file = decodePoints(bytes, ".fif", "a");
    EXPECT_EQ(file.points[0].name, "EEG001");  // no channel lies there
    EXPECT_EQ(file.points[1].name, "T3");
    EXPECT_EQ(file.points[2].name, "T7");
}

}  // namespace
}  // namespace adaptiso
