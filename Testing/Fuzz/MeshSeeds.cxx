// Every mesh format as this library writes it, and the variants that others write.

#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "InputFolder.h"
#include "Seeds.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshIO/PointData.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso::fuzz {
namespace {

TriangleMesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
            {{-0.6f, -0.6f, -0.5f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

std::string bytesOf(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void addOwnFiles(Seeds& seeds) {
    const InputFolder folder;
    for (const MeshFormat& format : meshFormats()) {
        const std::string ending(format.extensions.front());
        for (const auto frame : {CoordinateFrame::Ras, CoordinateFrame::TkRas}) {
            MeshWriteOptions options;
            options.frame = frame;
            options.volume = ImageGeometry{{10, 20, 30}, {-5, -20, -45}, Mat3::diagonal(1, 2, 3)};
            const auto file = folder.path() / ("mesh" + ending);
            writeMesh(tetrahedron(), file, options);
            seeds.add(ending.substr(1), bytesOf(file));
        }
    }
}

/// A surface that a matrix leads to scanner space.
void addGiftiWithMatrix(Seeds& seeds) {
    seeds.add("gii",
              "<GIFTI><DataArray Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" "
              "Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" "
              "Encoding=\"ASCII\"><CoordinateSystemTransformMatrix>"
              "<DataSpace>NIFTI_XFORM_UNKNOWN</DataSpace><TransformedSpace>NIFTI_XFORM_SCANNER_ANAT"
              "</TransformedSpace><MatrixData>0 2 0 1 1 0 0 2 0 0 1 3 0 0 0 1</MatrixData>"
              "</CoordinateSystemTransformMatrix><Data>0 0 0 1 0 0 0 1 0</Data></DataArray>"
              "<DataArray Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" "
              "Dimensionality=\"2\" Dim0=\"1\" Dim1=\"3\" Encoding=\"ASCII\"><Data>0 1 2</Data>"
              "</DataArray></GIFTI>");
}

/// Meshes with values at their points, and such values in files of their own.
void addValues(Seeds& seeds) {
    const InputFolder folder;
    MeshWriteOptions options;
    options.pointArrays = {{"depth", std::vector<double>{1, 2, 3, 4}},
                           {"two", std::vector<double>(8), 2},
                           {"labels", std::vector<std::int64_t>{-1, 2, 3, 4}},
                           {"RGB", std::vector<Color>(4)}};
    for (const MeshFormat& format : meshFormats()) {
        if (!format.holdsPointArrays) continue;
        const std::string ending(format.extensions.front());
        const auto file = folder.path() / ("values" + ending);
        writeMesh(tetrahedron(), file, options);
        seeds.add(ending.substr(1), bytesOf(file));
    }
    const std::vector<float> numbers{1, 2, 3, 4};
    const std::vector<std::int32_t> labels{1, 2, 3, 4};
    PointData data{PointDataFormat::FreeSurferCurv, 4, {{{}, numbers, 1, {}}}, {}, {}, {}};
    writePointData(data, 4, folder.path() / "lh.curv");
    seeds.add("curv", bytesOf(folder.path() / "lh.curv"));
    seeds.add("curv", std::string("\0\0\2\0\0\1\x00\x96\xFF\x38", 10));
    data = {PointDataFormat::FreeSurferAnnot, 4, {{{}, labels, 1, {}}}, {}, {}, {}};
    const std::string one("\0\0\0\1", 4), color(16, '\1');
    data.annotTable = one + "\xFF\xFF\xFF\xFE" + one + one + "t" + one + one + one + "x" + color;
    writePointData(data, 4, folder.path() / "lh.annot");
    seeds.add("annot", bytesOf(folder.path() / "lh.annot"));
    data = {PointDataFormat::FreeSurferMgh,
            4,
            {{{}, numbers, 1, {}}, {{}, numbers, 1, {}}},
            {},
            {},
            {}};
    writePointData(data, 4, folder.path() / "lh.mgh");
    seeds.add("overlay", bytesOf(folder.path() / "lh.mgh"));
    data = {PointDataFormat::Gifti, 4,  {},
            {{1, "one", {}}},       {}, {{"AnatomicalStructurePrimary", "CortexLeft"}}};
    data.arrays = {{"NIFTI_INTENT_SHAPE", numbers, 1, {{"Name", "depth"}}},
                   {"NIFTI_INTENT_LABEL", labels, 1, {}},
                   {"NIFTI_INTENT_NONE", std::vector<float>(8), 2, {}}};
    writePointData(data, 4, folder.path() / "a.gii");
    seeds.add("shape", bytesOf(folder.path() / "a.gii"));
    seeds.add("shape",
              "<GIFTI><LabelTable><Label Index=\"3\" Red=\"0.5\">a</Label></LabelTable><DataArray "
              "Intent=\"NIFTI_INTENT_NONE\" DataType=\"NIFTI_TYPE_UINT8\" Encoding=\"ASCII\" "
              "Dimensionality=\"2\" Dim0=\"2\" Dim1=\"2\" ArrayIndexingOrder=\"ColumnMajorOrder\">"
              "<Data>1 2 3 4</Data></DataArray></GIFTI>");
}

void addSurfaceLists(Seeds& seeds) {
    const InputFolder folder;
    const FiffSurface surfaces[] = {{4, 0.33, tetrahedron()}, {1, 0.33, tetrahedron()}};
    writeFiffSurfaces(surfaces, folder.path() / "a.fif");
    seeds.add("fif", bytesOf(folder.path() / "a.fif"));
    const NamedPoint points[] = {{"Cz", PointKind::Electrode, {0, 0, 90}},
                                 {"Nasion", PointKind::Nasion, {0, 95, 0}}};
    const auto tsv = folder.path() / "electrodes.tsv", json = folder.path() / "coordsystem.json";
    writeBidsElectrodes(points, tsv, json, CoordinateFrame::Ras);
    seeds.add("tsv", bytesOf(tsv) + '\0' + bytesOf(json));
    writeElc(points, folder.path() / "a.elc");
    seeds.add("elc", bytesOf(folder.path() / "a.elc"));
    writeSfp(points, folder.path() / "a.sfp");
    seeds.add("sfp", bytesOf(folder.path() / "a.sfp"));
    writeFiffPoints(points, folder.path() / "b.fif");
    seeds.add("dig", bytesOf(folder.path() / "b.fif"));
    const char* const caps[] = {"1 0 .5 Fpz\n",
                                "1 0 0 9 Cz\n",
                                "EEG Fz 46 90\n%N a\n%F 1 2 3\n",
                                "2\nnasion 9 0 0\n",
                                "cardinal 2 0 9 0\n",
                                "E1 37 -14 1 .7 .6 -.2 0\n",
                                "Site Theta Phi\nFp1 -92 -72\n",
                                "<E><Electrode><Name>a</Name><Theta>9</Theta><Phi>2</"
                                "Phi><Radius>1</Radius></Electrode></E>"};
    for (int n = 0; n < 8; ++n) seeds.add("caps", std::string(1, static_cast<char>(n)) + caps[n]);
}

void addVtkFiles(Seeds& seeds) {
    const auto data = toVtkPolyData(tetrahedron());
    for (const bool isBinary : {false, true}) {
        vtkNew<vtkPolyDataWriter> writer;
        writer->SetInputData(data);
        writer->SetFileVersion(vtkDataWriter::VTK_LEGACY_READER_VERSION_5_1);
        isBinary ? writer->SetFileTypeToBinary() : writer->SetFileTypeToASCII();
        writer->WriteToOutputStringOn();
        writer->Write();
        seeds.add("vtk", writer->GetOutputStdString());
    }
    for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
        for (const bool isPlain : {false, true}) {
            vtkNew<vtkXMLPolyDataWriter> writer;
            writer->SetInputData(data);
            writer->SetDataMode(mode);
            writer->SetBlockSize(64);  // several blocks an array
            if (isPlain) {
                writer->SetCompressorTypeToNone();
                writer->EncodeAppendedDataOff();
                writer->SetHeaderTypeToUInt32();
                writer->SetByteOrderToBigEndian();
            }
            writer->WriteToOutputStringOn();
            writer->Write();
            seeds.add("vtp", writer->GetOutputString());
        }
    }
}

void addForeignTexts(Seeds& seeds) {
    seeds.add(
        "stl",
        "solid a\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1e0 0 0\n  vertex "
        "-0 +1 0\n endloop\nendfacet\nendsolid\n");
    constexpr std::array<std::array<int, 3>, 4> kFaces{
        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    std::string solids;  // two tetrahedra with a wall in common
    for (const auto& [name, corner] : {std::pair{"a", "1 1 1"}, std::pair{"b", "-1 -1 -1"}}) {
        const std::array<std::string, 4> corners{"0 0 0", "1 0 0", "0 1 0", corner};
        const bool isTurned = name == std::string_view("b");
        solids += std::string("solid ") + name + "\n";
        for (const auto& [i, j, k] : kFaces) {
            solids += "facet normal 0 0 0 outer loop";
            for (const int c : {i, isTurned ? k : j, isTurned ? j : k}) {
                solids += " vertex " + corners[c];
            }
            solids += " endloop endfacet\n";
        }
        solids += std::string("endsolid ") + name + "\n";
    }
    seeds.add("stl", solids);
    seeds.add("obj",
              "# CoordinateFrame: LPS mm\r\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\n"
              "usemtl x\ng y\nf -4/1 -3/1 -2/1\nf 1//1 2//1 4//1\nf 1/1/1 3/1/1 4/1/1\n");
    seeds.add("off",
              "COFF 3 1 0\n0 0 0\n\n1 0 0 # CoordinateFrame: LPS mm\n0 1 0\n3 0 1 2 255 0 0\n");
    const std::string faces =
        "element face 1\nproperty list uchar uint vertex_index\nproperty uchar "
        "flag\nend_header\n";
    seeds.add(
        "ply",
        "ply\nformat ascii 1.0\ncomment CoordinateFrame: tkRAS mm\nelement tag 2\nproperty "
        "list uchar int ids\nelement vertex 3\nproperty uchar red\nproperty float x\nproperty "
        "float y\nproperty float z\n" +
            faces + "2 7 8\n0\n9 0 0 0\n9 1.5 0 0\n9 0 1 0\n3 0 1 2 1\n");
    const std::string zero(4, '\0'), one("\x3F\x80\0\0", 4);
    seeds.add(
        "ply",
        "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
        "y\nproperty float z\n" +
            faces + zero + zero + zero + one + zero + zero + zero + one + zero +
            std::string("\x03\0\0\0\0\0\0\0\x01\0\0\0\x02\x07", 14));
    seeds.add("ply",
              "ply\rformat ascii 1.0\relement vertex 3\rproperty float32 x\rproperty float y\r"
              "property float z\relement face 1\rproperty list uint8 float32 vertex_index\r"
              "end_header\r0 0 0 7\r1.0D+00 0 0\r0 1 0\r3 0 1 2.0 6 0 0 1\r");
    seeds.add("obj",
              "\xEF\xBB\xBF# a\rv 0 0 0 1 0 0\rv 1 0 0\rv 0 1 0 # b\rvt 0 0\rf 1/1/ 2// \\\r 3/\r");
    seeds.add("stl",
              "SOLID a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 -1.#IND 0 vertex 0 1 0 "
              "endloop endfacet endsolid a solid b endsolid");
    seeds.add("off", "STCNOFF\n3 1\n0 0 0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n");
    seeds.add("gii",
              "<GIFTI><DataArray Intent=\"NIFTI_INTENT_SHAPE\"/><DataArray "
              "Intent=\"NIFTI_INTENT_POINTSET\" Encoding=\"ExternalFileBinary\" "
              "ExternalFileName=\"a\" ExternalFileOffset=\"0\"/></GIFTI>");
    for (const char* const other :
         {"P 0.3 0.3 0.4 10 1 3\n", "version https://git-lfs.github.com/spec/v1\nsize 7\n",
          "/annex/objects/MD5E-s7--a\n", "<!DOCTYPE html><html>", "PK\3\4", "BZh91AY&SY",
          "\xFF\xFF\xFF", "#!ascii", "NRRD0004", "<COLLADA>", "{\"message\": 1}"}) {
        seeds.add("tri", other);  // content tells
    }
    const auto array = [](const char* intent, const char* type, const char* order,
                          const char* data) {
        return std::string("<DataArray Intent=\"NIFTI_INTENT_") + intent + "\" DataType=\"" + type +
               "\" ArrayIndexingOrder=\"" + order +
               "\" Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" Encoding=\"ASCII\"><Data>" + data +
               "</Data></DataArray>";
    };
    seeds.add(
        "gii",
        "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">" +
            array("POINTSET", "NIFTI_TYPE_FLOAT32", "ColumnMajorOrder", "0 1 0  0 0 1  5 5 5") +
            array("TRIANGLE", "NIFTI_TYPE_INT32", "RowMajorOrder", "0 1 2 1 2 0 2 0 1") +
            "</GIFTI>");
}

/// Counts that other programs leave, and what may follow the last record.
void addCounts(Seeds& seeds) {
    const InputFolder folder;
    const auto file = folder.path() / "mesh.stl";
    writeMesh(tetrahedron(), file, {});
    const std::string stl = bytesOf(file), head = stl.substr(0, 80), record = stl.substr(84, 50);
    for (const std::string& count : {std::string(4, '\0'), std::string(4, '\xFF')}) {
        seeds.add("stl", head + count + stl.substr(84));
    }
    seeds.add("stl", stl + stl);
    seeds.add("stl", stl + record + "end");
    const std::string attributes = record.substr(0, 48) + std::string("\3\0xyz", 5);
    seeds.add("stl", head + std::string("\2\0\0\0", 4) + attributes + attributes);
    for (const MeshFormat& format : meshFormats()) {
        const std::string ending(format.extensions.front());
        const auto mesh = folder.path() / ("joined" + ending);
        writeMesh(tetrahedron(), mesh, {});
        seeds.add(ending.substr(1), bytesOf(mesh) + bytesOf(mesh));
        seeds.add(ending.substr(1), bytesOf(mesh) + std::string(9, '\0'));
    }
    seeds.add("ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
              "property float z\nproperty int a\nproperty int a\nelement face -1\nproperty list "
              "uchar int vertex_indices\nend_header\n0 0 0 1 2\n1 0 0 1 2\n0 1 0 1 2\n3 0 1 2\n");
    seeds.add("off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    seeds.add("vtk",
              "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 "
              "0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nTEXTURE_COORDINATES t 2 float\n1 2 "
              "3 4 5 6\nEDGE_FLAGS e int\n1 2 3\nOTHER\n7\n");
    // many arrays that name one block
    std::string arrays;
    for (int n = 0; n < 20; ++n) {
        arrays += "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/>";
    }
    const auto ascii = [](const char* type, const char* name, const char* numbers) {
        return std::string("<DataArray type=\"") + type + "\" Name=\"" + name +
               "\" format=\"ascii\">" + numbers + "</DataArray>";
    };
    seeds.add("vtp",
              "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" "
              "NumberOfPolys=\"1\"><PointData>" +
                  arrays + "</PointData><Points>" + ascii("Float32", "p", "0 0 0 1 0 0 0 1 0") +
                  "</Points><Polys>" + ascii("Int32", "connectivity", "0 1 2") +
                  ascii("Int32", "offsets", "3") +
                  "</Polys></Piece></PolyData><AppendedData encoding=\"raw\">_" +
                  std::string("\3\0\0\0abc", 7) + "</AppendedData></VTKFile><!-- x -->");
}

/// GLB and 3MF as other programs write them.
void addScenes(Seeds& seeds) {
    const auto glb = [](std::string json, const std::string& bin) {
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string bytes = "glTF";
        const auto word = [&](std::size_t number) {
            appendLittleEndian(static_cast<std::uint32_t>(number), bytes);
        };
        word(2);
        word(28 + json.size() + bin.size());
        word(json.size());
        bytes += "JSON" + json;
        word(bin.size());
        return bytes + std::string("BIN\0", 4) + bin;
    };
    std::string bin;
    for (int n = 0; n < 16; ++n) appendLittleEndian(static_cast<float>(n * n % 7), bin);
    bin += std::string("\0\1\2\2\1\3\0\0", 8);
    for (const char* const primitive :
         {R"("indices":1)", R"("mode":5,"material":0)", R"("mode":6)", R"("mode":1)"}) {
        seeds.add("glb",
                  glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
                      R"("extensionsRequired":["KHR_materials_unlit"],"nodes":[{"children":[1,2],)"
                      R"("rotation":[0,0,0.7,0.7],"scale":[2,2,-2],"translation":[5,0,0]},)"
                      R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1]},{"mesh":0}],)"
                      R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1]}}],)"
                      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":2,)"
                      R"("TEXCOORD_0":0},)" +
                          std::string(primitive) +
                          R"(}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,)"
                          R"("type":"VEC3"},{"bufferView":1,"componentType":5121,"count":6,)"
                          R"("type":"SCALAR"},{"bufferView":0,"componentType":5122,"count":4,)"
                          R"("normalized":true,"byteOffset":4,"type":"VEC4"}],"bufferViews":[)"
                          R"({"buffer":0,"byteLength":64,"byteStride":16},{"buffer":0,)"
                          R"("byteOffset":64,"byteLength":8}],"buffers":[{"byteLength":72}]})",
                      bin));
    }
    seeds.add("3mf",
              "<model unit=\"inch\" xmlns:p=\"http://x/production/1\" requiredextensions=\"p\">"
              "<metadata name=\"Description\">CoordinateFrame: LPS mm</metadata><resources>"
              "<basematerials id=\"1\"><base name=\"a\" displaycolor=\"#FF0080FF\"/>"
              "</basematerials><object id=\"2\" pid=\"1\" pindex=\"0\"><mesh><vertices>"
              "<vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex "
              "x=\"0\" y=\"1e0\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" "
              "v3=\"2\"/></triangles></mesh></object><object id=\"3\"><components><component "
              "objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 10 0 0\"/><component objectid=\"2\" "
              "p:path=\"/3D/3dmodel.model\"/></components></object></resources><build><item "
              "objectid=\"3\"/></build></model>");
}

/// Polygons and strips in every format that holds them.
void addPolygons(Seeds& seeds) {
    const std::string points = "0 0 0\n2 0 0\n2 2 1\n1 1 0\n0 2 0\n";
    const auto ply = [&](const char* element, const char* rows) {
        return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
               "property float z\nelement " +
               std::string(element) + " 2\nproperty list int int vertex_indices\nend_header\n" +
               points + rows;
    };
    seeds.add("ply", ply("face", "4 0 1 2 3\n5 0 1 2 3 4\n"));
    seeds.add("ply", ply("tristrips", "5 0 1 2 3 4\n7 0 1 2 -1 2 1 3\n"));
    seeds.add("obj", "v 0 0 0\nv 2 0 0\nv 2 2 1\nv 1 1 0\nv 0 2 0\nf 1 2 3 4\nf 1 2 3 4 5\n");
    seeds.add("off", "OFF\n5 2 0\n" + points + "4 0 1 2 3\n5 0 1 2 3 4\n");
    const std::string head = "\nx\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n" + points;
    seeds.add("vtk", "# vtk DataFile Version 3.0" + head +
                         "LINES 1 3\n2 0 1\nPOLYGONS 2 11\n4 0 1 2 3\n5 0 1 2 3 4\n"
                         "TRIANGLE_STRIPS 1 6\n5 0 1 2 3 4\n");
    seeds.add("vtk", "# vtk DataFile Version 5.1" + head +
                         "POLYGONS 3 9\nOFFSETS vtktypeint64\n0 4 9\nCONNECTIVITY vtktypeint64\n"
                         "0 1 2 3 0 1 2 3 4\n");
    const auto cells = [](const std::string& element, const char* corners, const char* ends) {
        return "<" + element + "><DataArray Name=\"connectivity\" format=\"ascii\">" + corners +
               "</DataArray><DataArray Name=\"offsets\" format=\"ascii\">" + ends +
               "</DataArray></" + element + ">";
    };
    seeds.add("vtp",
              "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"5\" "
              "NumberOfPolys=\"2\" NumberOfStrips=\"1\"><Points><DataArray format=\"ascii\">" +
                  points + "</DataArray></Points>" + cells("Polys", "0 1 2 3 0 1 2 3 4", "4 9") +
                  cells("Strips", "0 1 2 3 4", "5") + "</Piece></PolyData></VTKFile>");
    const std::string quad("\0\0\0\0\0\1\0\0\2\0\0\3", 12), counts("\0\0\4\0\0\1", 6);
    const std::string zero(4, '\0'), one("\x3F\x80\0\0", 4);
    seeds.add("surf", "\xFF\xFF\xFD" + counts + zero + zero + zero + one + zero + zero + one + one +
                          zero + zero + one + zero + quad);
    seeds.add("surf",
              "\xFF\xFF\xFF" + counts +
                  std::string("\0\0\0\0\0\0\0\x64\0\0\0\0\0\x64\0\x64\0\0\0\0\0\x64\0\0", 24) +
                  quad);
}

}  // namespace

void addMeshSeeds(Seeds& seeds) {
    addPolygons(seeds);
    addScenes(seeds);
    addCounts(seeds);
    addOwnFiles(seeds);
    addGiftiWithMatrix(seeds);
    addValues(seeds);
    addSurfaceLists(seeds);
    addVtkFiles(seeds);
    addForeignTexts(seeds);
}

}  // namespace adaptiso::fuzz
