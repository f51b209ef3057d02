// GLB and 3MF: several surfaces in a file, and what other programs write.
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "MeshIOTestSupport.h"
#include "Zip.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/Scene.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso {
namespace {

using testing::bytesOf;
using testing::decoded;
using testing::icosphere;
using testing::messageOf;
using testing::temporaryFile;
using testing::tetrahedron;
using testing::written;

template <class T>
std::string little(std::initializer_list<T> numbers) {
    std::string bytes;
    for (const T number : numbers) appendLittleEndian(number, bytes);
    return bytes;
}

std::string glb(std::string json, std::string bin) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bin.resize((bin.size() + 3) / 4 * 4);
    const auto word = [](std::size_t number) {
        return little({static_cast<std::uint32_t>(number)});
    };
    return "glTF" + word(2) + word(28 + json.size() + bin.size()) + word(json.size()) + "JSON" +
           json + word(bin.size()) + std::string("BIN\0", 4) + bin;
}

/// Two triangles of a unit square, its points 16 bytes apart, with corners of a byte each.
struct Square {
    std::string nodes = R"([{"mesh":0}])", roots = "[0]", more{}, primitive = R"("indices":1)";
    std::string accessor = R"("bufferView":0)", asset = R"("version":"2.0")";
    int component = 5121;

    std::string bytes() const {
        std::string bin;
        for (const auto& [x, y] : {std::pair(0.f, 0.f), {1.f, 0.f}, {0.f, 1.f}, {1.f, 1.f}}) {
            bin += little({x, y, 0.f, 7.f});
        }
        const std::string corners = component == 5121   ? little<std::uint8_t>({0, 1, 2, 2, 1, 3})
                                    : component == 5123 ? little<std::uint16_t>({0, 1, 2, 2, 1, 3})
                                                        : little<std::uint32_t>({0, 1, 2, 2, 1, 3});
        const std::string json =
            R"({"asset":{)" + asset + R"(},"scene":0,"scenes":[{"nodes":)" + roots +
            R"(}],"nodes":)" + nodes +
            R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},)" + primitive +
            R"(}]}],"accessors":[{)" + accessor +
            R"(,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":)" +
            std::to_string(component) +
            R"(,"count":6,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":64,)"
            R"("byteStride":16},{"buffer":0,"byteOffset":64,"byteLength":)" +
            std::to_string(corners.size()) + R"(}],"buffers":[{"byteLength":)" +
            std::to_string(64 + corners.size()) + "}]" + more + "}";
        return glb(json, bin + corners);
    }
    MeshFile read() const { return decoded(bytes(), "a.glb"); }
    std::string refusal() const {
        return messageOf<FileError>([&] { read(); });
    }
};

const Warning* findCode(const MeshFile& file, std::string_view code) {
    for (const Warning& warning : file.warnings) {
        if (warning.code == code) return &warning;
    }
    return nullptr;
}

TEST(GlbFile, IsReadInMetresWithYUpWhateverTheTypeOfItsIndices) {
    for (const int type : {5121, 5123, 5125}) {
        const MeshFile file = Square{.component = type}.read();
        EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
        // x to the left, y up, z to the front
        EXPECT_EQ(file.mesh.points,
                  (std::vector<Vec3>{{0, 0, 0}, {-1000, 0, 0}, {0, 0, 1000}, {-1000, 0, 1000}}));
        EXPECT_FALSE(file.frame);
        ASSERT_EQ(file.warnings.size(), 1U);
        EXPECT_EQ(file.warnings[0].code, "unit-converted");
    }
}

TEST(GlbFile, NodesPlaceMeshesByMatrixAndByParts) {
    // a quarter turn about z, scaled by 2, moved along x; then the same as a matrix, by its parent
    const MeshFile parts = Square{.nodes = R"([{"mesh":0,"rotation":[0,0,0.70710678118654757,
        0.70710678118654757],"scale":[2,2,2],"translation":[5,0,0]}])"}
                               .read();
    const MeshFile matrix = Square{.nodes = R"([{"children":[1],"matrix":[1,0,0,0, 0,1,0,0,
        0,0,1,0, 5,0,0,1]},{"mesh":0,"matrix":[0,2,0,0, -2,0,0,0, 0,0,2,0, 0,0,0,1]}])"}
                                .read();
    const std::vector<Vec3> due{{-5000, 0, 0}, {-5000, 0, 2000}, {-3000, 0, 0}, {-3000, 0, 2000}};
    for (std::size_t i = 0; i < due.size(); ++i) {
        EXPECT_LE(norm(parts.mesh.points[i] - due[i]), 1e-9);  // of the quaternion's digits
        EXPECT_EQ(matrix.mesh.points[i], due[i]);
    }
    // a mirror turns the triangles round
    const MeshFile mirror = Square{.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])"}.read();
    EXPECT_EQ(mirror.mesh.triangles.front(), (Triangle{0, 2, 1}));
}

TEST(GlbFile, JsonThatIsPaddedByZerosIsRead) {
    int padded = 0;
    for (const char* const more : {R"(,"extras":1)", R"(,"extras":11)"}) {
        std::string bytes = Square{.more = more}.bytes();
        for (std::size_t i = bytes.find("BIN") - 4; bytes[i - 1] == ' '; --i, ++padded) {
            bytes[i - 1] = '\0';
        }
        EXPECT_EQ(decoded(bytes, "a.glb").mesh.triangles.size(), 2U);
    }
    EXPECT_GT(padded, 0);
}

TEST(GlbFile, NumbersThatAreMillimetresAreWarnedOf) {
    const MeshFile file = Square{.nodes = R"([{"mesh":0,"scale":[300,400,1]}])"}.read();
    EXPECT_EQ(findCode(file, "unit-converted")->text,
              "its metres, with Y up, were turned into mm, with Z up; it is 500 m large: where its "
              "numbers are mm, scale it by 0.001 first");
}

TEST(GlbFile, SeveralMeshesAreOneSurfaceAndOnlyTheSceneCounts) {
    const MeshFile file =
        Square{.nodes = R"([{"mesh":0},{"mesh":0,"translation":[0,0,1]},{"mesh":0}])",
               .roots = "[1,0]"}
            .read();
    EXPECT_EQ(file.mesh.points.size(), 8U);
    EXPECT_EQ(file.mesh.points.front(), (Vec3{0, 1000, 0}));
    EXPECT_EQ(file.mesh.triangles.back(), (Triangle{6, 5, 7}));
    EXPECT_EQ(file.solids, (std::vector<std::int64_t>{0, 2}));
    ASSERT_NE(findCode(file, "several-solids"), nullptr);
    EXPECT_EQ(findCode(file, "several-solids")->text,
              "it holds 2 meshes, read as one surface; adaptiso-check looks at each by itself "
              "where all are closed");
}

TEST(GlbFile, StripsFansAndCornersWithoutIndicesAreRead) {
    EXPECT_EQ(Square{.primitive = R"("mode":5)"}.read().mesh.triangles,
              (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(Square{.primitive = R"("mode":6)"}.read().mesh.triangles,
              (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_NE(Square{.primitive = R"("mode":4)"}.refusal().find("4 corners, no multiple of 3"),
              std::string::npos);
    EXPECT_NE(Square{.primitive = R"("mode":1)"}.refusal().find("no triangle"), std::string::npos);
}

TEST(GlbFile, PointsThatWereSplitForTheirNormalsAreJoinedAgain) {
    // each triangle with points of its own, as exporters of flat shading write
    std::string bin;
    const TriangleMesh solid = tetrahedron();
    for (const Triangle& t : solid.triangles) {
        const Vec3 n =
            normalized(areaVector2(solid.points[t[0]], solid.points[t[1]], solid.points[t[2]]));
        for (const VertexId v : t) {
            for (const Vec3& p : {solid.points[v], n}) {
                bin += little(
                    {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
            }
        }
    }
    const std::string json =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
        R"({"attributes":{"POSITION":0,"NORMAL":1}}]}],"accessors":[{"bufferView":0,)"
        R"("componentType":5126,"count":12,"type":"VEC3"},{"bufferView":0,"byteOffset":12,)"
        R"("componentType":5126,"count":12,"type":"VEC3"}],"bufferViews":[{"buffer":0,)"
        R"("byteLength":288,"byteStride":24}],"buffers":[{"byteLength":288}]})";
    const MeshFile file = decoded(glb(json, bin), "a.glb");
    EXPECT_EQ(file.mesh.points.size(), 4U);
    EXPECT_TRUE(file.mesh.normals.empty());
    EXPECT_NEAR(enclosedVolume(file.mesh), 1e9, 1);
}

TEST(GlbFile, WhatIsNotReadIsNamed) {
    const auto has = [](const std::string& text, std::string_view words) {
        EXPECT_NE(text.find(words), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos);
    };
    has(Square{.more = R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"}.refusal(),
        "needs glTF's extension 'KHR_draco_mesh_compression'");
    has(Square{.accessor = R"("sparse":{},"bufferView":0)"}.refusal(), "POSITION is sparse");
    has(Square{.accessor = R"("bufferView":0,"byteOffset":24)"}.refusal(),
        "POSITION has 4 values in 40 bytes");
    has(Square{.asset = R"("version":"1.0")"}.refusal(), "it is glTF '1.0'");
    has(Square{.nodes = R"([{"mesh":0,"scale":[0,1,1]}])"}.refusal(), "flattens");
    has(Square{.nodes = R"([{"mesh":0,"rotation":[0,0,0,0]}])"}.refusal(), "flattens");
    has(Square{.nodes = R"([{"mesh":0,"skin":0}])"}.refusal(), "a skeleton moves");
    has(Square{.nodes = R"([{"mesh":0,"weights":[1]}])"}.refusal(), "shape keys move");
    has(Square{.component = 5126}.refusal(), "indices of a mesh have the component type 5126");
    has(Square{.nodes = R"([{"children":[0],"mesh":0}])"}.refusal(), "a node twice");
    has(Square{.nodes = R"([{"mesh":7}])"}.refusal(), "JSON is not as glTF has it");
    has(Square{.accessor = R"("bufferView":-1)"}.refusal(), "is no size");
    EXPECT_FALSE(Square{.more = R"(,"extensionsRequired":["KHR_materials_unlit"])"}
                     .read()
                     .mesh.triangles.empty());
}

TEST(GlbFile, ColoursComeBackToTheBit) {
    TriangleMesh mesh = icosphere(2);  // 162 points
    MeshWriteOptions options;
    std::vector<Color> colors;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const auto shade = static_cast<std::uint8_t>(i);
        colors.push_back({shade, static_cast<std::uint8_t>(255 - shade), 128});
    }
    options.pointArrays = {{"RGB", colors}};
    const MeshFile file = decodeMesh(written(mesh, "a.glb", options), findMeshFormat("a.glb"), "a",
                                     {.keepsPointArrays = true});
    ASSERT_EQ(file.pointArrays.size(), 1U);
    EXPECT_EQ(std::get<std::vector<Color>>(file.pointArrays[0].values), colors);
}

std::vector<ScenePart> twoParts() {
    return {{"Lung <left> & \xC3\xA4", Color{200, 30, 4}, tetrahedron()},
            {"Heart", Color{0, 255, 128}, icosphere(1, {9, 9, 9}, 3)}};
}

MeshWriteOptions inLps() {
    MeshWriteOptions options;
    options.frame = CoordinateFrame::Lps;
    return options;
}

TEST(Scene, PartsComeBackInPlaceWithTheirColours) {
    for (const std::string name : {"all.glb", "all.3mf"}) {
        EXPECT_TRUE(holdsScene(findMeshFormat(name)));
        const auto path = temporaryFile(name);
        writeScene(twoParts(), path, inLps());
        const MeshFile file = readMesh(path, {.keepsPointArrays = true});
        EXPECT_EQ(file.frame, CoordinateFrame::Lps);
        EXPECT_EQ(file.mesh.points.size(), 4U + 42U);
        EXPECT_EQ(file.mesh.points[3], tetrahedron().points[3]);
        EXPECT_EQ(file.mesh.triangles.size(), 4U + 80U);
        ASSERT_EQ(file.pointArrays.size(), 1U);
        const auto& colors = std::get<std::vector<Color>>(file.pointArrays[0].values);
        EXPECT_EQ(colors.front(), (Color{200, 30, 4}));
        EXPECT_EQ(colors.back(), (Color{0, 255, 128}));
        EXPECT_NE(findCode(file, "several-solids"), nullptr);
        EXPECT_EQ(findCode(file, "unit-converted"), nullptr);
        const std::string once = bytesOf(path);
        writeScene(twoParts(), path, inLps());
        EXPECT_EQ(bytesOf(path), once);
    }
    EXPECT_FALSE(holdsScene(findMeshFormat("all.ply")));
    const auto whole = temporaryFile("all.ply");
    writeScene(twoParts(), whole, inLps());
    EXPECT_EQ(readMesh(whole).mesh.points.size(), 4U + 42U);
    EXPECT_EQ(readMesh(whole).mesh.triangles.size(), 4U + 80U);
    std::vector<ScenePart> named = twoParts();
    named[0].name = std::string(199, 'a') + "\xE8\x84\xB3";  // cut within a character
    const auto path = temporaryFile("named.3mf");
    writeScene(named, path, inLps());
    EXPECT_EQ(readMesh(path).mesh.triangles.size(), 84U);
}

using Files = std::vector<std::pair<std::string, std::string>>;

std::string zipped(const Files& files) {
    std::ostringstream stream;
    ByteSink sink(stream);
    meshio::writeZip(files, sink);
    sink.finish();
    return std::move(stream).str();
}

std::string model(const std::string& attributes, const std::string& more,
                  const std::string& build) {
    return "<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" " +
           attributes +
           "><resources><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>"
           "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"2\" z=\"0\"/><vertex x=\"0\" "
           "y=\"0\" z=\"3\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle "
           "v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"0\" v2=\"3\" v3=\"2\"/><triangle v1=\"1\" "
           "v2=\"2\" v3=\"3\"/></triangles></mesh></object>" +
           more + "</resources><build>" + build + "</build></model>";
}

MeshFile read3mf(const std::string& text) {
    return decoded(zipped({{"3D/3dmodel.model", text}}), "a.3mf");
}

TEST(ThreeMfFile, UnitsAreTurnedIntoMillimetres) {
    const MeshFile file = read3mf(model("unit=\"inch\"", "", "<item objectid=\"1\"/>"));
    EXPECT_EQ(file.mesh.points[2], (Vec3{0, 50.8, 0}));
    ASSERT_NE(findCode(file, "unit-converted"), nullptr);
    EXPECT_EQ(findCode(file, "unit-converted")->text, "its lengths in inch were turned into mm");
}

TEST(ThreeMfFile, ComponentsAndItemsPlaceObjects) {
    const MeshFile file = read3mf(
        model("",
              "<object id=\"2\"><components><component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 "
              "1 10 0 0\"/><component objectid=\"1\"/></components></object>",
              "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 5\"/>"));
    ASSERT_EQ(file.mesh.points.size(), 8U);
    EXPECT_EQ(file.mesh.points[1], (Vec3{10, 1, 5}));
    EXPECT_EQ(file.mesh.points[2], (Vec3{8, 0, 5}));
    EXPECT_EQ(file.mesh.points[5], (Vec3{1, 0, 5}));
    EXPECT_NEAR(enclosedVolume(file.mesh), 2, 1e-12);
}

TEST(ThreeMfFile, ModelsInFilesOfTheirOwnAreRead) {
    const std::string root =
        "<model xmlns=\"c\" xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/"
        "2015/06\" requiredextensions=\"p\"><resources><object id=\"8\"><components><component "
        "p:path=\"/3D/Objects/a.model\" objectid=\"1\"/></components></object></resources><build>"
        "<item objectid=\"8\"/></build></model>";
    const Files files{{"_rels/.rels",
                       "<Relationships><Relationship Target=\"/3D/Main.model\" "
                       "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
                       "</Relationships>"},
                      {"3D/main.model", root},
                      {"3D/Objects/a.model", model("", "", "")}};
    EXPECT_EQ(decoded(zipped(files), "a.3mf").mesh.points, tetrahedron().points);
}

TEST(ThreeMfFile, WhatIsNotReadIsNamed) {
    const auto has = [](const std::string& text, std::string_view words) {
        const std::string message = messageOf<FileError>([&] { read3mf(text); });
        EXPECT_NE(message.find(words), std::string::npos) << message;
    };
    has(model("", "", "<item objectid=\"7\"/>"), "places an object '7', which is not there");
    has(model("unit=\"parsec\"", "", "<item objectid=\"1\"/>"), "unit is 'parsec'");
    has(model("xmlns:b=\"http://x/beamlattice\" requiredextensions=\"b\"", "", ""),
        "needs 3MF's extension 'http://x/beamlattice'");
    has(model("", "", ""), "no triangle");
    // in a circle
    has(model("", "<object id=\"2\"><components><component objectid=\"2\"/></components></object>",
              "<item objectid=\"2\"/>"),
        "decompression bomb");
    EXPECT_NE(messageOf<FileError>([] {
                  decoded(zipped({{"a.txt", "b"}}), "a.3mf");
              }).find("has no file '3D/3dmodel.model'"),
              std::string::npos);
    std::string damaged = written(icosphere(2), "a.3mf");
    damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
    EXPECT_THROW(decoded(damaged, "a.3mf"), FileError);
}

TEST(ThreeMfFile, OnlySolidsOfTheCoreSpecificationAreRead) {
    const MeshFile file =
        read3mf(model("xmlns:s=\"http://x/slice\"",
                      "<s:slicestack id=\"5\"><s:slice><s:vertices><s:vertex x=\"1\" y=\"2\"/>"
                      "</s:vertices></s:slice></s:slicestack><object id=\"3\" type=\"support\">"
                      "<components><component objectid=\"1\"/></components></object>",
                      "<item objectid=\"1\"/><item objectid=\"3\"/>"));
    EXPECT_EQ(file.mesh.points, tetrahedron().points);
    ASSERT_NE(findCode(file, "supports-left-out"), nullptr);
    EXPECT_EQ(findCode(file, "supports-left-out")->text,
              "1 support or other object beside the solid left out");
}

TEST(ThreeMfFile, WhatItTakesIsLimited) {
    // a circle of components whose names are long
    const std::string id(100'000, 'x');
    const std::string part = "<component objectid=\"" + id + "\"/>";
    const std::string circle =
        "<object id=\"" + id + "\"><components>" + part + part + "</components></object>";
    const auto isBomb = [](const std::string& text) {
        return messageOf<FileError>([&] { read3mf(text); }).find("decompression bomb") !=
               std::string::npos;
    };
    EXPECT_TRUE(isBomb(model("", circle, "<item objectid=\"" + id + "\"/>")));
    std::string item = "<item objectid=\"1\" transform=\"";
    for (int n = 0; n < 12; ++n) item += "nan ";
    EXPECT_NE(messageOf<FileError>([&] { read3mf(model("", "", item + "\"/>")); }).find("flattens"),
              std::string::npos);
}

TEST(ThreeMfFile, StoredAndZip64EntriesAreRead) {
    const std::string text = model("", "", "<item objectid=\"1\"/>");
    const std::string name = "3D/3dmodel.model";
    const auto size = static_cast<std::uint32_t>(text.size());
    // what writeZip() says of the same bytes, for their checksum
    const std::string packed = zipped({{name, text}});
    const std::string checksum = packed.substr(14, 4);
    const std::string common = little<std::uint16_t>({45, 0, 0, 0, 33}) + checksum;
    const std::string in64 = little<std::uint32_t>({0xFFFFFFFF, 0xFFFFFFFF});
    const std::string local =
        "PK\3\4" + common + little({size, size}) + little<std::uint16_t>({16, 0}) + name + text;
    const std::string extra =
        little<std::uint16_t>({1, 24}) + little<std::uint64_t>({size, size, 0});
    const std::string entry = "PK\1\2" + little<std::uint16_t>({45}) + common + in64 +
                              little<std::uint16_t>({16, 28, 0, 0, 0, 0, 0}) +
                              little<std::uint32_t>({0xFFFFFFFF}) + name + extra;
    const std::string end = "PK\5\6" + little<std::uint16_t>({0, 0, 1, 1}) +
                            little({static_cast<std::uint32_t>(entry.size()),
                                    static_cast<std::uint32_t>(local.size())}) +
                            std::string(2, '\0');
    EXPECT_EQ(decoded(local + entry + end, "a.3mf").mesh.points, tetrahedron().points);
    const std::string end64 =
        "PK\6\6" + little<std::uint64_t>({44}) + little<std::uint16_t>({45, 45}) +
        little<std::uint32_t>({0, 0}) + little<std::uint64_t>({1, 1, entry.size(), local.size()}) +
        "PK\6\7" + little<std::uint32_t>({0}) +
        little<std::uint64_t>({local.size() + entry.size()}) + little<std::uint32_t>({1}) +
        "PK\5\6" + little<std::uint16_t>({0, 0, 0xFFFF, 0xFFFF}) + in64 + std::string(2, '\0');
    EXPECT_EQ(decoded(local + entry + end64, "a.3mf").mesh.points, tetrahedron().points);
}

}  // namespace
}  // namespace adaptiso
