#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>

#include "Support/Meshes.h"
#include "Support/Messages.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::testing {

/// A path in a folder of the running test's own, where nothing is yet.
inline std::filesystem::path temporaryFile(const std::string& name) {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string folder = std::string("meshio_") + test->test_suite_name() + "_" + test->name();
    for (char& c : folder) c = c == '/' ? '_' : c;
    const auto path = std::filesystem::path(::testing::TempDir()) / folder;
    std::filesystem::create_directories(path);
    std::filesystem::remove_all(path / name);
    return path / name;
}

inline std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The bytes that writeMesh() writes.
inline std::string written(const TriangleMesh& mesh, const std::string& fileName,
                           const MeshWriteOptions& options = {}) {
    const auto path = temporaryFile(fileName);
    writeMesh(mesh, path, options);
    return bytesOf(path);
}

inline MeshFile decoded(const std::string& bytes, const std::string& fileName) {
    return decodeMesh(bytes, findMeshFormat(fileName), fileName);
}

/// One file name for each format.
inline std::string exampleName(const MeshFormat& format) {
    return "surface" + std::string(format.extensions.front());
}

/// Name of a TEST_P over meshFormats(): the format's extension.
inline std::string nameOfFormat(const ::testing::TestParamInfo<int>& info) {
    return std::string(meshFormats()[info.param].extensions.front().substr(1));
}

/// `text` with `to` in place of the first `from`. \pre it holds `from`
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Four points, none on a plane of coordinates with another; outward.
inline TriangleMesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
            {},
            {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// 10 x 20 x 30 voxels of 1 x 2 x 3 mm along L, P and S: right-handed in LPS.
inline ImageGeometry straightVolume() {
    return {{10, 20, 30}, {-5, -20, -45}, Mat3::diagonal(1, 2, 3)};
}

/// Rotated about a skew axis; unequal spacing and size.
inline ImageGeometry obliqueVolume() {
    // columns of the rotation (2 1 -2; -2 2 -1; 1 2 2) / 3: orthonormal on paper, determinant 1
    const Mat3 rotation{
        {{{2. / 3, -2. / 3, 1. / 3}, {1. / 3, 2. / 3, 2. / 3}, {-2. / 3, -1. / 3, 2. / 3}}}};
    return {{176, 240, 200}, {-80.5, 30.25, -112}, rotation * Mat3::diagonal(0.9, 1.1, 1.5)};
}

/// obliqueVolume() with its third axis turned back: left-handed in LPS.
inline ImageGeometry mirroredVolume() {
    ImageGeometry volume = obliqueVolume();
    volume.indexToPhysical.column[2] = -volume.indexToPhysical.column[2];
    return volume;
}

/// A gantry tilt of about 11 degrees: axes j and k not at right angles.
inline ImageGeometry shearedVolume() {
    ImageGeometry volume = straightVolume();
    volume.indexToPhysical.column[2] = {0, 0.6, 3};
    return volume;
}

}  // namespace adaptiso::testing
