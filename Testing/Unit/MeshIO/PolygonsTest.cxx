// Files with polygons and triangle strips, with truth on paper.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <numeric>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using testing::decoded;
using testing::messageOf;

/// A surface as files list it.
struct Faces {
    std::vector<Vec3> points;
    std::vector<std::vector<int>> faces;
};

const Faces kCube{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// An L of area 3, one high: two hexagons, six quadrangles.
Faces angle() {
    const std::vector<std::array<double, 2>> ring{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    Faces prism;
    for (const double z : {0., 1.}) {
        for (const auto& [x, y] : ring) prism.points.push_back({x, y, z});
    }
    prism.faces = {{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}};
    for (int i = 0; i < 6; ++i) prism.faces.push_back({i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6});
    return prism;
}

std::string text(double number) {
    return " " + std::to_string(number);
}

std::string pointLines(const Faces& mesh, const std::string& before = "") {
    std::string lines;
    for (const Vec3& p : mesh.points) lines += before + text(p.x) + text(p.y) + text(p.z) + "\n";
    return lines;
}

std::string faceLines(const Faces& mesh) {
    std::string lines;
    for (const auto& face : mesh.faces) {
        lines += std::to_string(face.size());
        for (const int corner : face) lines += " " + std::to_string(corner);
        lines += "\n";
    }
    return lines;
}

std::string plyText(const Faces& mesh, const std::string& element = "face") {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement " + element + " " +
           std::to_string(mesh.faces.size()) +
           "\nproperty list int int vertex_indices\nend_header\n" + pointLines(mesh) +
           faceLines(mesh);
}

std::string plyBinary(const Faces& mesh) {
    std::string bytes = plyText(mesh);
    bytes.resize(bytes.find("end_header\n") + 11);
    bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
    bytes.replace(bytes.find("list int"), 8, "list uchar");
    const auto put = [&](auto number) {
        bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
    };
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(p[axis]));
    }
    for (const auto& face : mesh.faces) {
        put(static_cast<std::uint8_t>(face.size()));
        for (const int corner : face) put(corner);
    }
    return bytes;
}

std::string objText(const Faces& mesh) {
    std::string lines = pointLines(mesh, "v");
    for (const auto& face : mesh.faces) {
        lines += "f";
        for (const int corner : face) lines += " " + std::to_string(corner + 1);
        lines += "\n";
    }
    return lines;
}

std::string offText(const Faces& mesh) {
    return "OFF\n" + std::to_string(mesh.points.size()) + " " + std::to_string(mesh.faces.size()) +
           " 0\n" + pointLines(mesh) + faceLines(mesh);
}

std::size_t cornerCount(const Faces& mesh) {
    std::size_t count = 0;
    for (const auto& face : mesh.faces) count += face.size();
    return count;
}

std::string vtkText(const Faces& mesh, const std::string& section = "POLYGONS") {
    return "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS " +
           std::to_string(mesh.points.size()) + " float\n" + pointLines(mesh) + section + " " +
           std::to_string(mesh.faces.size()) + " " +
           std::to_string(mesh.faces.size() + cornerCount(mesh)) + "\n" + faceLines(mesh);
}

std::string vtk5Text(const Faces& mesh) {
    std::string offsets = "0", corners;
    std::size_t end = 0;
    for (const auto& face : mesh.faces) {
        offsets += " " + std::to_string(end += face.size());
        for (const int corner : face) corners += std::to_string(corner) + " ";
    }
    return "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nPOINTS " +
           std::to_string(mesh.points.size()) + " float\n" + pointLines(mesh) + "POLYGONS " +
           std::to_string(mesh.faces.size() + 1) + " " + std::to_string(end) +
           "\nOFFSETS vtktypeint64\n" + offsets + "\nCONNECTIVITY vtktypeint64\n" + corners + "\n";
}

