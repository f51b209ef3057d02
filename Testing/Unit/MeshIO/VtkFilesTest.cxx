// VTK as the judge of what is written in its formats.
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkPolyDataWriter.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataReader.h>

#include "MeshIOTestSupport.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso {
namespace {

using testing::icosphere;
using testing::tetrahedron;
using testing::written;

template <class Array, class T>
void add(vtkFieldData* to, const std::string& name, const std::vector<T>& values, int components) {
    const auto array = vtkSmartPointer<Array>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    to->AddArray(array);
}

void addText(vtkFieldData* to, const char* name, std::string_view text) {
    const auto array = vtkSmartPointer<vtkStringArray>::New();
    array->SetName(name);
    array->InsertNextValue(std::string(text));
    to->AddArray(array);
}

/// What a file of `mesh` holds, as VTK has it.
vtkSmartPointer<vtkPolyData> asVtk(const TriangleMesh& mesh, const MeshWriteOptions& options) {
    auto data = toVtkPolyData(mesh);
    vtkPointData* const points = data->GetPointData();
    for (const PointArray& array : options.pointArrays) {
        if (const auto* colors = std::get_if<std::vector<Color>>(&array.values)) {
            std::vector<std::uint8_t> shades;
            for (const Color& each : *colors) shades.insert(shades.end(), each.begin(), each.end());
            add<vtkUnsignedCharArray>(points, array.name, shades, 3);
        } else if (const auto* numbers = std::get_if<std::vector<double>>(&array.values)) {
            add<vtkDoubleArray>(points, array.name, *numbers, array.components);
        } else {
            add<vtkTypeInt64Array>(points, array.name,
                                   std::get<std::vector<std::int64_t>>(array.values),
                                   array.components);
        }
    }
    if (!options.pointArrays.empty()) {
        points->SetActiveScalars(options.pointArrays.front().name.c_str());
    }
    for (const CellArray& array : options.cellArrays) {
        add<vtkIntArray>(data->GetCellData(), array.name,
                         std::get<std::vector<std::int32_t>>(array.values), 1);
    }
    if (!options.cellArrays.empty()) {
        data->GetCellData()->SetActiveScalars(options.cellArrays.front().name.c_str());
    }
    if (options.saysFrame) {
        addText(data->GetFieldData(), "CoordinateFrame", toString(options.frame));
    }
    addText(data->GetFieldData(), "AdaptisoSurfaceVersion", "1");
    return data;
}

MeshWriteOptions withArrays(std::size_t points, std::size_t triangles) {
    std::vector<double> numbers(3 * points);
    std::vector<std::int64_t> labels(points);
    std::vector<Color> colors(points);
    for (std::size_t i = 0; i < points; ++i) {
        numbers[i] = numbers[2 * points + i] = 1e-300 + static_cast<double>(i) / 7;
        labels[i] = (std::int64_t{1} << 40) - static_cast<std::int64_t>(i);
        colors[i] = {static_cast<std::uint8_t>(i), 255, 0};
    }
    MeshWriteOptions options;
    options.isInFrame = true;
    options.pointArrays = {{"labels", labels},
                           {"a \"b\" <c> & 'd' %\xc3\xa4", numbers, 3},
                           {"pairs", std::vector<double>(2 * points, -0.0), 2},
                           {"RGB", colors}};
    options.cellArrays = {{"label0", std::vector<std::int32_t>(triangles, -7)},
                          {"label1", std::vector<std::int32_t>(triangles, 2000000000)}};
    return options;
}

void expectSameArrays(vtkFieldData* found, vtkFieldData* expected) {
    ASSERT_EQ(found->GetNumberOfArrays(), expected->GetNumberOfArrays());
    for (int i = 0; i < expected->GetNumberOfArrays(); ++i) {
        vtkAbstractArray *const a = found->GetAbstractArray(i), *const b =
                                                                    expected->GetAbstractArray(i);
        EXPECT_STREQ(a->GetName(), b->GetName());
        EXPECT_EQ(a->GetDataType(), b->GetDataType()) << b->GetName();
        ASSERT_EQ(a->GetNumberOfComponents(), b->GetNumberOfComponents()) << b->GetName();
        ASSERT_EQ(a->GetNumberOfValues(), b->GetNumberOfValues()) << b->GetName();
        for (vtkIdType n = 0; n < b->GetNumberOfValues(); ++n) {
            ASSERT_EQ(a->GetVariantValue(n), b->GetVariantValue(n)) << b->GetName() << " " << n;
        }
    }
}

/// Meshes and arrays of each kind: with and without normals, arrays, a frame; of many blocks.
std::vector<std::pair<TriangleMesh, MeshWriteOptions>> examples() {
    std::vector<std::pair<TriangleMesh, MeshWriteOptions>> examples;
    for (const TriangleMesh& mesh : {tetrahedron(), icosphere(4)}) {
        MeshWriteOptions options;
        options.isInFrame = true;
        examples.emplace_back(mesh, options);
        options.saysFrame = false;
        examples.emplace_back(mesh, options);
        options = withArrays(mesh.points.size(), mesh.triangles.size());
        examples.emplace_back(mesh, options);
        std::ranges::reverse(options.pointArrays);  // colours, then three numbers a point first
        examples.emplace_back(mesh, options);
        std::swap(options.pointArrays[0], options.pointArrays[2]);
        examples.emplace_back(mesh, options);
    }
    return examples;
}

TEST(VtkXmlFile, IsToVtkWhatWasWritten) {
    for (const auto& [mesh, options] : examples()) {
        const auto reader = vtkSmartPointer<vtkXMLPolyDataReader>::New();
        reader->ReadFromInputStringOn();
        reader->SetInputString(written(mesh, "a.vtp", options));
        reader->Update();
        ASSERT_EQ(reader->GetErrorCode(), 0u);
        vtkPolyData* const found = reader->GetOutput();
        const auto expected = asVtk(mesh, options);
        if (options.saysFrame) addText(expected->GetFieldData(), "SPACE", "RAS");
        EXPECT_EQ(found->GetPoints()->GetDataType(), VTK_DOUBLE);
        EXPECT_EQ(fromVtkPolyData(found), fromVtkPolyData(expected));
        EXPECT_EQ(found->GetNumberOfCells(), std::ssize(mesh.triangles));
        expectSameArrays(found->GetPointData(), expected->GetPointData());
        expectSameArrays(found->GetCellData(), expected->GetCellData());
        expectSameArrays(found->GetFieldData(), expected->GetFieldData());
        for (vtkDataSetAttributes* const data :
             {static_cast<vtkDataSetAttributes*>(expected->GetPointData()),
              static_cast<vtkDataSetAttributes*>(expected->GetCellData())}) {
            if (data->GetScalars() == nullptr) continue;
            const bool isOfPoints = data == expected->GetPointData();
            vtkDataArray* const scalars = isOfPoints ? found->GetPointData()->GetScalars()
                                                     : found->GetCellData()->GetScalars();
            ASSERT_NE(scalars, nullptr);
            EXPECT_STREQ(scalars->GetName(), data->GetScalars()->GetName());
        }
    }
}

TEST(VtkLegacyFile, HasTheVeryBytesThatVtkWrites) {
    for (auto [mesh, options] : examples()) {
        options.cellArrays.clear();
        const auto writer = vtkSmartPointer<vtkPolyDataWriter>::New();
        writer->SetInputData(asVtk(mesh, options));
        const std::string frame = ", CoordinateFrame: RAS mm, SPACE=RAS";
        writer->SetHeader(("adaptiso surface" + (options.saysFrame ? frame : "")).c_str());
        writer->SetFileTypeToBinary();
        writer->SetFileVersion(vtkDataWriter::VTK_LEGACY_READER_VERSION_4_2);
        writer->WriteToOutputStringOn();
        ASSERT_EQ(writer->Write(), 1);
        EXPECT_TRUE(written(mesh, "a.vtk", options) == writer->GetOutputStdString());
    }
}

TEST(VtkFiles, TellArraysOfOneNameApart) {
    TriangleMesh mesh = tetrahedron();
    mesh.normals.assign(4, {0, 0, 1});
    MeshWriteOptions options;
    options.isInFrame = true;
    const std::vector<double> ones(4, 1), twos(4, 2);
    options.pointArrays = {
        {"Normals", ones}, {"a", ones}, {"a", twos}, {"", twos}, {"\xe4\n", ones}};
    for (const std::string name : {"a.vtp", "a.vtk"}) {
        const MeshFile file = decodeMesh(written(mesh, name, options), findMeshFormat(name), name,
                                         {.keepsPointArrays = true});
        EXPECT_EQ(file.mesh, mesh) << name;
        std::vector<std::string> names;
        for (const PointArray& array : file.pointArrays) names.push_back(array.name);
        const std::string last = name == "a.vtp" ? "\xc3\xa4?" : "\xe4?";  // XML is UTF-8
        EXPECT_EQ(names, (std::vector<std::string>{"Normals_", "a", "a_", "values", last})) << name;
    }
}

}  // namespace
}  // namespace adaptiso
