// Electrodes and landmarks: the four formats give back what went in, and damage is told in one
// line.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso {
namespace {

using testing::bytesOf;
using testing::temporaryFile;

const std::vector<NamedPoint> kPoints{{"Cz", PointKind::Electrode, {1.5, -2.25, 92}},
                                      {"Fpz", PointKind::Electrode, {0, 90.125, 10}},
                                      {"Nasion", PointKind::Nasion, {0, 95, -10}},
                                      {"LPA", PointKind::LeftEar, {-75, 0, -20}},
                                      {"RPA", PointKind::RightEar, {75, 0, -20}}};

void expectSame(const PointFile& file, const std::vector<NamedPoint>& points, double mm) {
    ASSERT_EQ(file.points.size(), points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        EXPECT_EQ(file.points[n].kind, points[n].kind) << points[n].name;
        EXPECT_LE(norm(file.points[n].point - points[n].point), mm) << points[n].name;
    }
}

TEST(PointFiles, OfBidsComeBackWithTheirFrame) {
    const auto tsv = temporaryFile("sub-1_electrodes.tsv");
    writeBidsElectrodes(kPoints, tsv, tsv.parent_path() / "sub-1_coordsystem.json",
                        CoordinateFrame::Ras);
    const PointFile file = readPoints(tsv);
    expectSame(file, {kPoints[0], kPoints[1], kPoints[3], kPoints[2], kPoints[4]}, 1e-6);
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
    EXPECT_TRUE(file.saysUnit);
    EXPECT_EQ(file.points[0].name, "Cz");
}

TEST(PointFiles, OfOtherFormatsComeBack) {
    const auto elc = temporaryFile("a.elc"), sfp = temporaryFile("a.sfp"),
               fif = temporaryFile("a.fif");
    writeElc(kPoints, elc);
    expectSame(readPoints(elc), kPoints, 1e-6);
    EXPECT_TRUE(readPoints(elc).saysUnit);
    writeSfp(kPoints, sfp);
    expectSame(readPoints(sfp), kPoints, 1e-6);
    EXPECT_FALSE(readPoints(sfp).saysUnit);
    writeFiffPoints(kPoints, fif);
    expectSame(readPoints(fif), kPoints, 1e-4);  // float metres
    EXPECT_EQ(readPoints(fif).frame, CoordinateFrame::TkRas);
    EXPECT_EQ(readPoints(fif).points[1].name, kPoints[1].name);
    EXPECT_NE(bytesOf(elc).find("\nNz\n"), std::string::npos);  // MNE's name of the nasion
}

TEST(PointFiles, OfOthersAreReadToo) {
    const PointFile bids = decodePoints(
        "name\tx\ty\tz\ttype\nCz\t0\t0\t9.2\tcup\nEOG\tn/a\tn/a\tn/a\tcup\n", ".tsv", "a.tsv",
        R"({"EEGCoordinateSystem": "CTF", "EEGCoordinateUnits": "cm",
            "AnatomicalLandmarkCoordinates": {"NAS": [10, 0, 0], "LPA": [0, 7, 0], "RPA": [0, -7, 0]}})");
    ASSERT_EQ(bids.points.size(), 4u);  // what has no place is left out
    EXPECT_EQ(bids.points[0].point, (Vec3{0, 0, 92}));
    EXPECT_FALSE(bids.frame);
    EXPECT_EQ(bids.frameName, "CTF");
    const PointFile elc = decodePoints(
        "# ASA\nUnitPosition\tmm\nNumberPositions= 2\nPositions\nLPA : -86 -20 -48\nCz : 0 0 99\n"
        "Labels\n",
        ".elc", "a.elc");
    EXPECT_EQ(elc.points[0].kind, PointKind::LeftEar);
    EXPECT_EQ(elc.points[1].point.z, 99);
    // as FieldTrip reads ANT's newer files (read_asa_elc.m, ft_read_headshape.m)
    const PointFile newer = decodePoints(
        "UnitPosition\tmm\nNumberPositions=\t2\nPositions\nNz\t:\t0 100 0\nOz 1 :\t0 -99 1\n"
        "Positions2D\nNz : 0 1\nOz 1 : 0 -1\nNumberPolygons=\t1\nTypePolygons=\t3\nPolygons\n"
        "0 1 1\nLabels\nNz\tOz1\nNumberHeadShapePoints=\t1\nUnitHeadShapePoints\tcm\n"
        "HeadShapePoints\n0 0 9.8\n",
        ".elc", "newer.elc");
    ASSERT_EQ(newer.points.size(), 3u);
    EXPECT_EQ(newer.points[0].kind, PointKind::Nasion);
    EXPECT_EQ(newer.points[1].name, "Oz 1");
    EXPECT_EQ(newer.points[2].kind, PointKind::Other);
    EXPECT_DOUBLE_EQ(newer.points[2].point.z, 98);
    const PointFile sfp =
        decodePoints("FidNz\t-10.89\t0.04\t-4.30\nE1 -1.52 -2.31 6.98\n", ".sfp", "a");
    EXPECT_EQ(sfp.points[0].kind, PointKind::Nasion);
    EXPECT_EQ(sfp.points[1].name, "E1");
}

/// The same three points in each format of text; `cz` is what stands for the place of Cz.
std::string pointsText(const std::string& extension, const std::string& cz,
                       const std::string& last = "Oz") {
    if (extension == ".tsv") {
        std::string cells = cz;
        std::ranges::replace(cells, ' ', '\t');
        return "name\tx\ty\tz\ttype\nFz\t70\t0\t60\tcup\nCz\t" + cells + "\tcup\n" + last +
               "\t-95\t0\t0\tcup\n";
    }
    if (extension == ".sfp") return "Fz 70 0 60\nCz " + cz + "\n" + last + " -95 0 0\n";
    return "UnitPosition mm\nPositions\n70 0 60\n" + cz + "\n-95 0 0\nLabels\nFz\nCz\n" + last +
           "\n";
}

TEST(PointFiles, LeaveOutWhatHasNoPlace) {
    for (const char* const extension : {".tsv", ".sfp", ".elc"}) {
        for (const char* const cz : {"n/a n/a n/a", "NaN NaN NaN", "nan 0 0", "-1.#IND 0 0"}) {
            const PointFile file = decodePoints(pointsText(extension, cz), extension, "a");
            ASSERT_EQ(file.points.size(), 2u) << extension << ' ' << cz;
            EXPECT_EQ(file.points[1].name, "Oz");
            EXPECT_EQ(file.points[1].point, (Vec3{-95, 0, 0}));
            EXPECT_EQ(file.placeless, std::vector<std::string>{"Cz"});
        }
        const PointFile whole =
            decodePoints(pointsText(extension, "1.0D+01 +2 9.2e1"), extension, "a");
        EXPECT_EQ(whole.points[1].point, (Vec3{10, 2, 92})) << extension;
        EXPECT_TRUE(whole.placeless.empty());
    }
    EXPECT_EQ(decodePoints("name\tx\ty\tz\nCz\t\t\t\nOz\t1\t2\t3\n\t\t\t\n", ".tsv", "a").placeless,
              std::vector<std::string>{"Cz"});
    const PointFile bids = decodePoints(pointsText(".tsv", "0 0 92"), ".tsv", "a", R"({
        "AnatomicalLandmarkCoordinates": {"NAS": "n/a", "LPA": [1, "n/a", 3], "RPA": [1, 2, 3]}})");
    EXPECT_EQ(bids.placeless, (std::vector<std::string>{"LPA", "NAS"}));
    EXPECT_EQ(bids.points.back().kind, PointKind::RightEar);
}

TEST(PointFiles, HoldEachNameOnce) {
    for (const char* const extension : {".tsv", ".sfp", ".elc"}) {
        try {
            decodePoints(pointsText(extension, "0 0 92", "Fz"), extension, "a");
            ADD_FAILURE() << extension;
        } catch (const FileError& error) {
            EXPECT_STREQ(error.what(),
                         "a: two of its points have the name 'Fz'; rename or remove one of them");
        }
    }
    // a landmark may be among the electrodes and in the coordinate system
    EXPECT_NO_THROW(decodePoints("name\tx\ty\tz\nNAS\t1\t2\t3\n", ".tsv", "a",
                                 R"({"AnatomicalLandmarkCoordinates": {"NAS": [1, 2, 3]}})"));
}

TEST(PointFiles, OfSpreadsheetsAreRead) {
    const std::vector<std::string> texts{"Name\tX\tY\tZ\t\nCz\t1,5\t-2\t9,25\t\n",
                                         "name;x;y;z\nCz;1,5;-2;9,25\n",
                                         "name,x,y,z\n\"Cz\",1.5,-2,9.25\n",
                                         "\"name\"\t\"x\"\t\"y\"\t\"z\"\n\"Cz\"\t1.5\t-2\t9.25\n",
                                         "type\tz\ty\tx\tname\ncup\t9.25\t-2\t1.5\tCz\n",
                                         "name\tx\ty\tz\ttype\nCz\t1.5\t-2\t9.25\n"};
    for (const std::string& text : texts) {
        const PointFile file = decodePoints(text, ".tsv", "a");
        ASSERT_EQ(file.points.size(), 1u) << text;
        EXPECT_EQ(file.points[0].name, "Cz") << text;
        EXPECT_EQ(file.points[0].point, (Vec3{1.5, -2, 9.25})) << text;
    }
}

TEST(PointFiles, AreNoFormulasWhenWritten) {
    const std::vector<NamedPoint> points{{"=1+1", PointKind::Electrode, {1, 2, 3}}};
    const auto tsv = temporaryFile("f_electrodes.tsv");
    writeBidsElectrodes(points, tsv, tsv.parent_path() / "f_coordsystem.json",
                        CoordinateFrame::Ras);
    EXPECT_NE(bytesOf(tsv).find("\n'=1+1\t"), std::string::npos);
    EXPECT_EQ(readPoints(tsv).points[0].name, "=1+1");
}

std::string refused(const std::string& bytes, const char* extension,
                    const std::optional<std::string>& json = std::nullopt) {
    try {
        decodePoints(bytes, extension, "file", json);
    } catch (const FileError& error) {
        const std::string what = error.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        EXPECT_TRUE(what.starts_with("file: ")) << what;
        return what;
    }
    ADD_FAILURE() << "was read: " << bytes;
    return std::string();
}

TEST(PointFiles, HoldAsManyPositionsAsTheyCount) {
    const auto elc = [](const std::string& count, const std::string& shape = "2") {
        return "NumberPositions" + count + "\nPositions\nCz : 0 0 9\nOz : 0 -9 0\n" +
               "NumberHeadShapePoints= " + shape + "\nHeadShapePoints\n1 2 3\n4 5 6\n";
    };
    for (const char* const count : {"= 2", "=2", "=\t2", ""}) {
        EXPECT_EQ(decodePoints(elc(count), ".elc", "a").points.size(), 4u) << count;
    }
    EXPECT_EQ(refused(elc("= 4"), ".elc"),
              "file: it counts 4 positions and holds 2; get the file again, or correct the count");
    EXPECT_NE(refused(elc("= 1"), ".elc").find("1 positions and holds 2"), std::string::npos);
    EXPECT_NE(refused(elc("= 2", "3"), ".elc").find("3 head shape points and holds 2"),
              std::string::npos);
    EXPECT_NE(refused(elc("= 2x"), ".elc").find("NumberPositions"), std::string::npos);
    EXPECT_EQ(refused(elc("\001w= 2x"), ".elc").find('\001'), std::string::npos);
}

TEST(PointFiles, AreFiniteInMillimetres) {
    EXPECT_NE(refused("UnitPosition m\nPositions\nCz : 0 0 9e153\n", ".elc").find("not finite"),
              std::string::npos);
}

TEST(PointFiles, HaveThreeCoordinatesEach) {
    EXPECT_EQ(refused("Cz 0 0 85\nFp 1 25 78 9\n", ".sfp"),
              "file: line 2: behind the three coordinates of 'Fp' stands '9'; give x, y and z "
              "alone, and names without blanks");
    EXPECT_NE(refused("Cz 90 45 1 2 3\n", ".sfp").find("stands '2'"), std::string::npos);
    EXPECT_NE(refused("Cz\t1\t2\t3\t4\n", ".sfp").find("stands '4'"), std::string::npos);
    EXPECT_NE(refused("Positions\n0 50 70 99\nLabels\nCz\n", ".elc").find("stands '99'"),
              std::string::npos);
    const PointFile file =
        decodePoints("Ref 1\t0\t0\t85\nCz 1\t2\t3\nOz\t4 5 6\nE1 \t 7 \t 8 \t 9\nPz 1 1 1 # near\n",
                     ".sfp", "a");
    ASSERT_EQ(file.points.size(), 5u);
    EXPECT_EQ(file.points[0].name, "Ref 1");
    EXPECT_EQ(file.points[0].point, (Vec3{0, 0, 85}));
    EXPECT_EQ(file.points[1].name, "Cz");
    EXPECT_EQ(file.points[1].point, (Vec3{1, 2, 3}));
    EXPECT_EQ(file.points[2].point, (Vec3{4, 5, 6}));
    EXPECT_EQ(file.points[3].name, "E1");
    EXPECT_EQ(file.points[3].point, (Vec3{7, 8, 9}));
}

TEST(PointFiles, NameColumnsOnce) {
    EXPECT_EQ(refused("name\tx\tX\ty\tz\nCz\t1\t2\t3\t4\n", ".tsv"),
              "file: its first line names the column 'x' twice; rename or remove one of them");
    EXPECT_NO_THROW(decodePoints("name\tx\ty\tz\tnote\tnote\nCz\t1\t2\t3\ta\tb\n", ".tsv", "a"));
}

TEST(PointFiles, HaveTheSameNamesAndLabels) {
    const std::string positions = "Positions\nCz : 0 0 9\nF z : 5 0 8\nLabels\n";
    EXPECT_EQ(decodePoints(positions + "Cz Fz\n", ".elc", "a").points[1].name, "F z");
    EXPECT_EQ(
        refused(positions + "Fz Cz\n", ".elc"),
        "file: the position 1 is of 'Cz', its label is 'Fz'; give names and labels in one order");
}

TEST(PointFiles, OfLatin1HaveNamesOfUtf8) {
    for (const char* const extension : {".tsv", ".sfp", ".elc"}) {
        const PointFile file =
            decodePoints(pointsText(extension, "0 0 92", "\xC4rm"), extension, "a");
        EXPECT_EQ(file.points[2].name, "\xC3\x84rm") << extension;
        const PointFile controls = decodePoints(pointsText(extension, "0 0 92",
                                                           "a\x9b"
                                                           "b"),
                                                extension, "a");
        EXPECT_EQ(controls.points[2].name, "a b") << extension;
    }
}

TEST(PointFiles, NamesOfFiffMayBeLatin1) {
    const auto fif = temporaryFile("a.fif");
    std::vector<NamedPoint> points(kPoints.begin(), kPoints.end());
    for (NamedPoint& point : points) {
        if (point.kind == PointKind::Electrode) point.name = "C\xE9\xDF";  // as Latin-1 has them
    }
    std::erase_if(points, [seen = false](const NamedPoint& point) mutable {
        return point.kind == PointKind::Electrode && std::exchange(seen, true);
    });
    writeFiffPoints(points, fif);
    const PointFile file = readPoints(fif);
    const auto electrode = std::ranges::find(file.points, PointKind::Electrode, &NamedPoint::kind);
    ASSERT_NE(electrode, file.points.end());
    EXPECT_EQ(electrode->name, "C\xC3\xA9\xC3\x9F");
}

TEST(PointFiles, OfFiffAreOneFileAlone) {
    const auto fif = temporaryFile("a.fif");
    writeFiffPoints(kPoints, fif);
    const std::string bytes = bytesOf(fif);
    EXPECT_TRUE(decodePoints(bytes, ".fif", "a").warnings.empty());
    EXPECT_NE(refused(bytes + bytes, ".fif").find("are two files joined?"), std::string::npos);
    const PointFile padded = decodePoints(bytes + std::string(64, '\0'), ".fif", "a");
    EXPECT_EQ(padded.points.size(), kPoints.size());
    ASSERT_EQ(padded.warnings.size(), 1u);
    EXPECT_EQ(padded.warnings[0].code, "trailing-bytes");
}

TEST(PointFiles, RefuseDamageInOneLine) {
    const std::string tsv = "name\tx\ty\tz\nCz\t0\t0\t9\n";
    EXPECT_NE(refused("Cz\t0\t0\t9\n", ".tsv").find("no column 'name'"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t0\t0\n", ".tsv").find("3 cells"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t0\t0\tinf\n", ".tsv").find("finite"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t0\t0\tleft\n", ".tsv")
                  .find("line 2: the coordinate z of 'Cz' is 'left'; it must be a number, or n/a"),
              std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t1.234,5\t0\t1\n", ".tsv").find("with a comma"),
              std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t1,5\t0\t1\nPz\t1.5\t0\t1\n", ".tsv")
                  .find("decimal commas and decimal points"),
              std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\tn/a\t0\tNaN\n", ".tsv").find("none of its 1 points"),
              std::string::npos);
    EXPECT_NE(refused("Cz 12,5 0 1\n", ".sfp").find("with a comma"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\n", ".tsv").find("no point"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\n\t0\t0\t9\n", ".tsv").find("the name ''; give each a name"),
              std::string::npos);
    EXPECT_NE(refused(tsv, ".tsv", "[1, 2]").find("no JSON object"), std::string::npos);
    EXPECT_NE(refused(tsv, ".tsv", R"({"EEGCoordinateUnits": "inch"})").find("mm, cm or m"),
              std::string::npos);
    EXPECT_NE(refused(tsv, ".tsv", R"({"AnatomicalLandmarkCoordinates": {"NAS": [1, 2]}})")
                  .find("three numbers"),
              std::string::npos);
    EXPECT_NE(refused("Positions\n1 2 3\nLabels\nA B\n", ".elc").find("2 labels"),
              std::string::npos);
    EXPECT_NE(refused("Positions\nA : 1 2 3\nLabels\nA B\n", ".elc").find("2 labels"),
              std::string::npos);
    EXPECT_NE(refused("Cz 1 2\n", ".sfp").find("line 1: a point has 2 coordinates"),
              std::string::npos);
    EXPECT_NE(refused("name 1 2 3, of no FIFF file at all\n", ".fif").find("FIFF"),
              std::string::npos);
    EXPECT_NE(refused("Cz 1 2 3\n", ".abc").find("'.abc'"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