std::string vtpText(const Faces& mesh, const std::string& element = "Polys") {
    std::string ends, corners;
    std::size_t end = 0;
    for (const auto& face : mesh.faces) {
        ends += std::to_string(end += face.size()) + " ";
        for (const int corner : face) corners += std::to_string(corner) + " ";
    }
    const std::string none = element == "Polys"
                                 ? ""
                                 : "<Polys><DataArray Name=\"connectivity\" format=\"ascii\"/>"
                                   "<DataArray Name=\"offsets\" format=\"ascii\"/></Polys>";
    const std::string count = std::to_string(mesh.faces.size());
    return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"" +
           std::to_string(mesh.points.size()) + "\" NumberOfPolys=\"" +
           (element == "Polys" ? count : "0") + "\" NumberOfStrips=\"" +
           (element == "Polys" ? "0" : count) + "\"><Points><DataArray format=\"ascii\">" +
           pointLines(mesh) + "</DataArray></Points>" + none + "<" + element +
           "><DataArray Name=\"connectivity\" format=\"ascii\">" + corners +
           "</DataArray><DataArray Name=\"offsets\" format=\"ascii\">" + ends + "</DataArray></" +
           element + "></Piece></PolyData></VTKFile>";
}

/// FreeSurfer's quadrangles; `isOld`: points in hundredths.
std::string quadrangles(const Faces& mesh, bool isOld) {
    std::string bytes = isOld ? "\xFF\xFF\xFF" : "\xFF\xFF\xFD";
    const auto put = [&](std::uint32_t number, int byteCount) {
        for (int byte = byteCount - 1; byte >= 0; --byte) {
            bytes += static_cast<char>(number >> (8 * byte) & 0xFF);
        }
    };
    put(static_cast<std::uint32_t>(mesh.points.size()), 3);
    put(static_cast<std::uint32_t>(mesh.faces.size()), 3);
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) {
            if (isOld) {
                put(static_cast<std::uint32_t>(static_cast<int>(100 * p[axis])), 2);
            } else {
                put(std::bit_cast<std::uint32_t>(static_cast<float>(p[axis])), 4);
            }
        }
    }
    for (const auto& face : mesh.faces) {
        for (const int corner : face) put(static_cast<std::uint32_t>(corner), 3);
    }
    return bytes;
}

using Files = std::vector<std::pair<std::string, std::string>>;

/// The same surface in every format that holds polygons.
Files filesOf(const Faces& mesh) {
    return {{"a.ply", plyText(mesh)}, {"b.ply", plyBinary(mesh)}, {"a.obj", objText(mesh)},
            {"a.off", offText(mesh)}, {"a.vtk", vtkText(mesh)},   {"b.vtk", vtk5Text(mesh)},
            {"a.vtp", vtpText(mesh)}};
}

std::string noteOf(const MeshFile& file) {
    if (file.warnings.size() != 1 || file.warnings[0].code != "polygons-cut") return {};
    return isNote(file.warnings[0]) ? file.warnings[0].text : std::string();
}

TEST(Polygons, OfACubeBecomeTwelveTriangles) {
    Files files = filesOf(kCube);
    files.emplace_back("lh.orig", quadrangles(kCube, false));
    files.emplace_back("lh.old.orig", quadrangles(kCube, true));
    for (const auto& [name, bytes] : files) {
        const MeshFile file = decodeMesh(bytes, name);
        EXPECT_EQ(file.mesh.points, kCube.points) << name;
        EXPECT_EQ(file.mesh.triangles.size(), 12) << name;
        EXPECT_DOUBLE_EQ(enclosedVolume(file.mesh), 1) << name;
        EXPECT_DOUBLE_EQ(surfaceArea(file.mesh), 6) << name;
        EXPECT_EQ(noteOf(file), "6 polygons were cut into 12 triangles") << name;
    }
}

TEST(Polygons, ThatAreConcaveDoNotFold) {
    for (const auto& [name, bytes] : filesOf(angle())) {
        const MeshFile file = decodeMesh(bytes, name);
        EXPECT_EQ(file.mesh.triangles.size(), 20) << name;
        EXPECT_DOUBLE_EQ(enclosedVolume(file.mesh), 3) << name;
        EXPECT_DOUBLE_EQ(surfaceArea(file.mesh), 2 * 3 + 8) << name;  // an outline of 8
        EXPECT_EQ(noteOf(file), "8 polygons were cut into 20 triangles") << name;
    }
}

