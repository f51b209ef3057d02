#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ExportMatlab.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using testing::icosphere;

class ExportMatlab : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(::testing::TempDir()) /
                  (std::string("ExportMatlab-") +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string bytesOf(const char* name) const {
        std::ifstream stream(folder_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    std::vector<HeadLayer> layers_{{HeadSurface::InnerSkull, 0.33, icosphere(1, {1, 2, 3}, 80)},
                                   {HeadSurface::OuterSkull, 0.0041, icosphere(1, {1, 2, 3}, 86)},
                                   {HeadSurface::OuterSkin, 0.44, icosphere(2, {1, 2, 3}, 92)}};
    fs::path folder_;
};

TEST_F(ExportMatlab, FieldTripsModelComesBackInsideOut) {
    writeFieldTripModel(layers_, folder_ / "m.mat", CoordinateFrame::Ras);
    const std::vector<HeadLayer> read = readFieldTripModel(folder_ / "m.mat");
    ASSERT_EQ(read.size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
        EXPECT_EQ(read[n].surface, layers_[n].surface);
        EXPECT_EQ(read[n].conductivity, layers_[n].conductivity);
        EXPECT_EQ(read[n].mesh.points, layers_[n].mesh.points);  // doubles, to the bit
        EXPECT_EQ(read[n].mesh.triangles, layers_[n].mesh.triangles);
    }
}

TEST_F(ExportMatlab, BrainstormsSurfaceComesBackTurnedRound) {
    writeBrainstormSurface(layers_[0].mesh, folder_ / "s.mat", "inner skull");
    const TriangleMesh read = readBrainstormSurface(folder_ / "s.mat");
    EXPECT_EQ(read.points, layers_[0].mesh.points);
    EXPECT_EQ(read.triangles, layers_[0].mesh.triangles);
}

TEST_F(ExportMatlab, LeadFieldComesBackColumnByColumn) {
    const LeadField field{
        "MNE-Python 1.3.0",
        {1e2, -2.5, 3, 4, 5, 1.0 / 3},
        {{"Nz", PointKind::Electrode, {1, 2, 3}}, {"Cz", PointKind::Electrode, {4, 5, 6}}},
        std::vector<Vec3>(3),
        std::vector<Vec3>(3, {0, 0, 1})};
    writeLeadField(field, folder_ / "l.mat", CoordinateFrame::Lps);
    EXPECT_EQ(readLeadFieldGain(folder_ / "l.mat"), field.gain);  // doubles, to the bit
    EXPECT_THROW(readLeadFieldGain(folder_ / "missing.mat"), FileError);
}

TEST_F(ExportMatlab, TheSameModelGivesTheSameBytes) {
    for (const char* name : {"a.mat", "b.mat"}) {
        writeFieldTripModel(layers_, folder_ / name, CoordinateFrame::Ras);
    }
    EXPECT_EQ(bytesOf("a.mat"), bytesOf("b.mat"));
    EXPECT_TRUE(bytesOf("a.mat").starts_with("MATLAB 5.0 MAT-file"));
}

TEST_F(ExportMatlab, FramesAreNamedAsFieldTripDoes) {
    EXPECT_EQ(fieldTripCoordsys(CoordinateFrame::Ras), "scanras");
    EXPECT_EQ(fieldTripCoordsys(CoordinateFrame::Lps), "scanlps");
    EXPECT_EQ(fieldTripCoordsys(CoordinateFrame::TkRas), "ras");
    EXPECT_THROW(fieldTripCoordsys(CoordinateFrame::Voxel), InvalidInput);
}

TEST_F(ExportMatlab, WhatCantBeWrittenOrReadIsToldWithTheFile) {
    EXPECT_THROW(writeFieldTripModel({}, folder_ / "m.mat", CoordinateFrame::Ras), InvalidInput);
    EXPECT_THROW(writeFieldTripModel(layers_, folder_ / "none/m.mat", CoordinateFrame::Ras),
                 FileError);
    std::ofstream(folder_ / "text.mat") << "no MATLAB file";
    for (const char* name : {"text.mat", "missing.mat"}) {
        try {
            readFieldTripModel(folder_ / name);
            ADD_FAILURE() << name << " was read";
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace adaptiso
