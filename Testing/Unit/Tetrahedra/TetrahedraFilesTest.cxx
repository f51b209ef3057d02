#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include "adaptiso/Tetrahedra/Tetrahedra.h"

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

TEST(TetrahedraFiles, MshHasSimnibsWalls) {
    const std::string text =
        written([](const auto& path) { writeMsh22(two(), kRegions, path, true); });
    // three sides each towards the outside, and the wall between them of the inner region, 2:
    // outward of it, its normal points up, away from the corner below
    EXPECT_NE(text.find("$Elements\n9\n"), std::string::npos);
    std::map<std::string, int> counts;
    std::istringstream lines(text.substr(text.find("$Elements")));
    bool isFound = false;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        int number = 0, type = 0, tags = 0;
        std::string tag, again;
        std::array<int, 3> corners{};
        if (!(words >> number >> type >> tags >> tag >> again) || type != 2) continue;
        words >> corners[0] >> corners[1] >> corners[2];
        ++counts[tag];
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                    corners.end());
        isFound = isFound || (tag == "1002" && corners == std::array{1, 2, 3});
    }
    EXPECT_EQ(counts, (std::map<std::string, int>{{"1002", 4}, {"1005", 3}}));
    EXPECT_TRUE(isFound);
}

TEST(TetrahedraFiles, DgfHasThePlaceOfTheRegion) {
    const std::string text = written([](const auto& path) { writeDgf(two(), kRegions, path); });
    EXPECT_NE(text.find("Simplex\nparameters 1\n0 1 2 3 2\n0 2 1 4 0\n#\n"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
