// VTK as the judge of how polygons are cut.
#include <vtkNew.h>
#include <vtkPlatonicSolidSource.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkStripper.h>
#include <vtkSuperquadricSource.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataWriter.h>

#include "MeshIOTestSupport.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso {
namespace {

/// Files of the data in VTK's two formats have the triangles that VTK makes of them: as many, with
/// the same area and volume.
void expectAsVtk(vtkPolyData* data) {
    vtkNew<vtkTriangleFilter> filter;
    filter->SetInputData(data);
    filter->PassLinesOff();
    filter->PassVertsOff();
    filter->Update();
    const TriangleMesh expected = fromVtkPolyData(filter->GetOutput());
    ASSERT_GT(expected.triangles.size(), 0);

    vtkNew<vtkPolyDataWriter> legacy;
    legacy->SetInputData(data);
    legacy->SetFileTypeToBinary();
    legacy->WriteToOutputStringOn();
    legacy->Write();
    vtkNew<vtkXMLPolyDataWriter> xml;
    xml->SetInputData(data);
    xml->WriteToOutputStringOn();
    xml->Write();
    for (const auto& [name, bytes] : {std::pair("a.vtk", std::string(legacy->GetOutputStdString())),
                                      std::pair("a.vtp", std::string(xml->GetOutputString()))}) {
        const TriangleMesh mesh = testing::decoded(bytes, name).mesh;
        EXPECT_EQ(mesh.triangles.size(), expected.triangles.size()) << name;
        // 1e-6: its points are floats, so that pentagons cut otherwise are another surface
        EXPECT_NEAR(surfaceArea(mesh), surfaceArea(expected), 1e-6 * surfaceArea(expected)) << name;
        EXPECT_NEAR(enclosedVolume(mesh), enclosedVolume(expected), 1e-6) << name;
    }
}

TEST(PolygonsInVtk, HaveTheTrianglesOfItsFilter) {
    vtkNew<vtkPlatonicSolidSource> dodecahedron;
    dodecahedron->SetSolidTypeToDodecahedron();
    dodecahedron->Update();
    expectAsVtk(dodecahedron->GetOutput());
    dodecahedron->SetSolidTypeToCube();
    dodecahedron->Update();
    expectAsVtk(dodecahedron->GetOutput());
}

TEST(TriangleStripsInVtk, HaveTheTrianglesOfItsFilter) {
    vtkNew<vtkSuperquadricSource> source;  // strips
    source->Update();
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputConnection(source->GetOutputPort());
    vtkNew<vtkStripper> stripper;
    stripper->SetInputConnection(triangles->GetOutputPort());
    stripper->Update();
    ASSERT_GT(stripper->GetOutput()->GetNumberOfStrips(), 0);
    expectAsVtk(stripper->GetOutput());
}

}  // namespace
}  // namespace adaptiso
