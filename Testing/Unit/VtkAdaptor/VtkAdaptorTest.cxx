#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include "Support/Meshes.h"
#include "Support/Messages.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso {
namespace {

using testing::cubeMesh;
using testing::icosphere;
using testing::messageOf;

TEST(VtkAdaptor, GivesTheSameMeshBack) {
    const TriangleMesh sphere = icosphere(2, {1, 2, 3}, 40);
    const TriangleMesh back = fromVtkPolyData(toVtkPolyData(sphere));
    EXPECT_EQ(back.points, sphere.points);
    EXPECT_EQ(back.triangles, sphere.triangles);
    ASSERT_EQ(back.normals.size(), sphere.normals.size());
    for (std::size_t i = 0; i < back.normals.size(); ++i) {
        // scaled to unit length again: the last bit may move
        EXPECT_FLOAT_EQ(back.normals[i].x, sphere.normals[i].x);
        EXPECT_FLOAT_EQ(back.normals[i].y, sphere.normals[i].y);
        EXPECT_FLOAT_EQ(back.normals[i].z, sphere.normals[i].z);
    }
    EXPECT_TRUE(fromVtkPolyData(toVtkPolyData(cubeMesh())).normals.empty());
}

TEST(VtkAdaptor, NormalsAreTheActiveOnes) {
    const auto data = toVtkPolyData(icosphere(0));
    ASSERT_NE(data->GetPointData()->GetNormals(), nullptr);
    EXPECT_STREQ(data->GetPointData()->GetNormals()->GetName(), "Normals");
}

TEST(VtkAdaptor, AnEmptyMeshIsEmptyData) {
    EXPECT_EQ(toVtkPolyData({})->GetNumberOfCells(), 0);
    EXPECT_EQ(fromVtkPolyData(vtkSmartPointer<vtkPolyData>::New()), TriangleMesh{});
}

TEST(VtkAdaptor, RefusesWhatIsNoTriangle) {
    const auto withPolygon = [](std::initializer_list<vtkIdType> corners) {
        const auto data = toVtkPolyData(cubeMesh());
        vtkNew<vtkCellArray> cells;
        cells->InsertNextCell(corners);
        data->SetPolys(cells);
        return messageOf<InvalidInput>([&] { fromVtkPolyData(data); });
    };
    EXPECT_NE(withPolygon({0, 1, 2, 3}).find("4 corners"), std::string::npos);
    EXPECT_NE(withPolygon({0, 1}).find("2 corners"), std::string::npos);
    EXPECT_NE(withPolygon({0, 1, 8}).find("uses point 8"), std::string::npos);
    EXPECT_NE(withPolygon({0, -1, 2}).find("uses point -1"), std::string::npos);
    EXPECT_THROW(fromVtkPolyData(nullptr), InvalidInput);

    const auto strips = toVtkPolyData(cubeMesh());
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell({0, 1, 2, 3});
    strips->SetStrips(cells);
    EXPECT_NE(messageOf<InvalidInput>([&] { fromVtkPolyData(strips); }).find("strips"),
              std::string::npos);
}

TEST(VtkAdaptor, RefusesNormalsThatAreNotOneAPoint) {
    const auto data = toVtkPolyData(cubeMesh());
    vtkNew<vtkFloatArray> normals;
    normals->SetNumberOfComponents(3);
    normals->SetNumberOfTuples(2);
    normals->Fill(0);
    data->GetPointData()->SetNormals(normals);
    EXPECT_NE(messageOf<InvalidInput>([&] { fromVtkPolyData(data); }).find("2 tuples"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso
