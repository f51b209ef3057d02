// Electrodes and landmarks: the four formats give back what went in, and damage is told in one
// line.
#include <gtest/gtest.h>

#include <string>
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

TEST(PointFiles, RefuseDamageInOneLine) {
    const auto refused = [](const std::string& bytes, const char* extension,
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
    };
    const std::string tsv = "name\tx\ty\tz\nCz\t0\t0\t9\n";
    EXPECT_NE(refused("Cz\t0\t0\t9\n", ".tsv").find("no column 'name'"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t0\t0\n", ".tsv").find("3 cells"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\nCz\t0\t0\tnan\n", ".tsv").find("finite"), std::string::npos);
    EXPECT_NE(refused("name\tx\ty\tz\n", ".tsv").find("no point"), std::string::npos);
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
    EXPECT_NE(refused("Cz 1 2\n", ".sfp").find("a coordinate"), std::string::npos);
    EXPECT_NE(refused("name 1 2 3, of no FIFF file at all\n", ".fif").find("FIFF"),
              std::string::npos);
    EXPECT_NE(refused("Cz 1 2 3\n", ".xyz").find("'.xyz'"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