TEST(Polygons, KeepTheirPlaceAmongTriangles) {
    Faces mesh = kCube;
    mesh.faces = {{0, 3, 2}, {0, 1, 5, 4}, {0, 2, 1}};
    for (const auto& [name, bytes] : filesOf(mesh)) {
        const std::vector<Triangle> triangles = decodeMesh(bytes, name).mesh.triangles;
        ASSERT_EQ(triangles.size(), 4) << name;
        EXPECT_EQ(triangles.front(), (Triangle{0, 3, 2})) << name;
        EXPECT_EQ(triangles.back(), (Triangle{0, 2, 1})) << name;
    }
}

TEST(Polygons, SayHowFarTheyAreFromPlanar) {
    // Two corners of a square lifted by 1: the plane of best fit lies at 1/2.
    const Faces saddle{{{0, 0, 0}, {10, 0, 1}, {10, 10, 0}, {0, 10, 1}}, {{0, 1, 2, 3}}};
    for (const auto& [name, bytes] : filesOf(saddle)) {
        EXPECT_EQ(noteOf(decodeMesh(bytes, name)),
                  "1 polygon was cut into 2 triangles; corners lie up to 0.5 mm off the plane of "
                  "their polygon")
            << name;
    }
}

TEST(Polygons, AreCutInAnyPlaneAndSize) {
    for (const double scale : {1e-150, 1e-3, 1., 1e30, 1e200}) {
        Faces mesh{{}, {{0, 1, 2, 3, 4}}};
        for (const auto& [x, y] : {std::pair(0., 0.), {4., 0.}, {4., 4.}, {2., 1.}, {0., 4.}}) {
            mesh.points.push_back({scale * (x - 2), scale * (x + y), scale * (3 - y)});
        }
        std::string bytes = "OFF\n5 1 0\n";
        for (const Vec3& p : mesh.points) {
            for (int axis = 0; axis < 3; ++axis) {
                char number[32];
                std::snprintf(number, sizeof number, " %.17g", p[axis]);
                bytes += number;
            }
            bytes += "\n";
        }
        const MeshFile file = decoded(bytes + "5 0 1 2 3 4\n", "a.off");
        ASSERT_EQ(file.mesh.triangles.size(), 3) << scale;
        // the corner that is reflex is in all of them
        for (const Triangle& triangle : file.mesh.triangles) {
            EXPECT_TRUE(std::ranges::count(triangle, 3)) << scale;
        }
    }
}

/// The winding number of a fan is the polygon's, so that adaptiso-mend finds the solid.
TEST(Polygons, ThatCrossThemselvesBecomeFans) {
    Faces mesh = kCube;
    mesh.points.push_back({0.25, 0.25, 0});
    mesh.points.push_back({0.75, 0.25, 0});
    mesh.points.push_back({0.5, 0.75, 0});
    const auto read = [&](std::vector<int> face, bool crosses) {
        mesh.faces = {{0, 3, 2}, std::move(face)};
        std::vector<Triangle> first;
        for (const auto& [name, bytes] : filesOf(mesh)) {
            const MeshFile file = decodeMesh(bytes, name);
            if (first.empty()) first = file.mesh.triangles;
            EXPECT_EQ(file.mesh.triangles, first) << name;
            const auto warning = std::ranges::find(file.warnings, "polygons-cross", &Warning::code);
            EXPECT_EQ(warning != file.warnings.end(), crosses) << name;
            if (warning == file.warnings.end()) continue;
            EXPECT_EQ(warning->text,
                      "1 polygon crosses itself or has a part without width; first: polygon 1");
            EXPECT_FALSE(isNote(*warning));
        }
        first.erase(first.begin());
        return first;
    };
    EXPECT_EQ(read({0, 2, 1, 3}, true), (std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}}));
    EXPECT_EQ(read({0, 1, 2, 0, 3}, true), (std::vector<Triangle>{{0, 1, 2}}));
    // a hole with a bridge to it goes round it: an area of 7/8
    double area = 0;
    for (const Triangle& t : read({0, 1, 2, 3, 0, 8, 10, 9, 8}, false)) {
        area += 0.5 * norm(areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
    }
    EXPECT_NEAR(area, 0.875, 1e-12);
}

TEST(Polygons, WithPointsThatAreNotThereAreRefusedByNumber) {
    const auto refusal = [](std::vector<int> face) {
        Faces mesh = kCube;
        mesh.faces = {{0, 3, 2}, std::move(face)};
        std::vector<std::string> messages;
        for (const auto& [name, bytes] : filesOf(mesh)) {
            const std::string message =
                messageOf<FileError>([&name = name, &bytes = bytes] { decodeMesh(bytes, name); });
            messages.push_back(message.substr(std::min(message.size(), name.size() + 2)));
        }
        EXPECT_EQ(std::ranges::count(messages, messages[0]), std::ssize(messages));
        return messages[0].substr(0, messages[0].find(';'));
    };
    EXPECT_EQ(refusal({0, 1, 2, 8}), "polygon 1 uses point 8, must be 0 to 7");
}

/// As triangles without area are, for adaptiso-check to report.
TEST(Polygons, WithoutAreaAreKeptAsTrianglesWithoutArea) {
    Faces mesh = kCube;
    mesh.points.push_back({0.5, 0, 0});
    mesh.points.push_back(mesh.points[0]);
    const auto trianglesOf = [&](std::vector<int> face) {
        mesh.faces = {{0, 3, 2}, std::move(face)};
        std::vector<Triangle> first;
        for (const auto& [name, bytes] : filesOf(mesh)) {
            std::vector<Triangle> triangles = decoded(bytes, name).mesh.triangles;
            if (first.empty()) first = triangles;
            EXPECT_EQ(triangles, first) << name;
        }
        first.erase(first.begin());
        return first;
    };
    EXPECT_EQ(trianglesOf({0, 8, 1, 9}), (std::vector<Triangle>{{0, 8, 1}, {0, 1, 9}}));
    EXPECT_EQ(trianglesOf({0, 9, 1, 2}), (std::vector<Triangle>{{0, 9, 1}, {2, 0, 1}}));
    EXPECT_EQ(trianglesOf({0, 0, 1, 2}), (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(trianglesOf({0, 0, 1, 1}), (std::vector<Triangle>{}));
    EXPECT_EQ(trianglesOf({0, 1}), (std::vector<Triangle>{}));
}

TEST(Polygons, OfTwoCornersAreLinesLeftOut) {
    Faces mesh = kCube;
    mesh.faces = {{0, 3, 2}, {0, 1}, {2, 2, 2, 2}};
    const MeshFile file = decoded(offText(mesh), "a.off");
    EXPECT_EQ(file.mesh.triangles.size(), 1U);
    ASSERT_EQ(file.warnings.size(), 1U);
    EXPECT_EQ(file.warnings[0].code, "lines-left-out");
}

TEST(Polygons, WithoutCornersAreMalformedText) {
    const std::string message =
        messageOf<FileError>([] { decoded("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf\n", "a.obj"); });
    EXPECT_NE(message.find("a face has no corners"), std::string::npos) << message;
}

TEST(Polygons, WithCornersThatAreNotThereAreKeptWithOtherFaults) {
    Faces mesh = kCube;
    mesh.faces = {{0, 3, 2}, {0, 1, 2, 99}};
    const MeshFile file =
        decodeMesh(offText(mesh), findMeshFormat("a.off"), "a.off", {.keepsFaults = true});
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 3, 2}, {0, 1, 2}, {0, 2, 99}}));
    std::string nan = offText(kCube);
    nan.replace(nan.find(" 0.0"), 9, " nan");
    EXPECT_EQ(decodeMesh(nan, findMeshFormat("a.off"), "a.off", {.keepsFaults = true})
                  .mesh.triangles.size(),
              12);
    EXPECT_NE(
        messageOf<FileError>([&] { decoded(nan, "a.off"); }).find("coordinate 0 of point 0 is "),
        std::string::npos);
}

TEST(Polygons, HaveNoMoreCornersThanTheirTimeAllows) {
    Faces comb;
    for (int i = 0; i < 16385; ++i) {
        comb.points.push_back({i / 2 * 1., i % 2 * 1., 0});
    }
    comb.faces.resize(1, std::vector<int>(comb.points.size()));
    std::iota(comb.faces[0].begin(), comb.faces[0].end(), 0);
    EXPECT_NE(messageOf<FileError>([&] {
                  decoded(offText(comb), "a.off");
              }).find("polygon 0 has 16385 corners, must have 16384 at most"),
              std::string::npos);
}

/// A band of two squares around a corner, as one strip.
const Faces kStrip{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {1, 1, 1}},
                   {{0, 1, 2, 3, 4, 5}}};

TEST(TriangleStrips, TurnEverySecondTriangleRound) {
    const Files files{{"a.ply", plyText(kStrip, "tristrips")},
                      {"a.vtk", vtkText(kStrip, "TRIANGLE_STRIPS")},
                      {"a.vtp", vtpText(kStrip, "Strips")}};
    for (const auto& [name, bytes] : files) {
        const MeshFile file = decodeMesh(bytes, name);
        EXPECT_EQ(file.mesh.triangles,
                  (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}))
            << name;
        EXPECT_EQ(noteOf(file), "1 triangle strip was cut into 4 triangles") << name;
    }
}

TEST(TriangleStrips, MayBeJoinedByRepeatedPointsAndInPlyByMinusOne) {
    Faces joined = kStrip;
    joined.faces = {{0, 1, 2, 3, 3, 2, 2, 3, 4, 5}};
    const std::vector<Triangle> all{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}};
    EXPECT_EQ(decoded(vtkText(joined, "TRIANGLE_STRIPS"), "a.vtk").mesh.triangles, all);
    joined.faces = {{0, 1, 2, 3, -1, 2, 3, 4, 5, -1}};
    const MeshFile file = decoded(plyText(joined, "tristrips"), "a.ply");
    EXPECT_EQ(file.mesh.triangles, all);
    EXPECT_EQ(noteOf(file), "2 triangle strips were cut into 4 triangles");
}

TEST(TriangleStrips, CountAmongTheCellsThatHaveValues) {
    const std::string good =
        vtkText(kStrip, "TRIANGLE_STRIPS") + "CELL_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n";
    EXPECT_EQ(decoded(good + "1\n", "a.vtk").mesh.triangles.size(), 4);
    std::string bad = good + "1 2\n";
    bad.replace(bad.find("CELL_DATA 1"), 11, "CELL_DATA 2");
    EXPECT_NE(messageOf<FileError>([&] {
                  decoded(bad, "a.vtk");
              }).find("values for 2 cells, and 1 cells"),
              std::string::npos);
}

TEST(Quadrangles, OfFreeSurferAreInTkRas) {
    EXPECT_EQ(decodeMesh(quadrangles(kCube, false), "lh.orig").frame, CoordinateFrame::TkRas);
    Faces negative = kCube;
    for (Vec3& p : negative.points) p = p - Vec3{1.5, 0.25, 300};
    EXPECT_EQ(decodeMesh(quadrangles(negative, true), "lh.orig").mesh.points, negative.points);
}

TEST(Quadrangles, OfFreeSurferThatAreCutOffOrMoreThanCountedAreRefused) {
    const std::string sound = quadrangles(kCube, false);
    for (std::size_t size = 4; size < sound.size(); size += 5) {
        EXPECT_THROW(decodeMesh(sound.substr(0, size), "lh.orig"), FileError) << size;
    }
    EXPECT_NE(messageOf<FileError>([&] {
                  decodeMesh(sound + sound.substr(sound.size() - 24), "a.orig");
              }).find("2 more behind the 6 quadrangles"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso
