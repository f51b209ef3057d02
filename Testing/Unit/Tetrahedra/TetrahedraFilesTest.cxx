#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "adaptiso/Tetrahedra/TetrahedraFiles.h"

namespace adaptiso {
namespace {

const std::vector<TetrahedraRegion> kRegions{
    {2, "brain", 0}, {3, "csf", 0}, {5, "say \"skin\"", 0}};

TetrahedralMesh two() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.125, 0, -1}},
            {{0, 1, 2, 3}, {0, 2, 1, 4}},
            {5, 2}};
}

std::string written(const std::function<void(const std::filesystem::path&)>& write) {
    const std::filesystem::path path =
        std::filesystem::path(::testing::TempDir()) /
        ::testing::UnitTest::GetInstance()->current_test_info()->name();
    write(path);
    std::ifstream stream(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    stream.close();
    std::filesystem::remove(path);
    return text;
}

TEST(TetrahedraFiles, MshHasNamedRegions) {
    const std::string text = written([](const auto& path) { writeMsh22(two(), kRegions, path); });
    EXPECT_NE(text.find("$PhysicalNames\n3\n3 2 \"brain\"\n3 3 \"csf\"\n3 5 \"say  skin \"\n"),
              std::string::npos);
    EXPECT_NE(text.find("$Elements\n2\n1 4 2 5 5 1 2 3 4\n2 4 2 2 2 1 3 2 5\n"), std::string::npos);
}

TEST(TetrahedraFiles, DgfHasThePlaceOfTheRegion) {
    const std::string text = written([](const auto& path) { writeDgf(two(), kRegions, path); });
    EXPECT_NE(text.find("Simplex\nparameters 1\n0 1 2 3 2\n0 2 1 4 0\n#\n"), std::string::npos);
}

/// As DUNEuro's reader takes it: two points a line, corners in columns of six digits from 1.
TEST(TetrahedraFiles, CauchyKeepsItsColumns) {
    EXPECT_EQ(written([](const auto& path) { writeCauchy(two(), path); }),
              "BOI - GEOMETRIEFILE\n"
              "===================================================================\n"
              "===================================================================\n"
              "BOI - STEUERKARTE\n"
              "  ANZAHL DER KNOTEN             : 5\n"
              "  ANZAHL DER ELEMENTE           : 2\n"
              "  GEOMETR. STRUKTUR - DIMENSION : 3\n"
              "EOI - STEUERKARTE\n"
              "===================================================================\n"
              "===================================================================\n"
              "BOI - KOORDINATENKARTE\n"
              "   0 0 0     1 0 0\n"
              "   0 1 0     0 0 1\n"
              "   0.125 0 -1\n"
              "EOI - KOORDINATENKARTE\n"
              "===================================================================\n"
              "===================================================================\n"
              "BOI - ELEMENTKNOTENKARTE\n"
              "  303:      1     2     3     4\n"
              "  303:      1     3     2     5\n"
              "EOI - ELEMENTKNOTENKARTE\n"
              "===================================================================\n"
              "===================================================================\n"
              "EOI - GEOMETRIEFILE\n");
}

TEST(TetrahedraFiles, CauchysTensorsAreNumberedFromOne) {
    const std::vector<double> conductivities{0.33, 1.79, 0.43};
    const std::string text = written(
        [&](const auto& path) { writeCauchyTensors(two(), kRegions, conductivities, path); });
    EXPECT_NE(text.find("BOI - TENSOR\n1 0.43 0.43 0.43\n 0 0 0\n2 0.33 0.33 0.33\n 0 0 0\n"
                        "EOI - TENSOR\n"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso
