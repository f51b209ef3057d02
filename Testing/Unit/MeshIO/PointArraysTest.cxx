// Values at the points of a mesh, in the same file.
#include <gtest/gtest.h>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using testing::messageOf;
using testing::temporaryFile;
using testing::tetrahedron;
using testing::written;

MeshFile withArrays(const std::string& bytes, const std::string& name) {
    return decodeMesh(bytes, findMeshFormat(name), name, {.keepsPointArrays = true});
}

const PointArray* find(const MeshFile& file, const std::string& name) {
    for (const PointArray& array : file.pointArrays) {
        if (array.name == name) return &array;
    }
    return nullptr;
}

std::vector<double> numbersOf(const MeshFile& file, const std::string& name) {
    const PointArray* const array = find(file, name);
    const auto* const values = array ? std::get_if<std::vector<double>>(&array->values) : nullptr;
    return values ? *values : std::vector<double>{};
}

std::vector<std::int64_t> wholeNumbersOf(const MeshFile& file, const std::string& name) {
    const PointArray* const array = find(file, name);
    const auto* const values =
        array ? std::get_if<std::vector<std::int64_t>>(&array->values) : nullptr;
    return values ? *values : std::vector<std::int64_t>{};
}

std::vector<Color> colorsOf(const MeshFile& file, const std::string& name) {
    const PointArray* const array = find(file, name);
    const auto* const values = array ? std::get_if<std::vector<Color>>(&array->values) : nullptr;
    return values ? *values : std::vector<Color>{};
}

const std::vector<double> kDepth{0.5, -1e-300, 3.25, 1e300};
const std::vector<double> kVectors{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const std::vector<std::int64_t> kLabels{-1, 7, 2000000000, 0};
const std::vector<std::int64_t> kSmall{0, 255, 3, 4};
const std::vector<Color> kColors{{255, 0, 1}, {2, 3, 4}, {5, 6, 7}, {8, 9, 10}};

MeshWriteOptions fourArrays() {
    MeshWriteOptions options;
    options.pointArrays = {{"Depth", kDepth},
                           {"my vectors", kVectors, 3},
                           {"labels", kLabels},
                           {"alpha", kSmall},
                           {"RGB", kColors}};
    return options;
}

TEST(PointArrays, OfVtkFilesComeBack) {
    for (const std::string name : {"a.vtp", "a.vtk"}) {
        const MeshFile file = withArrays(written(tetrahedron(), name, fourArrays()), name);
        EXPECT_EQ(file.mesh.triangles, tetrahedron().triangles) << name;
        ASSERT_EQ(file.pointArrays.size(), 5u) << name;
        EXPECT_EQ(numbersOf(file, "Depth"), kDepth) << name;
        EXPECT_EQ(numbersOf(file, "my vectors"), kVectors) << name;
        EXPECT_EQ(find(file, "my vectors")->components, 3) << name;
        EXPECT_EQ(wholeNumbersOf(file, "labels"), kLabels) << name;
        EXPECT_EQ(wholeNumbersOf(file, "alpha"), kSmall) << name;
        EXPECT_EQ(colorsOf(file, "RGB"), kColors) << name;
        EXPECT_EQ(file.frame, CoordinateFrame::Ras) << name;
    }
}

TEST(PointArrays, OfObjAndOffAreColorsAlone) {
    MeshWriteOptions options;
    options.pointArrays = {{"hue", kColors}};
    for (const std::string name : {"a.obj", "a.off"}) {
        const std::string bytes = written(tetrahedron(), name, options);
        const MeshFile file = withArrays(bytes, name);
        EXPECT_EQ(file.mesh.triangles, tetrahedron().triangles) << name;
        EXPECT_EQ(colorsOf(file, "RGB"), kColors) << name;
        EXPECT_TRUE(testing::decoded(bytes, name).pointArrays.empty()) << name;
        EXPECT_THROW(written(tetrahedron(), name, fourArrays()), InvalidInput);
    }
}

TEST(PointArrays, OfForeignObjAndOffAreRead) {
    const std::string end = "f 1 2 3\n";
    const std::vector<Color> expected{{255, 0, 128}, {0, 255, 0}, {0, 0, 255}};
    EXPECT_EQ(
        colorsOf(withArrays("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 -3\nv 0 1 0 0 0 7 x\n" + end, "a.obj"),
                 "RGB"),
        expected);
    EXPECT_EQ(colorsOf(withArrays("COFF 3 1 0\n0 0 0 255 0 128 255\n1 0 0 0.0 1.0 0.0 1.0\n"
                                  "0 1 0 0 0 300\n3 0 1 2\n",
                                  "a.off"),
                       "RGB"),
              expected);
    // one point without, a weight, words: no colours
    for (const std::string points :
         {"v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 0 1\n", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n",
          "v 0 0 0 a b c\nv 1 0 0 nan 0 0\nv 0 1 0 # \n"}) {
        const MeshFile file = withArrays(points + end, "a.obj");
        EXPECT_TRUE(file.pointArrays.empty()) << points;
        EXPECT_EQ(file.mesh.points.size(), 3u);
    }
}

TEST(PointArrays, OfPlyFilesComeBackAsWordsAndColumns) {
    MeshWriteOptions options = fourArrays();
    options.isInFrame = true;
    const MeshFile file = withArrays(written(tetrahedron(), "a.ply", options), "a.ply");
    EXPECT_EQ(file.mesh.points, tetrahedron().points);
    EXPECT_EQ(numbersOf(file, "Depth"), kDepth);
    EXPECT_EQ(numbersOf(file, "my_vectors_1"), (std::vector<double>{2, 5, 8, 11}));
    EXPECT_EQ(wholeNumbersOf(file, "labels"), kLabels);
    EXPECT_EQ(wholeNumbersOf(file, "alpha"), kSmall);
    EXPECT_EQ(colorsOf(file, "RGB"), kColors);
}

TEST(PointArrays, OfOneNameInPlyAreToldApart) {
    MeshWriteOptions options;
    options.isInFrame = true;
    options.pointArrays = {
        {"x", kDepth}, {"a b", kDepth}, {"a_b", kLabels}, {"one", kColors}, {"two", kColors}};
    TriangleMesh mesh = tetrahedron();
    mesh.normals.assign(4, Normal{0, 0, 1});
    const MeshFile file = withArrays(written(mesh, "a.ply", options), "a.ply");
    EXPECT_EQ(file.mesh.points, mesh.points);
    EXPECT_EQ(file.mesh.normals, mesh.normals);
    EXPECT_EQ(numbersOf(file, "x_"), kDepth);
    EXPECT_EQ(numbersOf(file, "a_b"), kDepth);
    EXPECT_EQ(wholeNumbersOf(file, "a_b_"), kLabels);
    EXPECT_EQ(colorsOf(file, "RGB"), kColors);
    EXPECT_EQ(wholeNumbersOf(file, "two_red"), (std::vector<std::int64_t>{255, 2, 5, 8}));
}

TEST(PointArrays, ArePassedOverUnlessAskedFor) {
    for (const std::string name : {"a.vtp", "a.vtk", "a.ply"}) {
        const std::string bytes = written(tetrahedron(), name, fourArrays());
        EXPECT_TRUE(testing::decoded(bytes, name).pointArrays.empty()) << name;
    }
}

TEST(PointArrays, OfForeignVtkTextAreRead) {
    const MeshFile file = withArrays(
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 "
        "0\n"
        "POLYGONS 1 4\n3 0 1 2\nCELL_DATA 1\nSCALARS c int\nLOOKUP_TABLE default\n9\n"
        "POINT_DATA 3\nSCALARS my%20depth float 1\nLOOKUP_TABLE t\n0.5 1.5 nan\n"
        "LOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\nCOLOR_SCALARS hue 4\n1 0 0 1 0 0.5 0 1 0 0 1 1\n"
        "FIELD FieldData 2\nparts 1 3 unsigned_char\n1 2 3\ntwo 2 3 double\n1 2 3 4 5 6\n"
        "NORMALS n float\n0 0 1 0 0 1 0 0 1\n",
        "a.vtk");
    ASSERT_EQ(file.pointArrays.size(), 4u);
    EXPECT_EQ(numbersOf(file, "my depth")[1], 1.5);
    EXPECT_EQ(colorsOf(file, "hue"), (std::vector<Color>{{255, 0, 0}, {0, 128, 0}, {0, 0, 255}}));
    EXPECT_EQ(wholeNumbersOf(file, "parts"), (std::vector<std::int64_t>{1, 2, 3}));
    EXPECT_EQ(find(file, "two")->components, 2);
    EXPECT_EQ(file.mesh.normals.size(), 3u);
}

TEST(PointArrays, ThatAreNotOneAPointAreDamage) {
    const std::string head =
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">"
        "<PointData><DataArray type=\"Float32\" Name=\"d\" NumberOfComponents=\"";
    const std::string tail =
        "</DataArray></PointData><Points><DataArray type=\"Float32\" format=\"ascii\">0 0 0 1 0 0 "
        "0 "
        "1 0</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" "
        "format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
        "format=\"ascii\">3</DataArray></Polys></Piece></PolyData></VTKFile>";
    const auto array = [&](const std::string& components, const std::string& data) {
        return head + components + "\" format=\"ascii\">" + data + tail;
    };
    EXPECT_EQ(numbersOf(withArrays(array("1", "1 2 3"), "a.vtp"), "d"),
              (std::vector<double>{1, 2, 3}));
    for (const std::string& bad : {array("1", "1 2"), array("2", "1 2 3"), array("x", "1 2 3"),
                                   array("4000000000000", "1 2 3")}) {
        EXPECT_THROW(withArrays(bad, "a.vtp"), FileError);
        EXPECT_THROW(testing::decoded(bad, "a.vtp"), FileError);  // though it is not kept
    }
}

TEST(FramesAsStored, AreWrittenToTheBit) {
    const TriangleMesh mesh{{{0.1, 0.2, 0.3}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
    MeshWriteOptions options;
    options.frame = CoordinateFrame::TkRas;
    options.isInFrame = true;
    for (const std::string name : {"a.vtp", "a.ply", "a.gii", "a.off", "lh.pial"}) {
        const MeshFile file = testing::decoded(written(mesh, name, options), name);
        EXPECT_EQ(file.frame, CoordinateFrame::TkRas) << name;
        EXPECT_FALSE(file.volume) << name;
        EXPECT_EQ(file.mesh.points[1], mesh.points[1]) << name;
        EXPECT_NEAR(file.mesh.points[0].x, 0.1, 1e-8) << name;  // float32 at most
    }
    options.volume = testing::obliqueVolume();
    const MeshFile file = testing::decoded(written(mesh, "lh.pial", options), "lh.pial");
    ASSERT_TRUE(file.volume);
    EXPECT_EQ(file.volume->size, testing::obliqueVolume().size);
    EXPECT_EQ(file.mesh.points[1], mesh.points[1]);
}

TEST(FramesAsStored, NeedNotBeSaid) {
    MeshWriteOptions options;
    options.isInFrame = true;
    options.saysFrame = false;
    for (const MeshFormat& format : meshFormats()) {
        const std::string name = testing::exampleName(format);
        const MeshFile file = testing::decoded(written(tetrahedron(), name, options), name);
        if (format.defaultFrame == CoordinateFrame::TkRas)
            continue;  // its readers take it for tkRAS
        EXPECT_FALSE(file.frame) << name;
    }
}

}  // namespace
}  // namespace adaptiso
