// Labels in files: of triangles in .vtp, of points as GIFTI, blocks by name. What VTK and nibabel
// make of them is tested with adaptiso-labels.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/LabelFiles.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class LabelFiles : public ::testing::Test {
protected:
    LabelFiles() { fs::create_directories(folder_); }
    ~LabelFiles() override { fs::remove_all(folder_); }

    std::string text(const std::string& name) const {
        std::ifstream file(folder_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }

    fs::path folder_ = fs::path(::testing::TempDir()) /
                       (std::string("LabelFiles-") +
                        ::testing::UnitTest::GetInstance()->current_test_info()->name());
    TriangleMesh mesh_{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
                       {},
                       {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
};

using Labels = std::vector<std::int32_t>;

TEST_F(LabelFiles, ArraysOfTrianglesGoIntoVtp) {
    MeshWriteOptions options;
    options.cellArrays = {{"label0", Labels{1, 1, -2, 7}},
                          {"label1", std::vector<std::uint64_t>{0, 0, 0, ~std::uint64_t{0}}}};
    writeMesh(mesh_, folder_ / "a.vtp", options);
    EXPECT_NE(text("a.vtp").find("type=\"Int32\" Name=\"label0\""), std::string::npos);
    EXPECT_NE(text("a.vtp").find("type=\"UInt64\" Name=\"label1\""), std::string::npos);
    EXPECT_EQ(readMesh(folder_ / "a.vtp").mesh.triangles, mesh_.triangles);
}

TEST_F(LabelFiles, ArraysThatDoNotFitAreRefused) {
    MeshWriteOptions options;
    options.cellArrays = {{"label0", Labels{1, 1, -2}}};
    EXPECT_THROW(writeMesh(mesh_, folder_ / "a.vtp", options), InvalidInput);
    options.cellArrays = {{"label0", Labels{1, 1, -2, 7}}};
    for (const char* const name : {"a.ply", "a.vtk", "a.gii"}) {
        EXPECT_THROW(writeMesh(mesh_, folder_ / name, options), InvalidInput) << name;
    }
}

TEST_F(LabelFiles, GiftiHasItsTableAndOneArray) {
    const std::vector<std::int32_t> labels{1, 1, 7, 7};
    const std::vector<LabelKey> table{{1, "a < b & \"c\"", {255, 0, 51}}, {7, "x", {}}};
    writeGiftiLabels(labels, table, folder_ / "a.label.gii");
    const std::string file = text("a.label.gii");
    EXPECT_NE(file.find("<Label Key=\"0\" "), std::string::npos);
    EXPECT_NE(file.find("<Label Key=\"1\" Red=\"1\" Green=\"0\" Blue=\"0.2\" Alpha=\"1\">"
                        "a &lt; b &amp; &quot;c&quot;</Label>"),
              std::string::npos);
    EXPECT_NE(file.find("Dim0=\"4\""), std::string::npos);
    EXPECT_THROW(writeGiftiLabels({}, table, folder_ / "b.label.gii"), InvalidInput);
    EXPECT_THROW(writeGiftiLabels(labels, table, folder_ / "none" / "b.gii"), FileError);
}

TEST_F(LabelFiles, BlocksAreInOrderAndNamed) {
    const std::vector<VtkBlock> blocks{{"left/\"one\"", "regions/3.vtp"}, {"b", "regions/-1.vtp"}};
    writeMultiBlock(blocks, folder_ / "all.vtm");
    EXPECT_EQ(text("all.vtm"),
              "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
              "byte_order=\"LittleEndian\">\n<vtkMultiBlockDataSet>\n"
              "<DataSet index=\"0\" name=\"left/&quot;one&quot;\" file=\"regions/3.vtp\"/>\n"
              "<DataSet index=\"1\" name=\"b\" file=\"regions/-1.vtp\"/>\n"
              "</vtkMultiBlockDataSet>\n</VTKFile>\n");
}

}  // namespace
}  // namespace adaptiso
